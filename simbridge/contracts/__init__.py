"""Contracts between a simulation and the programs that drive it, draw it and teach in it; no simulator is imported."""
