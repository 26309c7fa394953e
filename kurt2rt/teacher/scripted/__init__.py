"""Scripted teachers, for simulated lessons."""
