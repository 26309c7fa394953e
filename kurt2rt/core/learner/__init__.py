"""Learners that may decide in place of the RLAs, and the level that drives by them."""
