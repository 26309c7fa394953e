"""Real-time priority for the loop."""

import os


def take_real_time_priority(priority: int) -> str:
    """Run this thread under SCHED_FIFO, with 0 as any other; says what came of it.

    A robot also runs without, only less punctual.
    """
    if priority == 0:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        return "no real-time priority"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except PermissionError:
        return (
            f"no real-time priority {priority}: not permitted; the loop runs without it. "
            "Give the service CAP_SYS_NICE, or set real_time_priority: 0"
        )
    return f"real-time priority {priority} (SCHED_FIFO)"
