"""Reference policies: the answers of a consistent teacher to the robot's sensor readings."""
