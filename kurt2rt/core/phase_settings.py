"""Schema of the section `phases` of a task: lengths of phases 3 to 5 and their controls, and targets."""

from typing import Annotated

from pydantic import Field

from config.settings import Settings

PHASES = ("phases", "judge", "reinforcement", "critic")
"""Sections of a task that phases 1 and 2 do not use."""

_TAUGHT = ("reinforcement_s", "repair_s", "long_run_s")
_OF_THE_CRITIC = ("critic_s", "autonomy_s", "repair_alone_s")
_EVERY = ("reposition_every_s", "set_down_every_s", "shown_s")

Seconds = Annotated[float, Field(ge=1, le=100_000)]
SecondsOrNever = Annotated[float, Field(ge=0, le=100_000)]
Share = Annotated[float, Field(gt=0, le=1)]


class SignalsSettings(Settings):
    """Timing of a scripted teacher's rewards in phase 3: shortest times between two of a value."""

    bad_every_s: Annotated[float, Field(gt=0, le=1000)] = 1.0
    good_every_s: Annotated[float, Field(gt=0, le=1000)] = 2.0
    patience_s: Annotated[float, Field(ge=0, le=10)] = 0.2
    """Time of uninterrupted bad driving before a reward of -1."""
    most_blame: Annotated[int, Field(ge=0, le=100_000)] = 100
    """Largest number of rewards of -1; 0: no limit."""


class AppraisalsSettings(Settings):
    """Timing of the appraisals by which a scripted teacher teaches the critic in phase 4."""

    bad_every_s: Annotated[float, Field(gt=0, le=1000)] = 1.0
    good_every_s: Annotated[float, Field(gt=0, le=1000)] = 1.0
    neutral_every_s: Annotated[float, Field(gt=0, le=1000)] = 1.0
    gap_s: Annotated[float, Field(ge=0, le=1000)] = 1.0
    """Shortest time between two appraisals."""


class AskedShare(Settings):
    """Target of the phases study in one world: fraction of the robots that have to succeed."""

    world: str
    share: Share


class AskedOfPhases(Settings):
    """Targets of the phases study, written down before its runs; an absent one is not checked."""

    repaired_by_rewards: tuple[AskedShare, ...] = ()
    """Success of the corrupted sets after phase 3."""
    repaired_by_critic: tuple[AskedShare, ...] = ()
    """Success of the corrupted sets after phase 5 without a teacher."""
    collisions_fall_by: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Fraction by which the critic alone reduces collisions of the corrupted sets; 0: not checked."""
    intact_not_worse: bool = False
    """Phase 5 does no harm: no clean robot collides or fails after it, and no measure of driving is worse by the
    margin, for 95 % of the bootstrapped means."""
    not_worse_margin: Annotated[float, Field(ge=0, le=1)] = 0.02
    """Margin as a fraction of the mean before."""
    interventions_below_per_hour: Annotated[float, Field(ge=0, le=1000)] = 0.0
    """Target for the long run after phase 5; 0: not checked."""


class PhasesSettings(Settings):
    """Settings of the study of phases 3 to 5; times in s of robot time."""

    reinforcement_s: Seconds
    """Length of phase 3."""
    reposition_every_s: SecondsOrNever = 15.0
    """Interval at which the robot is set down at a start pose in phase 3 and its controls; 0: never."""
    critic_s: Seconds
    """Length of phase 4."""
    set_down_every_s: SecondsOrNever = 15.0
    """Interval at which the robot is set down in sight of something in phase 4, also close to it; 0: never."""
    shown_s: SecondsOrNever = 2.5
    """Time for which a random action drives it then, so that the critic sees what the RLAs never do."""
    shown_share: Annotated[float, Field(ge=0, le=1)] = 0.5
    """Fraction of the repositionings that are followed by a random action."""
    autonomy_s: Seconds
    """Length of phase 5."""
    long_run_s: Seconds
    """Length of each robot's long run after phase 5; interventions are summed over all robots."""
    corrupted_share: Share = 0.18
    """Fraction of the RLAs whose action is replaced by a wrong one. In phase 4, too, so that the critic is taught bad
    situations; only the critic's knowledge is kept."""
    repair_s: Seconds
    """Length of phase 3, or of one of its controls, with a corrupted set."""
    repair_alone_s: Seconds
    """Length of phase 5 with a corrupted set, and of its control with an intact one."""
    repair_worlds: Annotated[tuple[str, ...], Field(min_length=1)]
    """Worlds of the exams of corrupted sets."""
    signals: SignalsSettings = SignalsSettings()
    appraisals: AppraisalsSettings = AppraisalsSettings()
    asked: AskedOfPhases = AskedOfPhases()

    def shortened(self, most_s: float, worlds: tuple[str, ...], most_alone_s: float, share: float) -> "PhasesSettings":
        """Return these settings with shorter times and fewer worlds.

        Args:
            most_s: longest phase 3, repair and long run, in s.
            worlds: worlds of the exams.
            most_alone_s: longest phases 4 and 5, in s.
            share: factor for all intervals between rewards, appraisals and repositionings, 0 to 1.
        """
        update: dict[str, object] = {name: min(getattr(self, name), most_s) for name in _TAUGHT}
        update |= {name: min(getattr(self, name), most_alone_s) for name in _OF_THE_CRITIC}
        update |= {name: share * getattr(self, name) for name in _EVERY}
        for name in ("signals", "appraisals"):
            times: Settings = getattr(self, name)
            every = {key: share * getattr(times, key) for key in type(times).model_fields if key.endswith("_s")}
            update[name] = times.model_copy(update=every)
        return self.model_copy(update=update | {"repair_worlds": worlds})
