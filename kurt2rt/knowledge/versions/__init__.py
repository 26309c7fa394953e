"""Versions of knowledge: undo, branch, diff, merge."""
