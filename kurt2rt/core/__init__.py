"""One tick of the robot, from sensor readings to wheel speeds: deterministic, without I/O."""
