"""Rows of the holds league: learners with a teacher in charge, by name."""

HELD = "rla-held"
"""Name of the RLA system that is taught by a teacher in charge."""
_ROOM = "kurt2rt.experiments.rivals.holds"
TITLES = {
    HELD: "RLA, teacher in charge",
    "bc": "BC",
    "dagger": "DAgger",
    "hg-dagger": "HG-DAgger",
    "safe-dagger": "SafeDAgger",
    "lazy-dagger": "LazyDAgger",
    "ensemble-dagger": "EnsembleDAgger",
    "thrifty-dagger": "ThriftyDAgger",
    "eil": "EIL",
    "iwr": "IWR",
}
TARGETS = {
    "bc": f"{_ROOM}.cloning:BehaviouralCloning",
    "dagger": f"{_ROOM}.dagger:Dagger",
    "hg-dagger": f"{_ROOM}.hg_dagger:HgDagger",
    "safe-dagger": f"{_ROOM}.safe_dagger:SafeDagger",
    "lazy-dagger": f"{_ROOM}.safe_dagger:LazyDagger",
    "ensemble-dagger": f"{_ROOM}.ensemble_dagger:EnsembleDagger",
    "thrifty-dagger": f"{_ROOM}.thrifty_dagger:ThriftyDagger",
    "eil": f"{_ROOM}.eil:Eil",
    "iwr": f"{_ROOM}.iwr:Iwr",
}
"""Modules of the learners."""
