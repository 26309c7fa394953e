"""Fingerprint of the knowledge."""

import hashlib
from collections.abc import Iterable

import numpy as np

from kurt2rt.core.rla.rla import BASIC, Rla


def knowledge_hash_of(rlas: Iterable[Rla]) -> str:
    """Return the SHA-256 of RLAs, given in the order of their ids; teachers and dates do not count."""
    digest = hashlib.sha256()
    for rla in rlas:
        at = f"at {rla.level} " if rla.level != BASIC else ""
        of = f"of {rla.behaviour} " if rla.behaviour else ""
        digest.update(f"{rla.rla_id} {at}{of}{rla.action} {rla.radius!r} ".encode())
        digest.update(np.array(rla.condition, dtype=np.float64).tobytes())
    return digest.hexdigest()
