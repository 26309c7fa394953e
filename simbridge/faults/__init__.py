"""What can go wrong between the robot's parts and the notebook, put in on purpose, in simulated time."""
