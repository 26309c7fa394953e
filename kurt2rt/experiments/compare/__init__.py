"""Comparison of learners that are taught by the same teacher on the same robots."""
