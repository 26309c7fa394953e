"""Checker of words: docstrings, test names and texts, with the number of findings still allowed per folder."""
