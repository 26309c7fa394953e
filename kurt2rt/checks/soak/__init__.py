"""A day of a robot in simulated time: everything fails at some time, and nothing is lost, grows or drives on."""
