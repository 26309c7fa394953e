"""Faults injected between the robot's parts and the notebook, in simulated time."""
