"""Ed25519 keys of those who give knowledge away, as PEM files."""

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

from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import fsync_folder

PUBLIC_KEY_BYTES = 32


def make_key(path: Path) -> Path:
    """Make a key at `path`, for its owner alone, and its public half beside it; returns where that is.

    Raises KnowledgeError, also where one of both is there already, and leaves nothing: a lost key cannot be made again.
    """
    if not path.name:
        raise KnowledgeError("is a folder", where=path, do="give the key file to make")
    key, public = Ed25519PrivateKey.generate(), path.with_name(path.name + ".pub")
    secret = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    open_half = key.public_key().public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo)
    written = list[Path]()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # The public half first: where one is there already, nothing secret is left lying about.
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
        raise KnowledgeError(
            f"no key can be made there ({error})", where=path, do="give the path of a new file"
        ) from error
    return public


def read_private_key(path: Path) -> Ed25519PrivateKey:
    """The key in a PEM file. Raises KnowledgeError."""
    try:
        key = load_pem_private_key(path.read_bytes(), password=None)
    except (OSError, ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise KnowledgeError(
            f"is no key that can sign ({error})", where=path, do="kurt2rt knowledge key makes one"
        ) from error
    if not isinstance(key, Ed25519PrivateKey):
        raise KnowledgeError("is a key of another kind than Ed25519", where=path, do="kurt2rt knowledge key makes one")
    return key


def read_public_key(path: Path) -> bytes:
    """The public half in a PEM file, raw. Raises KnowledgeError."""
    try:
        key = load_pem_public_key(path.read_bytes())
    except (OSError, ValueError, UnsupportedAlgorithm) as error:
        raise KnowledgeError(
            f"is no public key ({error})", where=path, do="give the .pub file of whom you trust"
        ) from error
    if not isinstance(key, Ed25519PublicKey):
        raise KnowledgeError(
            "is a public key of another kind than Ed25519", where=path, do="give the .pub file of a signer"
        )
    return key.public_bytes_raw()


def signature_of(content: bytes, key: Ed25519PrivateKey) -> tuple[bytes, bytes]:
    """The public key, raw, and the signature."""
    return key.public_key().public_bytes_raw(), key.sign(content)


def is_signed(content: bytes, public_key: bytes, signature: bytes) -> bool:
    """Whether the owner of that key has signed exactly this."""
    try:
        Ed25519PublicKey.from_public_bytes(public_key).verify(signature, content)
    except (InvalidSignature, ValueError):
        return False
    return True


def fingerprint(public_key: bytes) -> str:
    """What people compare: the first 64 bits of the SHA-256 of a raw public key, hexadecimal."""
    return hashlib.sha256(public_key).hexdigest()[:16]
