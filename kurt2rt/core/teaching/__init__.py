"""A teacher's commands, applied to what the robot knows."""
