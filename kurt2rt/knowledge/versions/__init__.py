"""Versions of knowledge: undo, diff, merge."""
