"""TurtleBot3-like base as a plug-in: a 360-degree lidar and two wheels, over topics of ROS 2 by zenoh."""
