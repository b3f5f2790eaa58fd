"""Results that were computed with library versions which somebody no longer trusts."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kinetree.errors import ConfigError
from kinetree.pipeline.storage.store import Record

if TYPE_CHECKING:  # few runs distrust a version
    from packaging.requirements import Requirement


@dataclass(frozen=True)
class MadeWith:
    """Libraries with versions, as requirements say them: "scipy<1.17", "numpy==2.1.0"."""

    requirements: "tuple[Requirement, ...]" = ()

    @staticmethod
    def of(texts: Iterable[str]) -> "MadeWith":
        """The libraries that texts name; raises ConfigError where one is no requirement or names no version."""
        return MadeWith(tuple(_requirement(text) for text in texts))

    def __call__(self, record: Record) -> str | None:
        """Which of the libraries took part in a record, with its version; None where none did."""
        for requirement in self.requirements:
            version = record.versions.get(requirement.name)
            if version is not None and _has(requirement, version):
                return f"{requirement.name} {version}"
        return None


EVERY_VERSION_TRUSTED = MadeWith()


def _requirement(text: str) -> "Requirement":
    from packaging.requirements import InvalidRequirement, Requirement

    try:
        requirement = Requirement(text)
    except InvalidRequirement:
        raise ConfigError(f"made with {text!r}: expected a library and its versions, e.g. scipy<1.17") from None
    if not requirement.specifier:
        raise ConfigError(f"made with {text!r}: name its versions too, e.g. {requirement.name}<1.17")
    return requirement


def _has(requirement: "Requirement", version: str) -> bool:
    from packaging.version import InvalidVersion

    try:
        return requirement.specifier.contains(version, prereleases=True)
    except InvalidVersion:
        return False
