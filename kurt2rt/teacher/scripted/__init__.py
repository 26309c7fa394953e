"""Scripted teachers, for simulated training runs."""
