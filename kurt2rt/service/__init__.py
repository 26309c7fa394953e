"""The program on the robot: start, serve, reload, shut down."""
