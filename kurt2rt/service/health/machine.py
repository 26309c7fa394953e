"""Memory, processor and battery of the machine."""

import threading
import time
from pathlib import Path

import psutil

from kurt2rt.channel.protocol.health import MachineHealth

_POWER = Path("/sys/class/power_supply")


class MachineMonitor:
    """Monitor of memory, processor and battery."""

    def __init__(self, power: Path = _POWER) -> None:
        """`power`: folder in which the kernel lists batteries."""
        self._power = power
        self._process = psutil.Process()
        self._looked_at_s = time.monotonic()
        self._used_s = time.process_time()

    def poll(self) -> MachineHealth:
        """Return the present values; takes some 100 µs."""
        now_s, used_s = time.monotonic(), time.process_time()
        share = (used_s - self._used_s) / max(now_s - self._looked_at_s, 1e-3)
        self._looked_at_s, self._used_s = now_s, used_s
        battery, discharging = battery_of(self._power)
        return MachineHealth(
            memory_bytes=self._process.memory_info().rss,
            available_bytes=psutil.virtual_memory().available,
            processor_share=share,
            threads=threading.active_count(),
            battery=battery,
            discharging=discharging,
        )


def battery_of(power: Path) -> tuple[float | None, bool]:
    """Return the charge of the emptiest battery, 0 to 1, and whether it is discharging; None and False without one.

    `power`: folder of the kernel's power supplies.
    """
    found = []
    for supply in sorted(power.glob("*")):
        # Mice and keyboards have batteries as well, with the scope Device.
        if _text(supply / "type") != "Battery" or _text(supply / "scope") == "Device":
            continue
        percent = _text(supply / "capacity")
        if percent.isdecimal():
            found.append((int(percent) / 100, _text(supply / "status") == "Discharging"))
    return min(found) if found else (None, False)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii").strip()
    except OSError:
        return ""
