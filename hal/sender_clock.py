"""Age of messages by the clock of their sender, which may be set, begin again, or lie once."""

import math

BELIEVED_AFTER_S = 0.5
"""Time for which all stamps have to agree about a clock that was set before it is believed."""
AGREEMENT_S = 1.0
"""Largest apparent age of the first message at which the clocks are taken to agree."""
_AGREED_DRIFT = 5e-5
"""Drift that forgets an agreement: that of quartzes which nothing keeps together."""
_TOLD_FOR_S = 10.0
_LATE_S = 0.5
_REFUSED_FOR_S = 1.0


class SenderClock:
    """Clock of a sender, by its stamps and their arrivals on a clock of this machine that is never set.

    A message is as old as its delay against the quickest one, or as its stamp says if both clocks agreed at the first.
    A queue keeps the order of what it holds back, and is never quicker than the quickest. So a stamp that goes back,
    or is ahead of what the quickest allows, is of a clock that was set, or a lie. It counts once all stamps have
    agreed with it for BELIEVED_AFTER_S. The same stamps and arrivals give the same ages.
    """

    def __init__(self, drift: float, slack_s: float, agreed_offset_s: float = math.inf) -> None:
        """Start without a message.

        Args:
            drift: largest drift of the two clocks, as a ratio.
            slack_s: jump of the stamps that may be jitter; after such a jump messages count as older by up to this.
            agreed_offset_s: this machine's clock minus the sender's if both agree; infinite: they never do.
        """
        self._drift, self._slack_s, self._agreed_offset_s = drift, slack_s, agreed_offset_s
        self._course: _Course | None = None
        self._rival: _Course | None = None
        self.jumps = 0
        """Number of times that no stamp of before tells the time since then, as after a clock was set."""
        self._sudden_s = math.inf
        """Stamp of the newest message if it came sooner than the one before by more than the slack."""
        self._age_s, self._aged_at_s = 0.0, -math.inf
        self._jump_s, self._jumped_at_s = 0.0, -math.inf
        self._refused_from_s, self._refused_at_s = math.inf, -math.inf

    def age_s(self, stamp_s: float, arrival_s: float, at_most_s: float = math.inf) -> float | None:
        """Return a message's age at its arrival, in s; None if its stamp does not go on from those before.

        Args:
            stamp_s: its stamp on the sender's clock.
            arrival_s: its arrival on this machine's clock.
            at_most_s: bound of the age that is known otherwise, such as by a command that it answers.
        """
        age_s = self._judge(stamp_s, arrival_s, at_most_s)
        if age_s is None:
            self._refused_from_s, self._refused_at_s = min(self._refused_from_s, arrival_s), arrival_s
        else:
            self._age_s, self._aged_at_s, self._refused_from_s = age_s, arrival_s, math.inf
        return age_s

    def notice(self, now_s: float) -> str:
        """Return what is wrong with the stamps, for the user; empty if nothing is. `now_s`: present of the arrivals."""
        if now_s - self._jumped_at_s < _TOLD_FOR_S:
            return f"its clock was set by {self._jump_s:+.1f} s"
        if self._refused_at_s - self._refused_from_s > _REFUSED_FOR_S:
            return "its time stamps repeat, or go to and fro"
        late = self._age_s > _LATE_S and now_s - self._aged_at_s < _REFUSED_FOR_S
        return f"comes {self._age_s:.1f} s late; look at the network" if late else ""

    def _judge(self, stamp_s: float, arrival_s: float, at_most_s: float) -> float | None:
        course, rival, offset_s = self._course, self._rival, arrival_s - stamp_s
        if course is None or arrival_s < course.arrival_s:  # this machine's clock begins again in a simulation alone
            self._course, self._rival = _Course(self._drift, self._slack_s, offset_s, arrival_s), None
            if course is None and 0.0 <= offset_s - self._agreed_offset_s <= AGREEMENT_S:
                self._course.agreed_s = self._agreed_offset_s
            return self._course.add(stamp_s, arrival_s)
        if stamp_s > course.stamp_s and offset_s < course.least_s and arrival_s - course.began_s < BELIEVED_AFTER_S:
            self.jumps += offset_s < course.least_s - self._slack_s
            return course.add(stamp_s, arrival_s)  # the first ones waited, such as in a buffer
        delay_s = course.delay_s(stamp_s, arrival_s)
        if delay_s is not None and delay_s > at_most_s + self._slack_s:
            proven = _Course(self._drift, self._slack_s, offset_s - at_most_s, arrival_s)
            return self._believe(proven, stamp_s, arrival_s)
        # A clock that was set back by little is soon ahead of the stamps before, like messages of a queue.
        fits_better = delay_s is None or delay_s > self._slack_s
        if rival is not None and fits_better and rival.delay_s(stamp_s, arrival_s) is not None:
            if arrival_s - rival.began_s >= BELIEVED_AFTER_S:
                return self._believe(rival, stamp_s, arrival_s)
            rival.add(stamp_s, arrival_s)
            return None
        if delay_s is None:
            if abs(offset_s - course.offset_s) > self._slack_s:
                self._rival = _Course(self._drift, self._slack_s, offset_s, arrival_s)
                self._rival.add(stamp_s, arrival_s)
            return None
        self._rival = None
        if offset_s < course.offset_s - self._slack_s and stamp_s <= self._sudden_s:
            self._sudden_s = stamp_s  # the next message tells whether a queue emptied or this one lies
            return max(delay_s, offset_s - course.agreed_s)
        self._sudden_s = math.inf
        return course.add(stamp_s, arrival_s)

    def _believe(self, course: "_Course", stamp_s: float, arrival_s: float) -> float:
        assert self._course is not None
        self._jump_s, self._jumped_at_s = self._course.least_s - course.least_s, arrival_s
        self._course, self._rival = course, None
        self.jumps += 1
        return course.add(stamp_s, arrival_s)


class _Course:
    """Stamps that go on as time does, and the offset of the quickest: arrival minus stamp."""

    __slots__ = ("_drift", "_slack_s", "agreed_s", "arrival_s", "began_s", "least_s", "offset_s", "stamp_s")

    def __init__(self, drift: float, slack_s: float, least_s: float, arrival_s: float) -> None:
        self._drift, self._slack_s = drift, slack_s
        self.least_s = self.offset_s = least_s
        self.began_s = self.arrival_s = arrival_s
        self.agreed_s, self.stamp_s = math.inf, -math.inf

    def delay_s(self, stamp_s: float, arrival_s: float) -> float | None:
        """Return a message's delay in s; None if its stamp does not go on."""
        offset_s, least_s = arrival_s - stamp_s, self._least_at(arrival_s)
        goes_on = stamp_s > self.stamp_s and offset_s >= min(least_s, self.agreed_s) - self._slack_s
        return max(0.0, offset_s - least_s) if goes_on else None

    def add(self, stamp_s: float, arrival_s: float) -> float:
        """Add a message whose stamp goes on, and return its delay in s."""
        self.offset_s = arrival_s - stamp_s
        self.least_s = min(self._least_at(arrival_s), self.offset_s)
        self.agreed_s += _AGREED_DRIFT * (arrival_s - self.arrival_s)
        self.stamp_s, self.arrival_s = stamp_s, arrival_s
        return max(0.0, self.offset_s - min(self.least_s, self.agreed_s))

    def _least_at(self, arrival_s: float) -> float:
        return self.least_s + self._drift * (arrival_s - self.arrival_s)
