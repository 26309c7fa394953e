"""Maps of ROS's map_server as worlds: a YAML file with an image, whose walls are traced."""
