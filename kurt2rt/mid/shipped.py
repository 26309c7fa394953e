"""Which shipped mid level a fingerprint belongs to: a knowledge file tells no more of its features than that."""

from config import CONFIG_DIR
from kurt2rt.mid.settings import MidSettings, load_mid


def shipped_mid(feature_hash: str) -> MidSettings | None:
    """The settings in `config/mid_levels` that have these features; None: settings of one's own, or of another kurt2rt.

    Raises hal.settings.SettingsError.
    """
    for path in sorted((CONFIG_DIR / "mid_levels").glob("*.yaml")):
        settings = load_mid(path.stem)
        if settings.feature_hash == feature_hash:
            return settings
    return None
