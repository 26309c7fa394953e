"""Outcomes of runs by hand."""

from kurt2rt.experiments.certify.outcome import RunOutcome


def outcome(number: int, **more: object) -> RunOutcome:
    """Return a run of 60 s in world A without any event, but for `more`."""
    fields: dict[str, object] = {
        "number": number,
        "world": "a",
        "ticks": 6000,
        "unknown_ticks": 0,
        "questions": 0,
        "first_question": 0,
        "collisions": 0,
        "first_collision": 0,
        "stuck": False,
        "travelled_m": 12.0,
        "end": (0.0, 0.0, 0.0),
    }
    return RunOutcome.model_validate({**fields, **more})
