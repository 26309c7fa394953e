"""Package file: a ZIP archive with a manifest of the SHA-256 of each file in it."""

import hashlib
import io
import json
import stat
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kurt2rt.knowledge.exchange.attachment_files import LARGEST_BYTES, unsafe_reason
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError

FORMAT = 1
"""Format of the manifest and the files."""

MANIFEST = "manifest.json"
_FILES, _FORMAT = "files", "format"
_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Date of every entry: equal knowledge makes equal files, whenever it is written."""
_SMALL_ENOUGH_TO_UNPACK = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Compressions whose unpacked size zipfile checks against the archive's entry."""


@dataclass(frozen=True)
class Archive:
    """Manifest and files of a package, each compared with its SHA-256."""

    manifest: Mapping[str, Any]
    files: Mapping[str, bytes]
    """Content by name."""


def pack(about: Mapping[str, Any], files: Mapping[str, bytes]) -> bytes:
    """Return the bytes of an archive (ZIP) of `files`, content by name.

    `about`: further fields of its manifest, as JSON values.
    """
    prints = {name: hashlib.sha256(content).hexdigest() for name, content in sorted(files.items())}
    manifest = json.dumps({_FORMAT: FORMAT, **about, _FILES: prints}, indent=1).encode()
    content = {MANIFEST: manifest, **dict(sorted(files.items()))}
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)
    return buffer.getvalue()


def unpack(path: Path) -> Archive:
    """Read an archive and check its hashes.

    Raises KnowledgeError if it is unreadable, truncated, changed or of another kind.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise KnowledgeError(KnowledgeCode.PACKAGE_NOT_A_FILE, where=path)
        if status.st_size > LARGEST_BYTES:
            raise KnowledgeError(KnowledgeCode.PACKAGE_TOO_LARGE, where=path, allowed_mb=LARGEST_BYTES // 10**6)
        with zipfile.ZipFile(path) as archive:
            content = _content(archive, path)
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.PACKAGE_UNREADABLE, where=path, error=error) from error
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError) as error:
        raise KnowledgeError(KnowledgeCode.PACKAGE_DAMAGED, where=path, error=error) from error
    manifest = _manifest(_manifest_data(content, path), path)
    by_hash = {hashlib.sha256(data).hexdigest(): data for _, data in content}
    files = {name: by_hash.get(str(print_), b"") for name, print_ in sorted(manifest[_FILES].items())}
    _require_safe({name: len(data) for name, data in files.items()}, path)
    for name, data in files.items():
        if manifest[_FILES][name] != hashlib.sha256(data).hexdigest():
            changed = any(each.endswith(name) for each, _ in content)
            code = KnowledgeCode.PACKAGE_PART_CHANGED if changed else KnowledgeCode.PACKAGE_PART_MISSING
            raise KnowledgeError(code, where=path, name=name)
    return Archive(manifest, files)


def _content(archive: zipfile.ZipFile, path: Path) -> list[tuple[str, bytes]]:
    """Return the entries, with slashes in their names.

    The names lead nowhere, and the manifest's hashes tell which entry is which file: macOS and Windows put a folder
    around files that they pack again, and files of their own next to them.
    """
    entries = archive.infolist()
    _require_safe({str(number): entry.file_size for number, entry in enumerate(entries)}, path)
    if not all(entry.compress_type in _SMALL_ENOUGH_TO_UNPACK for entry in entries):
        raise KnowledgeError(KnowledgeCode.PACKAGE_COMPRESSION, where=path)
    return [(entry.orig_filename.replace("\\", "/"), archive.read(entry)) for entry in entries]


def _manifest_data(content: Iterable[tuple[str, bytes]], path: Path) -> bytes:
    """Return the manifest, in whatever folder it is. Raises KnowledgeError if there is none or there are two."""
    found = [data for name, data in content if name.rpartition("/")[2] == MANIFEST]
    if not found:
        raise KnowledgeError(KnowledgeCode.PACKAGE_PART_MISSING, where=path, name=MANIFEST)
    if len(found) > 1:
        raise KnowledgeError(KnowledgeCode.PACKAGE_DUPLICATE_NAME, where=path, name=MANIFEST)
    return found[0]


def _require_safe(sizes: Mapping[str, int], path: Path) -> None:
    reason = unsafe_reason(sizes)
    if reason:
        raise KnowledgeError(KnowledgeCode.PACKAGE_UNSAFE, where=path, reason=reason)


def _manifest(data: bytes, path: Path) -> dict[str, Any]:
    try:
        manifest = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise KnowledgeError(KnowledgeCode.MANIFEST_DAMAGED, where=path, name=MANIFEST, error=error) from error
    if not isinstance(manifest, dict) or not isinstance(manifest.get(_FORMAT), int):
        raise KnowledgeError(KnowledgeCode.PACKAGE_NOT_OURS, where=path, name=MANIFEST)
    if manifest[_FORMAT] != FORMAT:
        raise KnowledgeError(KnowledgeCode.PACKAGE_OTHER_FORMAT, where=path, version=manifest[_FORMAT], allowed=FORMAT)
    if not isinstance(manifest.get(_FILES), dict):
        raise KnowledgeError(KnowledgeCode.PACKAGE_NOT_OURS, where=path, name=MANIFEST)
    return manifest
