"""Where the frames are: meshes, silhouettes or volumes, a file each or in one file that holds all, or a synthetic body."""

from collections.abc import Mapping, Sequence

from kinetree.errors import SourceError
from kinetree.pipeline.identity.key import digest
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.task import origin
from kinetree.schemas.input.source import BadFrame, Source, SourceParams
from kinetree.tasks.input.frames.listing import frames_at
from kinetree.tasks.input.frames.measured import measures_of_frames
from kinetree.tasks.input.frames.read import surface
from kinetree.tasks.numerics.input.bad_frames import (
    FrameMeasures,
    bad_frames,
    frames_of_other_bodies,
    refuse_bad,
    refuse_other_bodies,
)
from kinetree.tasks.numerics.input.frame_numbers import TAKE, selected_frames
from kinetree.tasks.numerics.input.same_surfaces import have_same_frames, have_same_measures, surface_distance


@origin(over="frame")
def source(params: SourceParams, files: Files) -> Mapping[int, Source]:
    """Finds the frames of a sequence and the digest of each one's bytes (2014, Sec. 3)."""
    if params.takes:
        return _several(params, files)
    if params.synth is not None:
        if params.input:
            raise SourceError(f"source.input ({params.input}) and source.synth exclude each other; leave one out")
        from kinetree.tasks.input.synth import recipe  # what generates bodies takes a second to import

        return _chosen(_generated(recipe(params.synth), params.synth.frames), params.frames, "the synthetic sequence")
    if not params.input:
        raise SourceError("no input: name a folder of meshes with --input, or source.input in the config")
    return _usable(_chosen(frames_at(params.input, files, params.clip), params.frames, params.input), params, files)


def _several(params: SourceParams, files: Files) -> dict[int, Source]:
    """The frames of several takes, numbered one take after the other; bad frames are looked for in each take by itself.

    raises : SourceError where a take shows another body, or the same frames as one before it, also in files of another format
    """
    if params.input or params.synth is not None:
        raise SourceError("source.takes excludes source.input and source.synth; name each take's input in source.takes")
    names = [take.name for take in params.takes]
    if len({name.casefold() for name in names}) < len(names) or not all(take.input for take in params.takes):
        raise SourceError(
            f"source.takes: {', '.join(names)}: each take needs an input, and a name that differs from the others in more than"
            " capitals"
        )
    numbered: dict[int, Source] = {}
    measured: dict[str, list[FrameMeasures]] = {}
    known: dict[str, dict[int, Source]] = {}
    for k, take in enumerate(params.takes):
        own = _usable(_chosen(frames_at(take.input, files, take.clip), params.frames, take.input), params, files)
        measured[take.name] = [m for m in measures_of_frames(own, files).values() if not isinstance(m, str)]
        for other, frames in known.items():
            if _are_same(frames, own, measured[other], measured[take.name], files):
                raise SourceError(
                    f"source.takes: {other} and {take.name} have the same frames ({take.input}); leave one of them out"
                )
        known[take.name] = own
        for t, frame in own.items():
            dropped = tuple(bad.model_copy(update={"frame": k * TAKE + bad.frame}) for bad in frame.dropped)
            numbered[k * TAKE + t] = frame.model_copy(update={"take": take.name, "dropped": dropped})
    refuse_other_bodies(measured)
    return numbered


def _are_same(
    some: Mapping[int, Source],
    others: Mapping[int, Source],
    measures: Sequence[FrameMeasures],
    other_measures: Sequence[FrameMeasures],
    files: Files,
) -> bool:
    """Whether two takes have the same frames; surfaces are read only where their measures are the same."""
    pairs = list(zip(some.values(), others.values(), strict=False))
    if [a.content for a in some.values()] == [b.content for b in others.values()]:
        return True
    if not have_same_measures(measures, other_measures) or any(files.is_remote(f.path) for pair in pairs for f in pair):
        return False

    def apart(t: int, u: int) -> float:
        return surface_distance(*surface(pairs[t][0]), *surface(pairs[u][1]))

    def changed(t: int, u: int) -> float:
        return surface_distance(*surface(pairs[t][0]), *surface(pairs[u][0]))

    return have_same_frames(len(pairs), apart, changed)


def _usable(sources: Mapping[int, Source], params: SourceParams, files: Files) -> dict[int, Source]:
    """The frames without those that cannot be of the same body as the others; the frame before a dropped one names it.

    raises : SourceError where there are more of them than may be dropped
    """
    measured = measures_of_frames(sources, files)
    bad = bad_frames(measured)
    if params.other_body == "drop":
        usable = {t: m for t, m in measured.items() if t not in bad and not isinstance(m, str)}
        bad = dict(sorted((bad | frames_of_other_bodies(usable)).items()))
    refuse_bad(bad, len(sources), params.bad_share if params.on_bad_frame == "drop" else None)
    good = [t for t in sources if t not in bad]
    if bad and len(good) < 2:
        refuse_bad(bad, len(sources), None)
    after: dict[int, list[BadFrame]] = {}
    for t, reason in bad.items():
        before = max((g for g in good if g < t), default=good[0])
        after.setdefault(before, []).append(BadFrame(frame=t, reason=reason))
    return {t: sources[t].model_copy(update={"dropped": tuple(after[t])}) if t in after else sources[t] for t in good}


def _generated(written: str, frames: int) -> dict[int, Source]:
    """Every frame of a synthetic sequence."""
    from kinetree.tasks.input.synth import body

    generated = body(written)
    unit, fps = generated.figure.unit, generated.fps
    stated = {"path": "synth", "kind": "synth", "recipe": written, "fps": fps, "unit": unit}
    return {t: Source(content=digest(["synth", written, t]), part=t, **stated) for t in range(frames)}


def _chosen(sources: Mapping[int, Source], frames: str, where: str) -> dict[int, Source]:
    """The frames wanted, by number, each of which knows the first and last number of all."""
    chosen = selected_frames(frames, list(sources), where)
    if len(chosen) < 2:
        selection = f"frames {frames!r} selects" if len(sources) > 1 else f"{where}: there is"
        raise SourceError(f"{selection} a single frame; kinematics are seen in motion, give at least two frames")
    series = min(sources), max(sources)
    return {frame: sources[frame].model_copy(update={"series": series}) for frame in chosen}
