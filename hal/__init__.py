"""Robot protocol, the KURT2 on its CAN bus, and the guard between every decision and the wheels."""
