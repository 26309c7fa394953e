"""The wall clock may be set at any time: only what is said in these modules goes by it."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("config", "hal", "behaviors", "simbridge", "kurt2rt")
READS = re.compile(r"\btime\.time(_ns)?\b|\bdatetime\.(now|today|utcnow)\b|\bdate\.today\b|CLOCK_REALTIME")
READERS = {
    "hal/socketcan_bus.py": "ages against the kernel's stamps, which are of this clock",
    "hal/in_process_bus.py": "stamps of frames between programs, as SocketCAN's",
    "hal/python_can.py": "offset of an adapter's stamps, taken once",
    "kurt2rt/channel/security/pairing.py": "date of a pairing",
    "kurt2rt/channel/security/oscore_context.py": "reserves numbers that no program before had",
    "kurt2rt/cli/commission.py": "date of a step",
    "kurt2rt/knowledge/journal/writer.py": "stamp of a lesson; lessons are in the order of their rows",
    "kurt2rt/library/drive_recorder.py": "name of a run",
    "kurt2rt/ros/inbox.py": "ages of stamped messages of other machines",
    "kurt2rt/ros/session.py": "stamps for other machines",
    "kurt2rt/runs/recording/can_log.py": "offset of a log's stamps, taken once",
    "kurt2rt/runs/recording/recorder.py": "offset of a recording's times, taken once",
    "kurt2rt/runs/recording/recording.py": "name of a run, which is later than those that are there",
    "kurt2rt/runs/recording/run_head.py": "date of a run without a tick",
    "kurt2rt/service/health/monitor.py": "date of the start",
    "kurt2rt/teacher/ros/device.py": "stamps for other machines",
}
"""Uses by module. Whatever times, ages, orders or leases go by is monotonic."""


def test_wall_clock_is_read_for_stamps_alone() -> None:
    files = {str(path.relative_to(ROOT)): path for room in ROOMS for path in (ROOT / room).rglob("*.py")}
    reading = {name for name, path in files.items() if READS.search(path.read_text(encoding="utf-8"))}
    assert reading == READERS.keys()
