"""Simulated robot: body, wheels, sensors, bumpers."""
