"""Real-time priority for the loop."""

import os


def take_real_time_priority(priority: int) -> str:
    """Run this process under SCHED_FIFO; says what came of it, since a robot also runs without, only less punctual."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except PermissionError:
        return (
            f"no real-time priority {priority}: not permitted; the loop runs without it. "
            "Give the service CAP_SYS_NICE, or set real_time_priority: 0"
        )
    return f"real-time priority {priority} (SCHED_FIFO)"
