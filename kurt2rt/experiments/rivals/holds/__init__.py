"""Learners of the literature that learn from a teacher in charge of the robot."""
