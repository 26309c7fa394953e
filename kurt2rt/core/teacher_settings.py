"""Schema of `config/teachers/*.yaml`: scripted teachers, quick ones and those with the limits of a person."""

import random
from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from config.settings import Settings, load_settings
from config.settings_files import find_config
from kurt2rt.core.lesson_speed import SLOWEST
from kurt2rt.core.settings_fields import Name, Sentence, Share, or_left_out

SUPERHUMAN = "superhuman"
"""Teacher without a person's limits, whose times are those of the task (`teaching.teacher`)."""

LONGEST_S = 60.0
Seconds = Annotated[float, Field(ge=0, le=LONGEST_S)]


class LogNormalDelay(Settings):
    """Random delay of a scripted teacher, in s: log-normal, cut off at `longest_s`."""

    kind: Literal["log_normal"]
    median_s: Seconds
    spread: Annotated[float, Field(ge=0, le=2)]
    """Standard deviation of the logarithm; 0: always the median."""
    longest_s: Seconds
    """Upper bound of a drawn value."""

    def draw_s(self, chance: random.Random) -> float:
        """Return one delay in s, 0 to `longest_s`."""
        return min(self.median_s * chance.lognormvariate(0.0, self.spread), self.longest_s)


class GammaDelay(Settings):
    """Random delay of a scripted teacher, in s: `shortest_s` and a gamma-distributed rest."""

    kind: Literal["gamma"]
    shortest_s: Seconds
    """Lower bound of a drawn value."""
    shape: Annotated[float, Field(gt=0, le=100)]
    scale_s: Annotated[float, Field(gt=0, le=60)]
    longest_s: Seconds
    """Upper bound of a drawn value."""

    def draw_s(self, chance: random.Random) -> float:
        """Return one delay in s, `shortest_s` to `longest_s`."""
        return min(self.shortest_s + chance.gammavariate(self.shape, self.scale_s), self.longest_s)


Delay = Annotated[LogNormalDelay | GammaDelay, Field(discriminator="kind")]


class LinkSettings(Settings):
    """Rate and age of the states that a scripted teacher sees, and delay of its commands."""

    pictures_per_s: Annotated[float, Field(gt=0, le=100)]
    """Rate of the states that the teacher sees."""
    one_way_s: Annotated[float, Field(ge=0, le=5)]
    """Age of a state when the teacher sees it, and of a command when the robot gets it."""


class NoticeSettings(Settings):
    """Times in s after which a teacher who watches notices that the robot does the wrong thing."""

    different_after_s: Seconds
    """Time after which a wrong action is noticed that looks different from the right one."""
    similar_after_s: Seconds
    """Time after which any wrong action is noticed."""


class LookBackSettings(Settings):
    """Time and precision of a person who stops the robot and looks back for a mistake (rewind)."""

    takes: Delay = LogNormalDelay(kind="log_normal", median_s=3.0, spread=0.42, longest_s=15.0)
    """Time from the standstill to the press that names the right action, after which the robot drives on."""
    moment_spread_s: Annotated[float, Field(ge=0, le=5)] = 0.2
    """Standard deviation of the moment that the person takes for the begin of the mistake."""


class LapseSettings(Settings):
    """Rate and duration of the lapses in which a scripted teacher does not look at the robot."""

    per_minute: Annotated[float, Field(ge=0, le=60)]
    duration: Delay


class ErrorSettings(Settings):
    """Fractions, 0 to 1, of a scripted teacher's commands that name another action than the right one."""

    answers: Share
    corrections: Share
    undone: Share = 0.0
    """Fraction of these that the person notices at once, because the screen says what was taught, and undoes."""


class PersonSettings(Settings):
    """Limits of a scripted teacher that acts like a person; each delay is drawn for each event."""

    question_delay: Delay
    """Time from a question that is seen to the press that answers it."""
    mistake_delay: Delay
    """Time from a mistake that is noticed to the press that corrects it."""
    reward_delay: Delay
    """Time from an event to the press that rewards it."""
    hand_delay_s: Seconds
    """Delay of the hand that follows a changing right action while it holds a button."""
    notices: NoticeSettings
    link: LinkSettings
    presses_per_minute: Annotated[int, Field(ge=0, le=600)]
    """Limit on presses in any 60 s; 0: no limit."""
    look_back: LookBackSettings = LookBackSettings()
    lapses: LapseSettings
    errors: ErrorSettings
    slower_per_minute: Annotated[float, Field(ge=0, le=1)]
    """Growth of all delays with each minute of teaching, as a fraction: tiredness."""


class TeacherProfile(Settings):
    """Scripted teacher of `config/teachers`: its way to answer and correct, and its limits.

    `superhuman` reacts at once and never errs; `ordinary` has the delays and slips of a person. Studies name one, so
    that all robots and learners get the same teacher.
    """

    name: Name
    description: Sentence
    """Teacher in one sentence."""
    corrects_by: Literal["press", "hold", "rewind", "nothing"] = "press"
    """Way to correct: a press that names the action, an action that is held, a stop and a look back (rewind), or
    answers only."""
    corrects_touch_by: Literal["rewind", "nothing"] = "nothing"
    """Way to correct what led to a touch: a look back for the last thing that looked wrong before it, or not at all."""
    ask_radius_fraction: Annotated[float, Field(gt=0, le=1)] | None = None
    """Fraction of R beyond which the robot asks this teacher; None: `learning.ask_radius_fraction` of the task."""
    lesson_speeds: Mapping[str, Annotated[float, Field(ge=SLOWEST, le=1)]] = {}
    """Fraction of their speed at which actions drive in this teacher's lessons, by task; in other tasks the task's own
    (`teaching.lesson_speed`)."""
    answers_by: Literal["press", "hold"] = "press"
    """Way to answer a question."""
    corrects_tick: Literal["began", "noticed", "by_delay", "pressed"] = "pressed"
    """Tick that a press corrects: the first wrong one; the one in which the mistake was noticed; the one before the
    press by the teacher's delay, as the robot has measured it; or the present one."""
    hold_s: Annotated[float, Field(gt=0, le=60)] = 2.0
    """Time for which an action is held."""
    person: Annotated[
        PersonSettings | None, or_left_out("a person's limits, or leave the key out for the times of the task")
    ] = None
    """Limits of a person; None: reaction, patience and errors are those of the task."""


QUICK_TEACHER = TeacherProfile(
    name=SUPERHUMAN,
    description="Reacts and corrects by the times of the task, without a break",
    ask_radius_fraction=1.0,
)
"""Teacher of a task that names none; the same as `config/teachers/superhuman.yaml`."""


def load_teacher(name_or_path: str) -> TeacherProfile:
    """Load the profile of a shipped teacher by name, or of a file by path.

    Raises:
        config.settings.SettingsError: for a missing or invalid file.
    """
    return load_settings(find_config("teachers", name_or_path), TeacherProfile)
