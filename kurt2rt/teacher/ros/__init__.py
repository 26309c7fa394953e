"""Teacher's device that joins the robot to ROS 2: topics, and services to teach and drive (docs/other-robots.md)."""
