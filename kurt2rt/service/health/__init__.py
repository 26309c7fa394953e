"""How well the robot's program, its bus, its disk and its machine are."""
