"""Package file: a ZIP archive with a manifest of the SHA-256 of each file in it, and maybe a signature."""

import base64
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

from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

from kurt2rt.knowledge.exchange.attachment_files import LARGEST_BYTES, unsafe_reason
from kurt2rt.knowledge.exchange.signing import is_signed, signature_of
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError

FORMAT = 1
"""Raise it when the manifest or the files change, and keep reading older formats."""

MANIFEST, SIGNATURE = "manifest.json", "signature.json"
_FILES, _FORMAT = "files", "format"
_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Date of every entry: equal knowledge makes equal files, whenever it is written."""
_SMALL_ENOUGH_TO_UNPACK = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Compressions whose unpacked size zipfile checks against the archive's entry."""


@dataclass(frozen=True)
class Archive:
    """Content of an archive that was checked."""

    manifest: Mapping[str, Any]
    files: Mapping[str, bytes]
    """Content by name."""
    signed_by: bytes | None
    """Raw public key, 32 bytes; None: not signed."""


def pack(about: Mapping[str, Any], files: Mapping[str, bytes], key: Ed25519PrivateKey | None) -> bytes:
    """Return the bytes of an archive (ZIP) of `files`, content by name.

    Args:
        about: further fields of its manifest, as JSON values.
        files: content by name.
        key: that signs the manifest; None: not signed.
    """
    prints = {name: hashlib.sha256(content).hexdigest() for name, content in sorted(files.items())}
    manifest = json.dumps({_FORMAT: FORMAT, **about, _FILES: prints}, indent=1).encode()
    content = {MANIFEST: manifest, **dict(sorted(files.items()))}
    if key is not None:
        public, signature = signature_of(manifest, key)
        signed = {"public_key": _text(public), "signature": _text(signature)}
        content[SIGNATURE] = json.dumps(signed, indent=1).encode()
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)
    return buffer.getvalue()


def unpack(path: Path) -> Archive:
    """Read an archive and check its hashes and signature.

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
    manifest_data = _own(content, MANIFEST, path)
    if manifest_data is None:
        raise KnowledgeError(KnowledgeCode.PACKAGE_PART_MISSING, where=path, name=MANIFEST)
    manifest = _manifest(manifest_data, path)
    by_hash = {hashlib.sha256(data).hexdigest(): data for _, data in content}
    files = {name: by_hash.get(str(print_), b"") for name, print_ in sorted(manifest[_FILES].items())}
    _require_safe({name: len(data) for name, data in files.items()}, path)
    for name, data in files.items():
        if manifest[_FILES][name] != hashlib.sha256(data).hexdigest():
            changed = any(each.endswith(name) for each, _ in content)
            code = KnowledgeCode.PACKAGE_PART_CHANGED if changed else KnowledgeCode.PACKAGE_PART_MISSING
            raise KnowledgeError(code, where=path, name=name)
    return Archive(manifest, files, _signer(manifest_data, _own(content, SIGNATURE, path), path))


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


def _own(content: Iterable[tuple[str, bytes]], name: str, path: Path) -> bytes | None:
    """Return the file of a name in whatever folder; None if there is none. Raises KnowledgeError if there are two."""
    found = [data for each, data in content if each.rpartition("/")[2] == name]
    if len(found) > 1:
        raise KnowledgeError(KnowledgeCode.PACKAGE_DUPLICATE_NAME, where=path, name=name)
    return found[0] if found else None


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
    if manifest[_FORMAT] > FORMAT:
        raise KnowledgeError(KnowledgeCode.PACKAGE_NEWER_FORMAT, where=path, version=manifest[_FORMAT], allowed=FORMAT)
    if not isinstance(manifest.get(_FILES), dict):
        raise KnowledgeError(KnowledgeCode.PACKAGE_NOT_OURS, where=path, name=MANIFEST)
    return manifest


def _signer(manifest: bytes, signature_file: bytes | None, path: Path) -> bytes | None:
    if signature_file is None:
        return None
    try:
        signed = json.loads(signature_file)
        public, signature = (base64.b64decode(signed[each], validate=True) for each in ("public_key", "signature"))
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise KnowledgeError(KnowledgeCode.SIGNATURE_DAMAGED, where=path, name=SIGNATURE, error=repr(error)) from error
    if not is_signed(manifest, public, signature):
        raise KnowledgeError(KnowledgeCode.SIGNATURE_WRONG, where=path)
    return public


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode()
