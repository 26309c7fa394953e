"""Cells of the tables that show knowledge."""

from rich.text import Text


def printable(text: str) -> Text:
    """Return the text without markup; characters that are not printable, as in escape sequences, are replaced."""
    return Text("".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text))


def stamp_and_teacher(stamped_at: str, teacher: str) -> Text:
    """Return a cell with a stamp, cut to the second, and the teacher."""
    return printable(f"{stamped_at[:19].replace('T', ' ')}, {teacher}")
