"""The mid level's situation: which junctions the robot has passed, and what it did there (paper, V.B and VI.B.2)."""
