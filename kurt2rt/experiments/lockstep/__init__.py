"""Lessons and exams in simulated time, one world step a tick."""
