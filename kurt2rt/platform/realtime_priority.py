"""Real-time priority of the loop, and a higher one of the threads that must preempt a loop that hangs."""

import os
import threading
from collections.abc import Iterable
from typing import Final

UNIT_PRIORITY: Final = 20
"""Real-time priority of a unit's loop; with 4 busy programs 36.8 % of ticks were missed without it, 0.5 % with it."""


def set_sched_fifo(priority: int, guards: Iterable[threading.Thread] = ()) -> str:
    """Run this thread under SCHED_FIFO; return the result in a line for the log.

    Other threads, and programs started later, keep the normal scheduling. Without permission the loop runs as before,
    and nothing is raised.

    Args:
        priority: 1 to 99; 0: normal scheduling.
        guards: threads that get one more than `priority`.
    """
    threads = [(each.native_id, priority and priority + 1) for each in guards if each.native_id is not None]
    try:
        for native_id, its in (*threads, (0, priority)):
            _schedule(native_id, its)
    except PermissionError:
        return (
            f"no real-time priority {priority}: not permitted; the loop runs without it. "
            "Give the service CAP_SYS_NICE (kurt2rt doctor says how), or set real_time_priority: 0"
        )
    return f"real-time priority {priority} (SCHED_FIFO)" if priority else "no real-time priority"


def _schedule(native_id: int, priority: int) -> None:
    # Without the flag every thread that the loop starts would inherit its priority, and keep it afterwards.
    policy = (os.SCHED_FIFO if priority else os.SCHED_OTHER) | os.SCHED_RESET_ON_FORK
    try:
        os.sched_setscheduler(native_id, policy, os.sched_param(priority))
    except ProcessLookupError:  # the thread has ended; the heartbeat reports that
        return
