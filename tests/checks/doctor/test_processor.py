"""Cores, their governor, and how many of them numpy takes."""

from pathlib import Path

from threadpoolctl import threadpool_limits

from kurt2rt.checks.doctor.check_result import CheckStatus, FindingCode
from kurt2rt.checks.doctor.checks import check_blas_threads, check_cores, check_governor


def cpu_folder(folder: Path, *governors: str) -> Path:
    """Return a tree like /sys/devices/system/cpu, with the other folders that stand there."""
    (folder / "cpufreq").mkdir()
    (folder / "cpuidle").mkdir()
    for number, governor in enumerate(governors):
        frequency = folder / f"cpu{number}" / "cpufreq"
        frequency.mkdir(parents=True)
        (frequency / "scaling_governor").write_text(f"{governor}\n")
    return folder


def test_one_core_is_a_warning_and_two_will_do() -> None:
    assert check_cores(1).status is CheckStatus.WARNING
    assert check_cores(2).status is CheckStatus.OK


def test_cores_at_full_clock_are_fine(tmp_path: Path) -> None:
    finding = check_governor(cpu_folder(tmp_path, "performance", "performance"))
    assert finding.status is CheckStatus.OK
    assert finding.code is FindingCode.GOVERNOR


def test_one_core_that_saves_power_is_a_warning(tmp_path: Path) -> None:
    finding = check_governor(cpu_folder(tmp_path, "performance", "powersave", "performance"))
    assert finding.status is CheckStatus.WARNING
    assert finding.code is FindingCode.GOVERNOR_SAVING
    assert finding.values["folder"] == str(tmp_path)


def test_one_blas_thread_is_fine_and_two_are_a_warning() -> None:
    with threadpool_limits(1, user_api="blas"):
        assert check_blas_threads().status is CheckStatus.OK
    with threadpool_limits(2, user_api="blas"):
        finding = check_blas_threads()
    assert finding.status is CheckStatus.WARNING
    assert finding.code is FindingCode.BLAS_MANY
    assert str(finding.values["libraries"]).endswith(" 2")
