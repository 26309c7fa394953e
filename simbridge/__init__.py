"""The other end of the bus: worlds, the simulated body and sensors, and the micro-controller that speaks CAN."""
