"""Maps of ROS's map_server as worlds: a YAML file beside an image, walls traced."""
