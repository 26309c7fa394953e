"""The robot program as a unit of systemd: the unit itself, and what the program tells the service manager."""
