"""CAN wire in simulated time: bits, arbitration, lost and destroyed frames, error counters, bus-off."""
