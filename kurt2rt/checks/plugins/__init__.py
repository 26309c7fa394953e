"""Plug-ins of all kinds: which there are, and whether they keep the promises of their kind."""
