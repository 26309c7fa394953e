"""The one file: a ZIP archive with a manifest that names and fingerprints all that is in it, and maybe a signature."""

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
from kurt2rt.knowledge.knowledge_error import KnowledgeError

FORMAT = 1
"""Raise it when the manifest or the files below change, and keep reading older ones."""

MANIFEST, SIGNATURE = "manifest.json", "signature.json"
_FILES, _FORMAT = "files", "format"
_EPOCH = (1980, 1, 1, 0, 0, 0)
"""The same knowledge is the same file, whenever it is written."""
_SMALL_ENOUGH_TO_UNPACK = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Of others a few bytes may unpack to any number, whatever the archive says of their size."""


@dataclass(frozen=True)
class Archive:
    """What was read from one, and found to be whole."""

    manifest: Mapping[str, Any]
    files: Mapping[str, bytes]
    """By name."""
    signed_by: bytes | None
    """Raw public key; None: by nobody."""


def pack(about: Mapping[str, Any], files: Mapping[str, bytes], key: Ed25519PrivateKey | None) -> bytes:
    """An archive of some files; `about`: what the manifest says besides."""
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
    """Read an archive whole. Raises KnowledgeError that says what is wrong with it: torn, changed, of another kind."""
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise KnowledgeError("is a folder or device", where=path, do="give a file of kurt2rt knowledge export")
        if status.st_size > LARGEST_BYTES:
            raise KnowledgeError(f"is larger than {LARGEST_BYTES // 10**6} MB, which no knowledge is", where=path)
        with zipfile.ZipFile(path) as archive:
            content = _content(archive, path)
    except OSError as error:
        raise KnowledgeError(
            f"cannot be read ({error})", where=path, do="give a file of kurt2rt knowledge export"
        ) from error
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError) as error:
        raise KnowledgeError(
            f"is torn or changed, or no file of kurt2rt knowledge export ({error})", where=path, do="get it anew"
        ) from error
    if MANIFEST not in content:
        raise KnowledgeError(f"has no {MANIFEST}", where=path, do="give a file of kurt2rt knowledge export")
    manifest = _manifest(content[MANIFEST], path)
    files = {name: data for name, data in content.items() if name not in (MANIFEST, SIGNATURE)}
    for name in sorted(manifest[_FILES].keys() | files.keys()):
        if name not in files:
            raise KnowledgeError(f"{name} is missing in it", where=path, do="get it anew")
        if manifest[_FILES].get(name) != hashlib.sha256(files[name]).hexdigest():
            raise KnowledgeError(f"{name} was changed after it was exported (SHA-256)", where=path, do="get it anew")
    return Archive(manifest, files, _signer(content, path))


def _content(archive: zipfile.ZipFile, path: Path) -> dict[str, bytes]:
    entries = archive.infolist()
    sizes = {entry.orig_filename: entry.file_size for entry in entries}  # before anything in it was cut off
    if len(sizes) < len(entries) or len({name.casefold() for name in sizes}) < len(entries):
        raise KnowledgeError("holds a file twice", where=path, do="get it anew")
    trouble = unsafe_reason(sizes)
    if trouble:
        raise KnowledgeError(trouble, where=path, do="nothing of it was read: get it anew from whom you trust")
    if not all(entry.compress_type in _SMALL_ENOUGH_TO_UNPACK for entry in entries):
        raise KnowledgeError(
            "is packed in a way that kurt2rt knowledge export does not use", where=path, do="get it anew"
        )
    return {entry.orig_filename: archive.read(entry) for entry in entries}


def _manifest(data: bytes, path: Path) -> dict[str, Any]:
    try:
        manifest = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise KnowledgeError(f"its {MANIFEST} is damaged ({error})", where=path, do="get it anew") from error
    if not isinstance(manifest, dict) or not isinstance(manifest.get(_FORMAT), int):
        raise KnowledgeError(
            f"its {MANIFEST} is none of kurt2rt", where=path, do="give a file of kurt2rt knowledge export"
        )
    if manifest[_FORMAT] > FORMAT:
        raise KnowledgeError(
            f"has format {manifest[_FORMAT]} of a newer kurt2rt, this one knows up to {FORMAT}",
            where=path,
            do="update kurt2rt",
        )
    if not isinstance(manifest.get(_FILES), dict):
        raise KnowledgeError(f"its {MANIFEST} names no files", where=path, do="get it anew")
    return manifest


def _signer(content: Mapping[str, bytes], path: Path) -> bytes | None:
    if SIGNATURE not in content:
        return None
    try:
        signed = json.loads(content[SIGNATURE])
        public, signature = (base64.b64decode(signed[each], validate=True) for each in ("public_key", "signature"))
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise KnowledgeError(f"its {SIGNATURE} is damaged ({error!r})", where=path, do="get it anew") from error
    if not is_signed(content[MANIFEST], public, signature):
        raise KnowledgeError(
            "its signature does not fit: it was changed after it was signed", where=path, do="get it anew"
        )
    return public


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode()
