"""A run that follows its input as it grows: look, compute what is complete, look again (polling alone, nothing to install)."""

import contextlib
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from kinetree.errors import InputError, ServiceError
from kinetree.pipeline.identity.key import artifact_digest
from kinetree.pipeline.inspection.history import History
from kinetree.pipeline.inspection.origins import origin_artifacts
from kinetree.pipeline.storage.files import Files, Settling
from kinetree.schemas.array import Index

if TYPE_CHECKING:
    from kinetree.pipeline.inspect import Pipeline

Content = list[tuple[str, Index, str]]
"""Of every member that an origin found its name, index and digest."""
POLL_SECONDS = 1.0
"""Between two looks at the input; a file whose size and times are the same in both is taken for complete."""


def follow(
    pipeline: "Pipeline",
    compute: Callable[[Settling], Any],
    tell: Callable[[str], None],
    *,
    idle: float | None = None,
    pause: Callable[[float], None] = time.sleep,
    poll: float = POLL_SECONDS,
) -> int:
    """Computes whenever the input has something new that is complete, until nothing new came for `idle` seconds or for ever.

    compute : runs the pipeline on the files that are complete; what it raises ends following
    tell    : hears why nothing is computed yet, in words, each reason once
    pause   : waits for so many seconds
    returns : how often it computed; also after an interruption while nothing was under way
    raises  : InputError where nothing was computed because the input was wrong; ServiceError where a bucket's service failed to
              the end; KeyboardInterrupt out of a run
    """
    settling, waited, rounds = Settling(), 0.0, 0
    last: Content | None = None
    wrong: InputError | None = None
    with contextlib.suppress(InputError):  # no file is complete at the first look
        _content(pipeline, settling)
    while idle is None or waited < max(idle, poll):
        try:
            pause(poll)
        except KeyboardInterrupt:  # nothing is under way
            break
        waited += poll
        settling.look()
        try:
            now = _content(pipeline, settling)
            if now != last:
                last = now
                compute(settling)
                waited, wrong, rounds = 0.0, None, rounds + 1
        except InputError as error:
            if str(error) != str(wrong):
                tell(f"waiting: {error}")
            if isinstance(error, ServiceError):  # nothing new is needed to try again
                last = None
            wrong = error
    if wrong is not None and (not rounds or isinstance(wrong, ServiceError)):
        raise wrong
    return rounds


def _content(pipeline: "Pipeline", settling: Settling) -> Content:
    """What the origins find in the files that are complete, by digest."""
    files = Files.of(pipeline.store, settling)
    artifacts, _ = origin_artifacts(pipeline.tasks, pipeline.config, files, History.of(pipeline.store, pipeline.config))
    files.save()
    return [
        (name, index, artifact_digest(artifact)) for name, members in artifacts.items() for index, artifact in members.items()
    ]
