"""Judges: rewards of -1, 0 or +1 for the way the robot drives."""
