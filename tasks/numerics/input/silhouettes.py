"""Silhouettes of several cameras as files: which belong to one frame, and what they hold.

    walk/calibration.json        every camera by name
    walk/cam_00/frame_0000.png   one folder a camera, named as in the calibration; one image a frame
    walk/cam_00/frame_0001.png   images of one moment have the same number, the last in the file's name

or one silhouettes_0000.npz a frame with an array `silhouettes` (camera, row, column), and the calibration beside them.
"""

import re
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from kinetree.errors import HullError, SourceError
from kinetree.tasks.numerics.arrays import Flags
from kinetree.tasks.numerics.input.calibration import Calibration
from kinetree.tasks.numerics.input.source import natural_order
from kinetree.tasks.numerics.input.unpacked import too_large

SUFFIXES = (".png", ".bmp", ".pgm", ".tif", ".tiff", ".jpg", ".jpeg")
_FORMATS = ("PNG", "BMP", "PPM", "TIFF", "JPEG")
"""As those suffixes say; Pillow would go by the content and start other programs for some (EPS)."""
ARRAY = "silhouettes"
"""The array of an npz."""
MOST_PIXELS = 100_000_000
"""Of one mask; no camera in use has as many."""
MOST_BYTES = 1_000_000_000
"""Of one unpacked npz of silhouettes, and of the file of one mask."""


def image_files(folder: Path) -> list[Path]:
    """The images of a folder in natural order, hidden files left out."""
    images = [p for p in folder.iterdir() if p.suffix.lower() in SUFFIXES and not p.name.startswith(".") and p.is_file()]
    return sorted(images, key=lambda p: natural_order(p.name))


def camera_folders(folder: Path) -> dict[str, Path]:
    """The sub-folders that hold images, by name."""
    cameras = [p for p in folder.iterdir() if p.is_dir() and not p.name.startswith(".") and image_files(p)]
    return {p.name: p for p in sorted(cameras, key=lambda p: natural_order(p.name))}


def mask_files(folder: Path, calibration: Calibration) -> list[tuple[int, tuple[Path | None, ...]]]:
    """Of every frame its number and the mask of each camera of the calibration, None where a camera has none.

    raises : SourceError if folders and calibration name different cameras, or two images of a camera have one number
    """
    folders = camera_folders(folder)
    without = [name for name in calibration.names if name not in folders]
    unknown = [name for name in folders if name not in calibration.names]
    if without or unknown:
        raise SourceError(
            f"{folder}: the calibration has {len(calibration.names)} cameras, the folder has images of {len(folders)}"
            + (f"; no folder with images for {', '.join(without[:8])}" if without else "")
            + (f"; no calibration for {', '.join(unknown[:8])}" if unknown else "")
            + ": each camera needs a folder of its own name"
        )
    numbered = [_by_number(folders[name]) for name in calibration.names]
    frames = sorted({frame for files in numbered for frame in files})
    return [(frame, tuple(files.get(frame) for files in numbered)) for frame in frames]


def read_masks(files: Sequence[Path | None], calibration: Calibration) -> list[Flags | None]:
    """The masks of one frame: (row, column) True on the body; None where there is no file.

    A pixel belongs to the body if it is brighter than half of the brightest of its mask, whatever the depth of the image.

    raises : HullError if a mask cannot be read or is not of the calibration's size
    """
    masks: list[Flags | None] = []
    for path, name, size in zip(files, calibration.names, calibration.sizes, strict=True):
        masks.append(None if path is None else _checked(_image(path), f"{path}", name, size))
    return masks


def read_packed_masks(path: Path, calibration: Calibration) -> list[Flags | None]:
    """The masks of one frame in an npz with the array `silhouettes` (camera, row, column); refuses as `read_masks`."""
    try:
        _refuse_large(path)
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            stacked = np.asarray(archive[ARRAY])
    except HullError:
        raise
    except Exception as error:
        raise HullError(f"{path}: no array {ARRAY} can be read ({type(error).__name__}: {error})") from error
    if stacked.ndim != 3 or stacked.dtype.kind not in "biuf":
        raise HullError(f"{path}: {ARRAY} is {stacked.dtype} {stacked.shape}; numbers (camera, row, column) are needed")
    if len(stacked) != len(calibration.names):
        raise HullError(f"{path}: silhouettes of {len(stacked)} cameras, but the calibration has {len(calibration.names)}")
    named = zip(stacked, calibration.names, calibration.sizes, strict=True)
    return [_checked(image, f"{path}, camera {name}", name, size) for image, name, size in named]


def write_masks(folder: Path, frame: int, names: Sequence[str], masks: Flags) -> None:
    """Writes the masks (camera, row, column) of one frame as PNG, 255 on the body, where `mask_files` finds them."""
    for name, mask in zip(names, masks, strict=True):
        (folder / name).mkdir(exist_ok=True)
        Image.fromarray(mask.astype(np.uint8) * 255).save(folder / name / f"frame_{frame:04d}.png", optimize=False)


def _refuse_large(path: Path) -> None:
    """Refuses an archive that would unpack to more than a frame's masks can be."""
    import zipfile

    with zipfile.ZipFile(path) as archive:
        unpacked_bytes = sum(entry.file_size for entry in archive.infolist())
    if unpacked_bytes > MOST_BYTES:
        raise HullError(f"{path}: unpacks to {unpacked_bytes} bytes, more than {MOST_BYTES}; one frame's silhouettes need less")


def _by_number(folder: Path) -> Mapping[int, Path]:
    """The images of one camera by the last number in their names."""
    image_of: dict[int, Path] = {}
    for path in image_files(folder):
        digits = re.findall(r"[0-9]+", path.stem)
        if not digits:
            raise SourceError(f"{path}: no number in its name; the last number of an image's name says which frame it is of")
        frame = int(digits[-1])
        if frame in image_of:
            raise SourceError(f"{folder}: {image_of[frame].name} and {path.name} are both of frame {frame}; leave one out")
        image_of[frame] = path
    return image_of


def _image(path: Path) -> NDArray[Any]:
    """The brightest channel of an image, alpha left out."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            if why := too_large(path, MOST_BYTES):
                raise HullError(f"{path}: {why}")
            with Image.open(path, formats=_FORMATS) as image:
                if image.width * image.height > MOST_PIXELS:
                    raise HullError(f"{path}: {image.width} × {image.height} pixels are more than {MOST_PIXELS}")
                plain = image.mode not in ("P", "PA", "CMYK", "YCbCr", "HSV", "LAB")
                plain_image = image if plain else image.convert("RGB")
                values, bands = np.asarray(plain_image), plain_image.getbands()
    except HullError:
        raise
    except FileNotFoundError:
        raise HullError(f"{path}: there is no such file; it was there when the run was planned") from None
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise HullError(f"{path}: cannot be read as an image ({reason}); it is damaged or cut short") from None
    if values.ndim == 3:
        values = values[..., [n for n, band in enumerate(bands) if band not in ("A", "a")]].max(axis=-1)
    return values


def _checked(image: NDArray[Any], where: str, name: str, size: tuple[int, int] | None) -> Flags:
    """The image as a mask of its camera's size; raises HullError if it has another."""
    if size is not None and image.shape != size:
        raise HullError(
            f"{where}: {image.shape[1]} × {image.shape[0]} pixels, but camera {name} is calibrated for {size[1]} × {size[0]}; "
            "scale the masks or the calibration"
        )
    brightest = float(image.max()) if image.size else 0.0
    mask: Flags = np.asarray(image > 0.5 * brightest, dtype=np.bool_)
    return mask
