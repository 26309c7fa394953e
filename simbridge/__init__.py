"""Rides on the other end of the bus: world, body, sensors and micro-controller of the simulated KURT2."""
