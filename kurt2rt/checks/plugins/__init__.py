"""Plug-ins of all kinds: which there are, and tests that those of other authors inherit."""
