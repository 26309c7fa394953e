"""Package file: a ZIP archive with a manifest of the SHA-256 of each file in it, and maybe a signature."""

import base64
import hashlib
import io
import json
import stat
import zipfile
import zlib
from collections.abc import Mapping
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
    if MANIFEST not in content:
        raise KnowledgeError(KnowledgeCode.PACKAGE_PART_MISSING, where=path, name=MANIFEST)
    manifest = _manifest(content[MANIFEST], path)
    files = {name: data for name, data in content.items() if name not in (MANIFEST, SIGNATURE)}
    for name in sorted(manifest[_FILES].keys() | files.keys()):
        if name not in files:
            raise KnowledgeError(KnowledgeCode.PACKAGE_PART_MISSING, where=path, name=name)
        if manifest[_FILES].get(name) != hashlib.sha256(files[name]).hexdigest():
            raise KnowledgeError(KnowledgeCode.PACKAGE_PART_CHANGED, where=path, name=name)
    return Archive(manifest, files, _signer(content, path))


def _content(archive: zipfile.ZipFile, path: Path) -> dict[str, bytes]:
    entries = archive.infolist()
    sizes = {entry.orig_filename: entry.file_size for entry in entries}  # names before zipfile cuts them at a null byte
    if len(sizes) < len(entries) or len({name.casefold() for name in sizes}) < len(entries):
        raise KnowledgeError(KnowledgeCode.PACKAGE_DUPLICATE_NAME, where=path)
    reason = unsafe_reason(sizes)
    if reason:
        raise KnowledgeError(KnowledgeCode.PACKAGE_UNSAFE, where=path, reason=reason)
    if not all(entry.compress_type in _SMALL_ENOUGH_TO_UNPACK for entry in entries):
        raise KnowledgeError(KnowledgeCode.PACKAGE_COMPRESSION, where=path)
    return {entry.orig_filename: archive.read(entry) for entry in entries}


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


def _signer(content: Mapping[str, bytes], path: Path) -> bytes | None:
    if SIGNATURE not in content:
        return None
    try:
        signed = json.loads(content[SIGNATURE])
        public, signature = (base64.b64decode(signed[each], validate=True) for each in ("public_key", "signature"))
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise KnowledgeError(KnowledgeCode.SIGNATURE_DAMAGED, where=path, name=SIGNATURE, error=repr(error)) from error
    if not is_signed(content[MANIFEST], public, signature):
        raise KnowledgeError(KnowledgeCode.SIGNATURE_WRONG, where=path)
    return public


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode()
