"""Perception: situation from sensor readings, by the definition that knowledge is bound to."""
