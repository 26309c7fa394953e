"""Detector of mistakes that a person can see."""

from collections.abc import Mapping

from kurt2rt.core.teacher_settings import NoticeSettings
from kurt2rt.teacher.scripted.basic_teacher import TeacherView


class MistakeWatcher:
    """Detector of mistakes that a person can see: of other actions that look different, or that last."""

    def __init__(self, settings: NoticeSettings, groups: Mapping[str, str], period_s: float) -> None:
        """Watch with these `groups` of actions that look alike; an action without a group is one of its own."""
        self._different_ticks = round(settings.different_after_s / period_s)
        self._similar_ticks = round(settings.similar_after_s / period_s)
        self._groups = groups
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
            self._looked_wrong += elapsed
        return self._looked_wrong >= max(self._different_ticks, 1) or self._wrong >= max(self._similar_ticks, 1)

    def reset(self) -> None:
        """Forget the present disagreement."""
        self.began = None
        self._wrong = self._looked_wrong = 0
