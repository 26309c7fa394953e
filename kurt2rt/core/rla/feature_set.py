"""Features of the conditions of one level."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LevelFeatures:
    """Names and fingerprint of the features of one level."""

    feature_hash: str
    """Fingerprint of all settings that define these features."""
    feature_names: tuple[str, ...]
    """One per dimension of a condition."""
