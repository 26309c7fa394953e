"""Hash of the whole program with its settings, by which two machines know that they have the same one."""

import hashlib
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from kurt2rt.experiments.study.import_graph import PACKAGES
from kurt2rt.experiments.study.provenance import versions

_SUFFIXES = {".py", ".yaml", ".dbc", ".json", ".png", ".pgm"}
"""Files that decide results: source, settings, the CAN database, and maps."""


@lru_cache
def program_hash() -> str:
    """Return the hash of all source and shipped settings, and of the versions of Python and the computing packages."""
    digest = hashlib.sha256(versions().encode())
    for package in PACKAGES:
        spec = find_spec(package)
        assert spec is not None
        assert spec.origin is not None
        folder = Path(spec.origin).parent
        for path in sorted(folder.rglob("*")):
            if path.suffix in _SUFFIXES:
                digest.update(f"{package}/{path.relative_to(folder).as_posix()}\0".encode())
                digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]
