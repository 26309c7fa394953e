"""ROS 2 messages and topics over zenoh, without ROS (extra `ros`; docs/other-robots.md)."""
