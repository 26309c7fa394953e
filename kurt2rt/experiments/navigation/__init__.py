"""Errands: places and ways taught by leading the robot about, then goals that were never demonstrated as a whole."""
