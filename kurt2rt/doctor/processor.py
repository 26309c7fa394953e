"""The processor: its cores, how they are clocked, and how many of them numpy takes."""

import os
from collections import Counter
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_info

from kurt2rt.doctor.finding import Finding, Status
from kurt2rt.doctor.sysfs import attribute

CPU_FOLDER = Path("/sys/devices/system/cpu")


def check_cores(usable: int | None = None) -> Finding:
    """Is there a core for the ticks and another for everything else?"""
    if usable is None:
        usable = len(os.sched_getaffinity(0))
    found = f"{usable} usable of {os.cpu_count()}"
    if usable < 2:
        what_to_do = (
            "run the teacher's page and the simulator on another machine, or allow more cores (taskset, cpuset)"
        )
        return Finding("cores", Status.WARNING, f"{found}: ticks share it with all else", what_to_do)
    return Finding("cores", Status.OK, found)


def check_governor(cpu_folder: Path = CPU_FOLDER) -> Finding:
    """Do the cores stay at full clock? One that sleeps between ticks wakes late and slow."""
    files = sorted(cpu_folder.glob("cpu[0-9]*/cpufreq/scaling_governor"))
    governors = Counter(governor for governor in map(attribute, files) if governor)
    if not governors:
        return Finding("CPU governor", Status.OK, "none to be read: a virtual machine, or a clock that is fixed")
    found = ", ".join(f"{name} on {count} cores" for name, count in sorted(governors.items()))
    if set(governors) == {"performance"}:
        return Finding("CPU governor", Status.OK, found)
    what_to_do = f"echo performance | sudo tee {cpu_folder}/cpu*/cpufreq/scaling_governor"
    return Finding("CPU governor", Status.WARNING, found, what_to_do)


def check_blas_threads() -> Finding:
    """Does numpy's linear algebra keep to one thread? A match is too small to be shared out, and helpers spin."""
    libraries = [each for each in threadpool_info() if each["user_api"] == "blas"]
    found = ", ".join(f"{each['internal_api']} {each['num_threads']}" for each in libraries) or "no BLAS that tells"
    found = f"numpy {np.__version__}: {found}"
    if all(each["num_threads"] == 1 for each in libraries):
        return Finding("BLAS threads", Status.OK, found)
    return Finding("BLAS threads", Status.WARNING, found, "export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1")
