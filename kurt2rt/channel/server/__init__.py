"""The robot's end of the teacher channel."""
