"""What mid-level RLAs are bound to."""

from kurt2rt.knowledge.binding import LevelFeatures
from kurt2rt.mid.settings import MidSettings


def features(settings: MidSettings) -> LevelFeatures:
    """Names and fingerprint of the mid-level features, for a knowledge file."""
    return LevelFeatures(settings.feature_hash, settings.features)
