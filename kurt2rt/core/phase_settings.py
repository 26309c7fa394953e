"""Schema of the section `phases` of a task: how long phases 3 to 5 and their controls last, and what is asked."""

from typing import Annotated

from pydantic import Field

from hal.settings import Settings

PHASES = ("phases", "judge", "reinforcement", "critic")
"""Parts of a task that phases 1 and 2 have nothing to do with."""

_TAUGHT = ("reinforcement_s", "repair_s", "long_run_s")
_OF_THE_CRITIC = ("critic_s", "autonomy_s", "repair_alone_s")
_EVERY = ("reposition_every_s", "set_down_every_s", "shown_s")

Seconds = Annotated[float, Field(ge=1, le=100_000)]
SecondsOrNever = Annotated[float, Field(ge=0, le=100_000)]
Share = Annotated[float, Field(gt=0, le=1)]


class SignalsSettings(Settings):
    """How often the scripted teacher praises and blames."""

    bad_every_s: Annotated[float, Field(gt=0, le=1000)] = 1.0
    good_every_s: Annotated[float, Field(gt=0, le=1000)] = 2.0
    patience_s: Annotated[float, Field(ge=0, le=10)] = 0.2
    """He blames what has been bad for so long without a break."""
    most_blame: Annotated[int, Field(ge=0, le=100_000)] = 100
    """He blames no more often than this; 0: as often as he likes."""


class AppraisalsSettings(Settings):
    """How often he teaches the critic."""

    bad_every_s: Annotated[float, Field(gt=0, le=1000)] = 1.0
    good_every_s: Annotated[float, Field(gt=0, le=1000)] = 1.0
    neutral_every_s: Annotated[float, Field(gt=0, le=1000)] = 1.0
    gap_s: Annotated[float, Field(ge=0, le=1000)] = 1.0
    """The shortest time between two of any kind."""


class AskedShare(Settings):
    """Share of the robots that are to succeed in a world."""

    world: str
    share: Share


class AskedOfPhases(Settings):
    """Numbers to reach; what is left out is not asked for."""

    repaired_by_rewards: tuple[AskedShare, ...] = ()
    """Of the corrupted sets, after phase 3."""
    repaired_by_critic: tuple[AskedShare, ...] = ()
    """Of the corrupted sets, after phase 5 without a teacher."""
    collisions_fall_by: Annotated[float, Field(ge=0, le=1)] = 0.0
    """By the critic alone, of those of the corrupted sets; 0: not asked for."""
    intact_not_worse: bool = False
    """By phase 5: no robot that was clean collides or fails after it, and no measure of driving is worse by the margin,
    as sure as 95 % of the bootstrapped means."""
    not_worse_margin: Annotated[float, Field(ge=0, le=1)] = 0.02
    """As a share of the mean before."""
    interventions_below_per_hour: Annotated[float, Field(ge=0, le=1000)] = 0.0
    """In the long run after phase 5; 0: not asked for."""


class PhasesSettings(Settings):
    """Times in s of robot time."""

    reinforcement_s: Seconds
    """Phase 3."""
    reposition_every_s: SecondsOrNever = 15.0
    """In phase 3, and in its controls, the robot is set down at some start so often; 0: never."""
    critic_s: Seconds
    """Phase 4."""
    set_down_every_s: SecondsOrNever = 15.0
    """In phase 4 the robot is set down in sight of something, also close to it, so often; 0: never."""
    shown_s: SecondsOrNever = 2.5
    """Then some action drives it for so long, that the critic may see what the robot does not do by itself."""
    shown_share: Annotated[float, Field(ge=0, le=1)] = 0.5
    """So often of the times that it is set down."""
    critic_sees_wrong: bool = True
    """Whether it drives with wrong actions in phase 4, as many as in a corrupted set, so that the critic hears what is
    bad; of what was taught then only the critic is kept."""
    autonomy_s: Seconds
    """Phase 5."""
    long_run_s: Seconds
    """After phase 5, each robot; interventions are counted in all of them together."""
    corrupted_share: Share = 0.18
    """Of the RLAs, which get another action."""
    repair_s: Seconds
    """Phase 3, or one of its controls, with a corrupted set."""
    repair_alone_s: Seconds
    """Phase 5 with a corrupted set, and with an intact one beside it."""
    repair_worlds: Annotated[tuple[str, ...], Field(min_length=1)]
    """Worlds of the exams of corrupted sets."""
    signals: SignalsSettings = SignalsSettings()
    appraisals: AppraisalsSettings = AppraisalsSettings()
    asked: AskedOfPhases = AskedOfPhases()

    def shortened(self, most_s: float, worlds: tuple[str, ...], most_alone_s: float, share: float) -> "PhasesSettings":
        """No time longer than these, exams in these worlds only, and everything done every so often done sooner.

        `most_alone_s`: of what the critic learns, or teaches. `share`: of each time between two signals or set-downs.
        """
        update: dict[str, object] = {name: min(getattr(self, name), most_s) for name in _TAUGHT}
        update |= {name: min(getattr(self, name), most_alone_s) for name in _OF_THE_CRITIC}
        update |= {name: share * getattr(self, name) for name in _EVERY}
        for name in ("signals", "appraisals"):
            times: Settings = getattr(self, name)
            every = {key: share * getattr(times, key) for key in type(times).model_fields if key.endswith("_s")}
            update[name] = times.model_copy(update=every)
        return self.model_copy(update=update | {"repair_worlds": worlds})
