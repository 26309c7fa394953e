"""Settings of reinforcement: the section `reinforcement` of `config/tasks/*.yaml`."""

from typing import Annotated

from pydantic import Field

from config.settings import Settings
from kurt2rt.core.settings_fields import Share

_Seconds = Annotated[float, Field(gt=0, le=1000)]
_Value = Annotated[float, Field(ge=-1, le=1)]


class ValueSettings(Settings):
    """Settings of the values that rewards change: first, highest, and thresholds of repair."""

    first_value: _Value
    """Value of a newly taught action."""
    highest_value: _Value | None = None
    """Upper limit of values, from which punishments count; None: no limit."""
    sunk_below: _Value
    """Value below which a punished RLA is repaired."""
    well_above: _Value
    """Value above which an RLA is healthy: it can replace a competitor, and votes as a neighbour."""
    blamed_share: Share
    """Least share of a punishment's trace for a repair."""


class TaughtValues(ValueSettings):
    """Values with a teacher: a reward only restores, because an RLA can be wrong elsewhere in its radius."""

    first_value: _Value = 0.0
    highest_value: _Value | None = 0.0
    sunk_below: _Value = -0.1
    well_above: _Value = -0.1
    blamed_share: Share = 0.1


class AutonomousValues(ValueSettings):
    """Values without a teacher: a critic errs more often, so its rewards of +1 raise values without a limit."""

    first_value: _Value = 0.5
    sunk_below: _Value = -0.2
    well_above: _Value = -0.1
    blamed_share: Share = 0.02


class ReinforcementSettings(Settings):
    """Settings of learning from rewards in phases 3 to 5; the defaults were found in simulation."""

    trace_s: _Seconds = 0.7
    """Time constant of the eligibility trace of a teacher's reward."""
    alpha: Share = 0.3
    """Step size of values."""
    gamma: Share = 0.9
    """Discount of the next RLA's value per step."""
    step_s: _Seconds = 0.1
    """Time between two steps of temporal difference learning."""
    with_teacher: TaughtValues = TaughtValues()
    """Values of phases 1 to 4."""
    alone: AutonomousValues = AutonomousValues()
    """Values of phase 5."""
    epsilon: Share = 0.02
    """Share of the choices among competitors that are random."""
    hold_s: Annotated[float, Field(ge=0, le=1000)] = 1.0
    """Time without being nearest after which a choice among competitors ends; a punishment ends it at once."""
    most_competitors: Annotated[int, Field(ge=0, le=100)] = 3
    """Number of actions tried on one condition in phase 5 before its RLAs are deleted; 0: at once."""
    neighbours: Annotated[int, Field(ge=1, le=1000)] = 5
    """Number of neighbours that vote on the next action to try; only healthy ones vote."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Seed of random choices."""
