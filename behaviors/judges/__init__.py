"""What scripted teachers think of how the robot drives: -1, 0 or +1."""
