"""What sets a parameter on the command line: --set, or an option of its own such as --output."""

from typing import Self


class OptionSetting(str):
    """A setting as --set takes it, task.name=value, that an option of its own gave."""

    typed: str
    """The option and its value, as the user typed them."""

    @classmethod
    def of(cls, option: str, parameter: str, value: str) -> Self:
        """The setting of a text, whatever characters it has."""
        quoted = "".join(c if c.isascii() and c.isalnum() else f"\\U{ord(c):08x}" for c in value)
        setting = cls(f'{parameter}="{quoted}"')
        setting.typed = f"{option} {value}"
        return setting


def as_typed(setting: str) -> str:
    """What the user typed to set a parameter, for messages."""
    return setting.typed if isinstance(setting, OptionSetting) else f"--set {setting}"
