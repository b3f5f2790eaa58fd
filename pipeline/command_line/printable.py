"""Text that other people named, made safe to print: a file may be called anything, and a terminal obeys what it is sent."""


def printable(text: object, *, lines: bool = False) -> str:
    """The text with every character that is not plainly visible written as its escape.

    lines : whether line ends stay, for a text whose own they are
    """
    return "".join(c if c.isprintable() or (lines and c == "\n") else _escaped(c) for c in str(text))


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode()
