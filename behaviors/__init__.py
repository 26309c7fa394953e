"""What the robot can do by itself: the repertoire of actions, and the policies that scripted teachers consult."""
