"""Replay of a recorded run: the recorded inputs through the same tick, with the same or other knowledge."""
