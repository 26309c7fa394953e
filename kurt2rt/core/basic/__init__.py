"""Basic level: RLAs and policies that choose wheel speeds."""
