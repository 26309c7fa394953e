"""What the kernel tells in /sys."""

from pathlib import Path


def read_attribute(path: Path) -> str:
    """Text of one file; empty where the kernel has nothing to tell, as for the carrier of an interface that is down."""
    try:
        return path.read_text(encoding="ascii").strip()
    except OSError:
        return ""
