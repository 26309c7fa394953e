"""Learners of rewards."""
