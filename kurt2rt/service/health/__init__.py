"""Health of the robot program, its bus, its disk and its machine."""
