"""Files from a foreign package or recording: the names that are safe, and their extraction as settings."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from config.plugins import settings_from_elsewhere

MOST_FILES = 1000
LARGEST_BYTES = 256_000_000
"""Allowed sum of their sizes: ten times that of 10 000 lessons and their counts."""

_LONGEST_NAME, _LONGEST_PART = 1000, 255
_DRIVE = re.compile(r"[A-Za-z]:")
_DEVICE = re.compile(r"(con|prn|aux|nul|(com|lpt)[0-9])(\..*)?", re.IGNORECASE)


def unsafe_reason(sizes: Mapping[str, int]) -> str:
    """Return why the files of a package or a run must not be unpacked, in a few words; empty if they are safe.

    `sizes`: size in bytes by name. Their author may mean harm: no name may lead out of the folder of the extraction.
    """
    if len(sizes) > MOST_FILES:
        return f"holds {len(sizes)} files, {MOST_FILES} are taken at most"
    if sum(sizes.values()) > LARGEST_BYTES:
        return f"holds more than {LARGEST_BYTES // 10**6} MB, which no knowledge is"
    for name in sizes:
        if not _is_plain(name):
            return f"holds a file of the name {_shortened(name)}, which is none that kurt2rt gives"
    folders = {"/".join(name.split("/")[:count]) for name in sizes for count in range(1, name.count("/") + 1)}
    for name in sorted(folders & sizes.keys()):
        return f"holds {_shortened(name)} as a file and as a folder"
    return ""


@contextmanager
def extracted_settings(files: Mapping[str, bytes]) -> Iterator[None]:
    """Load settings only from these files, by name, as long as the context lasts.

    The files must be safe, as `unsafe_reason` tells. Raises OSError if there is no room for them.
    """
    with TemporaryDirectory(prefix="kurt2rt-kept-") as folder:
        for name, data in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("xb") as file:  # refuses to replace a file of another name
                file.write(data)
        with settings_from_elsewhere(Path(folder, "settings")):
            yield


def _is_plain(name: str) -> bool:
    parts = name.split("/")
    return (
        name.isprintable()  # neither control characters nor half a surrogate pair
        and len(name) <= _LONGEST_NAME
        and "\\" not in name
        and not _DRIVE.match(name)
        and all(part.strip(". ") and len(part.encode()) <= _LONGEST_PART for part in parts)
        and not any(_DEVICE.fullmatch(part) for part in parts)
    )


def _shortened(name: str) -> str:
    text = repr(name)
    return text if len(text) <= 80 else f"{text[:77]}..."
