"""Simulated micro-controller: frames on the bus, motor commands, watchdog."""
