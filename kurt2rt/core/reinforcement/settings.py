"""How a task learns from rewards: the section `reinforcement` of `config/tasks/*.yaml`."""

from typing import Annotated, Literal

from pydantic import Field

from hal.settings import Settings

_Seconds = Annotated[float, Field(gt=0, le=1000)]
_Share = Annotated[float, Field(ge=0, le=1)]
_Value = Annotated[float, Field(ge=-1, le=1)]


class ValueSettings(Settings):
    """Where values begin, and from where an RLA has to be mended."""

    first_value: _Value
    """Of an action that was just taught."""
    highest_value: _Value | None = None
    """Praise lifts no value above this, and blame counts from there; None: wherever it leads."""
    sunk_below: _Value
    """An RLA that was blamed and is worth less has sunk: its action is mended."""
    well_above: _Value
    """One that is worth more is well: it may stand in for a competitor that has sunk, and has a vote as a neighbour."""
    blamed_share: _Share
    """Only an RLA with so much of the blame's trace is looked at."""


class TaughtValues(ValueSettings):
    """With a teacher. What was praised a hundred times may be wrong elsewhere in its radius: praise only heals."""

    first_value: _Value = 0.0
    highest_value: _Value | None = 0.0
    sunk_below: _Value = -0.1
    well_above: _Value = -0.1
    blamed_share: _Share = 0.1


class AutonomousValues(ValueSettings):
    """Without one. A critic errs more often than a teacher, and its praise has to weigh against that."""

    first_value: _Value = 0.5
    sunk_below: _Value = -0.2
    well_above: _Value = -0.1
    blamed_share: _Share = 0.02


class ReinforcementSettings(Settings):
    """Defaults were found in simulation; every number may stand in a task's file."""

    rule: Literal["td_lambda", "edge_weights"] = "td_lambda"
    """What a signal changes: the value of each RLA, or the weights between RLAs that follow each other."""
    trace_s: _Seconds = 0.7
    """Time constant of the eligibility trace, unless a signal brings its own."""
    alpha: _Share = 0.3
    """Step size of values."""
    gamma: _Share = 0.9
    """What the value of the next RLA counts, one step later."""
    step_s: _Seconds = 0.1
    """Time between two steps of temporal difference learning."""
    factors: Annotated[tuple[Annotated[float, Field(gt=0, le=1)], ...], Field(min_length=1, max_length=100)] = (
        0.9,
        0.95,
        0.97,
    )
    """Edge weights: by what praise multiplies, and blame divides, those of the last transitions, newest first."""
    with_teacher: TaughtValues = TaughtValues()
    """In phases 1 to 4."""
    alone: AutonomousValues = AutonomousValues()
    """In phase 5."""
    epsilon: _Share = 0.02
    """Share of the choices among competitors that are made by chance instead of by worth."""
    hold_s: Annotated[float, Field(ge=0, le=1000)] = 1.0
    """A choice among competitors stands until they have not been nearest for so long, or are blamed."""
    most_competitors: Annotated[int, Field(ge=0, le=100)] = 3
    """Actions that are tried on one condition where nobody is asked, before its RLAs are deleted; 0: at once."""
    neighbours: Annotated[int, Field(ge=1, le=1000)] = 5
    """Of so many RLAs around it, the action that most have is the next one to try; one that has sunk has no vote."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Of the choices by chance."""
