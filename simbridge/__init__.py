"""Simulated robot at the other end of the CAN bus: worlds, body, sensors and micro-controller."""
