"""Surprise study: ends of RLAs on known ground, and after a change."""
