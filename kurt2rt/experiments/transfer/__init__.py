"""Study of transfer: presses until a robot that was taught at home is right in a new world."""
