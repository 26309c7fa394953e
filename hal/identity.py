"""Hardware ids, which the controllers send in INFO_1 and INFO_2."""

SIMULATED_HARDWARE_ID = 0x5349
"""Hardware id of simulated controllers, "SI" in ASCII. The ids of real controllers are not published."""


def hardware(hardware_id: int) -> str:
    """Return the hardware id of an INFO frame as text, which names the simulated robot."""
    return f"hardware {hardware_id}" + (" (the simulated robot)" if hardware_id == SIMULATED_HARDWARE_ID else "")
