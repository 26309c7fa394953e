"""How often each device may ask for what costs the loop something."""


class PerDeviceRateLimit:
    """So many at once, and one more every few ticks; each device has its own."""

    def __init__(self, most: int, every_ticks: int) -> None:
        self._most = most
        self._every_ticks = every_ticks
        self._full_at: dict[str, int] = {}
        """The tick at which a device has all of it again."""

    def take(self, device: str, tick: int) -> bool:
        """One of a device's; False where it has none left."""
        full_at = max(self._full_at.get(device, tick), tick) + self._every_ticks
        if full_at > tick + self._most * self._every_ticks:
            return False
        self._full_at[device] = full_at
        return True
