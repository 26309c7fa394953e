"""Recording of a run: CAN frames, ticks, lessons and health in files."""
