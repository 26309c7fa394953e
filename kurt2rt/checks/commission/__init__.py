"""Power-on of a real robot: a checklist that a person is walked through, and the robot's settings file at its end."""
