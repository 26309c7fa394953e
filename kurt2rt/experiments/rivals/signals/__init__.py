"""Learners of rewards alone, and their lesson."""
