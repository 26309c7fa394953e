"""List of all checks in the order of the report."""

from pathlib import Path

from kurt2rt.checks.doctor.can_bus import check_can_interfaces, check_can_kernel, check_vcan
from kurt2rt.checks.doctor.check_result import CheckResult
from kurt2rt.checks.doctor.disk import check_disk
from kurt2rt.checks.doctor.privileges import check_memory_lock, check_real_time_priority
from kurt2rt.checks.doctor.processor import check_blas_threads, check_cores, check_governor
from kurt2rt.checks.doctor.python import check_package, check_python
from kurt2rt.checks.doctor.sqlite_log import check_sqlite
from kurt2rt.checks.doctor.timer import check_clock, check_timer


def run_checks(folder: Path, ticks: int = 100) -> tuple[CheckResult, ...]:
    """Run all checks; `folder` is that of the knowledge. Changes nothing. Takes 20 ms per tick."""
    return (
        check_python(),
        check_timer(ticks),
        check_clock(),
        check_real_time_priority(),
        check_memory_lock(),
        check_cores(),
        check_governor(),
        check_blas_threads(),
        check_sqlite(),
        *check_disk(folder),
        check_can_kernel(),
        *check_can_interfaces(),
        check_vcan(),
        check_package("foxglove", "recordings of runs", "recording"),
        check_package("pymunk", "the simulator's physics"),
        check_package("shapely", "the simulator's worlds"),
        check_package("matplotlib", "drawing to files, without a display"),
    )
