"""Detector of mistakes that a person can see."""

from collections.abc import Mapping

from kurt2rt.core.teacher_settings import NoticeSettings
from kurt2rt.teacher.scripted.basic_teacher import TeacherView

_SEEN_AGAIN_S = 0.1
"""Time after which a wrong action that looks different is seen by a person who goes back over the last seconds."""
_REMEMBERED_S = 5.0
"""Time for which what looked wrong is connected with a touch."""


class MistakeWatcher:
    """Detector of mistakes that a person can see: of other actions that look different, or that last."""

    def __init__(self, settings: NoticeSettings, groups: Mapping[str, str], period_s: float) -> None:
        """Watch with these `groups` of actions that look alike; an action without a group is one of its own."""
        self._different_ticks = round(settings.different_after_s / period_s)
        self._similar_ticks = round(settings.similar_after_s / period_s)
        self._seen_again_ticks = round(_SEEN_AGAIN_S / period_s)
        self._remembered_ticks = round(_REMEMBERED_S / period_s)
        self._groups = groups
        self._looked_wrong_from: TeacherView | None = None
        self._remembered: TeacherView | None = None
        """Begin of the last mistake that a look back shows."""
        self.began: TeacherView | None = None
        """State in which the present disagreement began; None without disagreement."""
        self._last_tick = 0
        self._wrong = self._looked_wrong = 0

    def update(self, view: TeacherView, right: str) -> bool:
        """Process a state of a driving robot with its right action; return whether a mistake is noticed now."""
        if view.action is None or view.action == right:
            self.reset()
            return False
        if self.began is None:
            self.began, self._last_tick = view, view.tick
        elapsed, self._last_tick = view.tick - self._last_tick, view.tick
        self._wrong += elapsed
        if self._groups.get(view.action, view.action) != self._groups.get(right, right):
            if self._looked_wrong_from is None:
                self._looked_wrong_from = view
            self._looked_wrong += elapsed
            if self._looked_wrong >= self._seen_again_ticks:
                self._remembered = self._looked_wrong_from
        return self._looked_wrong >= max(self._different_ticks, 1) or self._wrong >= max(self._similar_ticks, 1)

    def reset(self) -> None:
        """Forget the present mistake, because it was corrected or the robot was moved."""
        self.began = self._looked_wrong_from = None
        self._wrong = self._looked_wrong = 0

    def before_touch(self, tick: int) -> TeacherView | None:
        """Return the state in which the last action began that looked wrong before a touch in `tick`.

        Returns None if none did in the last 5 s.
        """
        newest = self._remembered
        return newest if newest is not None and tick - newest.tick <= self._remembered_ticks else None

    def forget(self) -> None:
        """Forget the last mistake, because it is corrected."""
        self._remembered = None
