"""Fingerprint of what is known."""

import hashlib
from collections.abc import Iterable

import numpy as np

from kurt2rt.core.rla.rla import BASIC, Rla


def knowledge_hash_of(rlas: Iterable[Rla]) -> str:
    """SHA-256 of RLAs in the order of their ids: levels, behaviours, conditions, actions, radii; not who taught."""
    digest = hashlib.sha256()
    for rla in rlas:
        at = f"at {rla.level} " if rla.level != BASIC else ""
        of = f"of {rla.behaviour} " if rla.behaviour else ""
        digest.update(f"{rla.rla_id} {at}{of}{rla.action} {rla.radius!r} ".encode())
        digest.update(np.array(rla.condition, dtype=np.float64).tobytes())
    return digest.hexdigest()
