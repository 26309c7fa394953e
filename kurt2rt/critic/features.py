"""What appraisals are bound to."""

from kurt2rt.critic.settings import CriticSettings
from kurt2rt.knowledge.binding import LevelFeatures


def features(settings: CriticSettings) -> LevelFeatures:
    """Names and fingerprint of the circumstances, for a knowledge file."""
    return LevelFeatures(settings.feature_hash, settings.names)
