"""Kinds of symbols of a history, one per file."""
