"""Ed25519 keys that sign packages of knowledge, as PEM files."""

import hashlib
import os
from pathlib import Path

from cryptography.exceptions import InvalidSignature, UnsupportedAlgorithm
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    PublicFormat,
    load_pem_private_key,
    load_pem_public_key,
)

from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import fsync_folder

PUBLIC_KEY_BYTES = 32


def make_key(path: Path) -> Path:
    """Make a private key at `path`, readable by its owner only, and its public half next to it; return that path.

    Raises:
        KnowledgeError: one of both files exists, or none can be made; no file is left or changed then.
    """
    if not path.name:
        raise KnowledgeError(KnowledgeCode.KEY_IS_FOLDER, where=path)
    key, public = Ed25519PrivateKey.generate(), path.with_name(path.name + ".pub")
    secret = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    open_half = key.public_key().public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo)
    written = list[Path]()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # The public half first: if that file exists, no secret was written yet.
        for place, content, mode in ((public, open_half, 0o644), (path, secret, 0o600)):
            with os.fdopen(os.open(place, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
                written.append(place)
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
        fsync_folder(path.parent)
    except OSError as error:
        for place in written:
            place.unlink(missing_ok=True)
        raise KnowledgeError(KnowledgeCode.KEY_NOT_MADE, where=path, error=error) from error
    return public


def read_private_key(path: Path) -> Ed25519PrivateKey:
    """Return the private key in a PEM file. Raises KnowledgeError if it cannot be read or is no such key."""
    try:
        key = load_pem_private_key(path.read_bytes(), password=None)
    except (OSError, ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise KnowledgeError(KnowledgeCode.NO_PRIVATE_KEY, where=path, error=error) from error
    if not isinstance(key, Ed25519PrivateKey):
        raise KnowledgeError(KnowledgeCode.NO_PRIVATE_KEY, where=path, error="another kind of key")
    return key


def read_public_key(path: Path) -> bytes:
    """Return the public key in a PEM file, 32 raw bytes.

    Raises KnowledgeError if it cannot be read or is no such key.
    """
    try:
        key = load_pem_public_key(path.read_bytes())
    except (OSError, ValueError, UnsupportedAlgorithm) as error:
        raise KnowledgeError(KnowledgeCode.NO_PUBLIC_KEY, where=path, error=error) from error
    if not isinstance(key, Ed25519PublicKey):
        raise KnowledgeError(KnowledgeCode.NO_PUBLIC_KEY, where=path, error="another kind of key")
    return key.public_bytes_raw()


def signature_of(content: bytes, key: Ed25519PrivateKey) -> tuple[bytes, bytes]:
    """Return the raw public key (32 bytes) and the signature (64 bytes, Ed25519) of `content`."""
    return key.public_key().public_bytes_raw(), key.sign(content)


def is_signed(content: bytes, public_key: bytes, signature: bytes) -> bool:
    """Return whether the owner of `public_key` (raw) signed exactly this content."""
    try:
        Ed25519PublicKey.from_public_bytes(public_key).verify(signature, content)
    except (InvalidSignature, ValueError):
        return False
    return True


def fingerprint(public_key: bytes) -> str:
    """Return the first 64 bits of the SHA-256 of a raw public key, hexadecimal, for people to compare."""
    return hashlib.sha256(public_key).hexdigest()[:16]
