"""Attributes in /sys."""

from pathlib import Path


def read_attribute(path: Path) -> str:
    """Return the text of an attribute; empty if the kernel has none, as the carrier of an interface that is down."""
    try:
        return path.read_text(encoding="ascii").strip()
    except OSError:
        return ""
