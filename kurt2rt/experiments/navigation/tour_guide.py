"""Scripted guide of a tour: teaches the behaviours that are possible at each place, and names places."""

import random
from collections import deque
from collections.abc import Sequence

from behaviors.metrics.errands import Errands
from behaviors.metrics.town import Street
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import BeAt, Command, NameSituation, Pursue, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.teacher.scripted.press_times import PressTimes

HOME = "home"
_NAME = "scripted teacher"
_NOTICES_WITHIN_S = 3.0
"""Time from leaving a junction to the report of the robot; after it, the junction is missed."""


class TourGuide:
    """Scripted guide along a random route that prefers new ways; its input is the robot's mid level and street.

    The guide teaches each new way as an alternative, and commands a behaviour if the robot would choose another one.
    """

    def __init__(
        self, walk: Errands, names: int, times: PressTimes, *, period_s: float, seed: int, session: str
    ) -> None:
        """`walk`: tracker of the robot. `names`: number of named places. `session`, `times`: as in ScriptedTeacher."""
        self._walk = walk
        self._names = names
        self._session = session
        self._chance = random.Random(f"route of {session}, seed {seed}")
        self._times = times
        self._question_ticks = self._mistake_ticks = 0
        self._notices_within_ticks = round(_NOTICES_WITHIN_S / period_s)
        self._led: set[tuple[Street, str]] = set()
        self._to_say: deque[Command] = deque()
        self._wanted: str | None = None
        """Behaviour for the next junction; None until the robot is at a place."""
        self._waited = 0
        self._noticed = False
        self._here: Street | None = None
        self._unnoticed_ticks = 0
        self._said = 0
        self.named: dict[str, Street] = {}
        """Named places, each with its street."""
        self.missed = 0
        """Number of junctions that the robot did not notice."""

    @property
    def ways(self) -> int:
        """Number of ways from a street to the next that were taught."""
        return len(self._led)

    def begin(self) -> None:
        """Name the first place, home, and start the tour."""
        street = self._walk.street
        assert street is not None
        self.named[HOME] = street
        self._to_say.append(NameSituation(self._next_id(), _NAME, HOME))
        self._set_out()

    def set_down_at_home(self) -> None:
        """Restart the tour at home, after the robot was put there."""
        self._to_say.clear()
        self._to_say.append(BeAt(self._next_id(), _NAME, HOME))
        self._set_out()

    def watch(self, record: TickRecord) -> Command | None:
        """Return the guide's command in response to one tick; None without one. Call it on every tick."""
        mid, street = record.decision.mid, self._walk.street
        assert mid is not None
        if self._to_say:
            return self._to_say.popleft()
        if street is None and self._here is not None:
            self._here, self._noticed = None, False
        if mid.event is not None:
            self._noticed = True
        if street is None:
            return None
        if street != self._here:
            self._here, self._wanted, self._waited, self._unnoticed_ticks = street, None, 0, 0
        if not self._noticed:
            return self._command(street, driving=record.decision.driving)
        self._noticed_here(street)
        if self._wanted is None:
            return None
        if self._waited == 0:
            self._question_ticks, self._mistake_ticks = self._times.question_ticks(), self._times.mistake_ticks()
        self._waited += 1
        if mid.asks:
            if self._waited < self._question_ticks:
                return None
            self._waited = 0
            self._led.add((street, self._wanted))
            return Teach(self._next_id(), _NAME, self._wanted, level=MID)
        if self._waited < self._mistake_ticks:
            return None
        wanted = self._wanted
        if (street, wanted) not in self._led:
            self._led.add((street, wanted))
            return Teach(self._next_id(), _NAME, wanted, level=MID, alternative=True)
        if mid.behaviour == wanted:
            return None
        return Pursue(self._next_id(), _NAME, wanted)

    def _noticed_here(self, street: Street) -> None:
        if self._wanted is not None:
            return
        self._wanted = self._choose(street)
        if len(self.named) <= self._names and street not in self.named.values():
            name = f"place {len(self.named)}"
            self.named[name] = street
            self._to_say.append(NameSituation(self._next_id(), _NAME, name))

    def _choose(self, street: Street) -> str:
        town = self._walk.town
        possible = town.on_from(street)
        fresh = [each for each in possible if (street, each) not in self._led]
        if fresh:
            return self._chance.choice(fresh)
        unfinished = [each for each in town.streets if any((each, on) not in self._led for on in town.on_from(each))]
        way = town.nearest(street, self._shuffled(unfinished))
        if way is None or len(way) < 2:
            return self._chance.choice(list(possible))
        return next(behaviour for behaviour, on in possible.items() if on == way[1])

    def _shuffled(self, streets: Sequence[Street]) -> list[Street]:
        return self._chance.sample(streets, len(streets))

    def _command(self, street: Street, *, driving: bool) -> Command | None:
        """Return a command if the robot did not notice a junction for too long."""
        self._unnoticed_ticks += driving
        if self._unnoticed_ticks != self._notices_within_ticks:
            return None
        self.missed += 1
        return Pursue(self._next_id(), _NAME, self._choose(street))

    def _set_out(self) -> None:
        self._here, self._wanted, self._waited = self._walk.street, None, 0
        self._noticed = True

    def _next_id(self) -> str:
        self._said += 1
        return f"{self._session}-guide-{self._said}"
