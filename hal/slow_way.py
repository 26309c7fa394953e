"""Clock of the way in a slow lesson, as a plain function that runs in the tick and in compiled loops."""


def advance_way(way: float, share: float) -> tuple[float, bool]:
    """Return the way after one slow tick, and whether the tick counts on the clock of the way.

    Args:
        way: fraction of a counted tick that was driven since the last one, 0 to 1.
        share: fraction of the speed at which the robot drives, 0 to 1.
    """
    way += share
    counts = way >= 1.0
    return way - 1.0 if counts else way, counts
