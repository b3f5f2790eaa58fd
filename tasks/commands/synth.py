"""`kinetree synth`: a synthetic sequence with its true skeleton, as files."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetree.errors import ConfigError

if TYPE_CHECKING:
    from kinetree.schemas.input.synth import ContactParams, DroppedParams, SynthParams


def synth(
    figure: Annotated[
        str,
        typer.Argument(
            help="adult, bird, human, quadruped, snake, starfish, adult:SEED, random:SEED, or a YAML file of your own."
        ),
    ] = "human",
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder to write; must be new or empty.")] = Path("synth"),
    motion: Annotated[
        str | None, typer.Option("--motion", help="One of the figure's motions; default: the first by name.")
    ] = None,
    frames: Annotated[int, typer.Option("--frames", min=1, help="How many frames.")] = 36,
    fps: Annotated[float | None, typer.Option("--fps", help="Frames a second; default: the figure's own.")] = None,
    vertices: Annotated[int, typer.Option("--vertices", min=100, help="Vertices of a frame, to within about a tenth.")] = 3000,
    clothes: Annotated[bool, typer.Option("--clothes", help="Loose clothes that lag and fold, on adult:SEED.")] = False,
    contact: Annotated[
        list[str] | None, typer.Option("--contact", metavar="LIMB:TARGET:BEGIN:END", help="A limb touches the body.")
    ] = None,
    drop: Annotated[
        list[str] | None, typer.Option("--drop", metavar="LIMB:BEGIN:END", help="A limb is missing in these frames.")
    ] = None,
    noise: Annotated[float, typer.Option("--noise", help="Noise along the normals, rms as a share of the height.")] = 0.0,
    holes: Annotated[int, typer.Option("--holes", min=0, help="Holes in every frame.")] = 0,
    hole_size: Annotated[float, typer.Option("--hole-size", help="Radius of a hole as a share of the height.")] = 0.03,
    fixed: Annotated[bool, typer.Option("--fixed", help="One skinned mesh: fixed connectivity.")] = False,
    paint: Annotated[
        str, typer.Option("--paint", metavar="CLOTHES", help="Colours of the skin: patterned, plain or none.")
    ] = "none",
    illumination: Annotated[
        float, typer.Option("--illumination", help="How far painted frames differ in exposure and light, 0 to 1.")
    ] = 0.0,
    grain: Annotated[float, typer.Option("--grain", help="Noise of painted colours, rms as a share of their range.")] = 0.01,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of everything random.")] = 0,
    volumes: Annotated[bool, typer.Option("--volumes", help="Also write a grid of signed distances for every frame.")] = False,
    silhouettes: Annotated[
        int, typer.Option("--silhouettes", min=0, metavar="CAMERAS", help="Also write silhouettes from a ring of cameras.")
    ] = 0,
) -> None:
    """Write a synthetic sequence with its true skeleton.

    Files: frame_0000.ply, frame_0001.ply, …, and truth.json.
    """
    from kinetree.tasks.input.synth import write_sequence

    params = _params(
        figure,
        motion=motion,
        frames=frames,
        fps=fps,
        vertices=vertices,
        clothes=clothes,
        contacts=tuple(_contact(text) for text in contact or ()),
        dropped=tuple(_dropped(text) for text in drop or ()),
        noise=noise,
        holes=holes,
        hole_size=hole_size,
        connectivity="fixed" if fixed else "new",
        paint=paint,
        illumination=illumination,
        grain=grain,
        seed=seed,
    )
    write_sequence(params, output, volumes=volumes, cameras=silhouettes)
    typer.echo(f"{output}: {frames} frames and truth.json; kinetree run --input {output} --output {output}-kinetree")


def _params(figure: str, **options: Any) -> "SynthParams":
    from kinetree.pipeline.settings.config import checked
    from kinetree.schemas.input.synth import SynthParams

    own = figure.endswith((".yaml", ".yml"))
    named = {"figure": "" if own else figure, "file": str(Path(figure).absolute()) if own else ""}
    return checked(SynthParams, {**named, **options}, "synth")


def _contact(text: str) -> "ContactParams":
    from kinetree.schemas.input.synth import ContactParams

    parts = text.split(":")
    if len(parts) != 4 or not all(p.strip().isdigit() for p in parts[2:]):
        raise ConfigError(f"--contact {text}: write LIMB:TARGET:BEGIN:END, e.g. hand_r:hip_r:12:26")
    return ContactParams(limb=parts[0], target=parts[1], begin=int(parts[2]), end=int(parts[3]))


def _dropped(text: str) -> "DroppedParams":
    from kinetree.schemas.input.synth import DroppedParams

    parts = text.split(":")
    if len(parts) != 3 or not all(p.strip().isdigit() for p in parts[1:]):
        raise ConfigError(f"--drop {text}: write LIMB:BEGIN:END, e.g. wrist_r:12:26")
    return DroppedParams(limb=parts[0], begin=int(parts[1]), end=int(parts[2]))
