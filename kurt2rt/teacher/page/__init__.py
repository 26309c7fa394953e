"""The page's server, on the robot's machine or on any other that reaches the robot."""
