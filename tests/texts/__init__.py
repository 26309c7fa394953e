"""Listings of text tables for the golden files: one module per table, see `tests.golden_texts`."""
