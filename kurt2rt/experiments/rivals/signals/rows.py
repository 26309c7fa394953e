"""Rows of the signals league: learners of rewards, by name."""

REWARDED = "rla-rewarded"
"""Name of the RLA system that is taught by answers and rewards (phase 3)."""
_ROOM = "kurt2rt.experiments.rivals.signals"
TITLES = {
    REWARDED: "RLA, answers and rewards (phase 3)",
    "tamer": "TAMER",
    "deep-tamer": "Deep TAMER",
    "coach": "COACH",
}
TARGETS = {
    "tamer": f"{_ROOM}.tamer:Tamer",
    "deep-tamer": f"{_ROOM}.deep_tamer:DeepTamer",
    "coach": f"{_ROOM}.coach:Coach",
}
"""Modules of the learners."""
