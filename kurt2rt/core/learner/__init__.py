"""Learners that may decide instead of the RLAs, and the level that drives by them."""
