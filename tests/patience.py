"""Guard against a test that hangs: no test expects an event within a time of its own."""

PATIENCE_S = 120.0
"""Seconds after which an event that a test waits for never comes, on a machine however busy."""
