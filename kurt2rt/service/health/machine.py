"""What the machine tells of itself and of this program."""

import threading
import time
from pathlib import Path

import psutil

from kurt2rt.channel.protocol.health import MachineHealth

_POWER = Path("/sys/class/power_supply")


class MachineMonitor:
    """Looks at memory, processor and battery; each look takes some hundred microseconds."""

    def __init__(self, power: Path = _POWER) -> None:
        """`power`: where the kernel tells of batteries."""
        self._power = power
        self._process = psutil.Process()
        self._looked_at_s = time.monotonic()
        self._used_s = time.process_time()

    def poll(self) -> MachineHealth:
        """As it is now."""
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
    """Charge of the machine's battery, 0 to 1, and whether it is being used up; of several the emptiest counts."""
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
