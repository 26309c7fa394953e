"""Which kind of robot is at the other end, as its first controller says in INFO_1 and its second in INFO_2."""

SIMULATED_HARDWARE_ID = 0x5349
"""Hardware id of simulated controllers, "SI" in ASCII: what the real ones say is not known, this they hardly do."""


def hardware(hardware_id: int) -> str:
    """A hardware id as a person reads it."""
    return f"hardware {hardware_id}" + (" (the simulated robot)" if hardware_id == SIMULATED_HARDWARE_ID else "")
