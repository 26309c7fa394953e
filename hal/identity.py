"""Which kind of robot is at the other end, as its first controller says in INFO_1 and its second in INFO_2."""

SIMULATED_HARDWARE_ID = 0x5349
"""Hardware id of simulated controllers, "SI" in ASCII: what the real ones say is not known, this they hardly do."""
