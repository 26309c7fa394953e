"""Reference policies that scripted teachers consult: what a consistent person would say, from what the robot senses."""
