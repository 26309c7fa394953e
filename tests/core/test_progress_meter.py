"""Progress over the last minute, from the records of ticks."""

from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.standing import Standing
from kurt2rt.core.progress import Progress
from kurt2rt.core.progress_meter import ProgressMeter
from kurt2rt.core.tick_record import TickRecord
from tests.channel.channel_fixture import ChannelFixture

DESK = ChannelFixture()
RECORD: TickRecord = DESK.run()
DRIVES = RECORD._replace(decision=RECORD.decision._replace(action="forward", rla_id=1), standing=Standing())
ASKS = RECORD._replace(standing=Standing(StandReason.ASKS, asks=True))


class Run:
    """Ticks of 10 ms, one after the other."""

    def __init__(self) -> None:
        self.meter = ProgressMeter(0.01)
        self.tick = 0

    def lasts(self, seconds: float, record: TickRecord) -> Progress:
        for tick in range(self.tick, self.tick + round(seconds * 100)):
            self.meter.update(record._replace(tick=tick, question_begins=record.standing.asks and tick == self.tick))
        self.tick += round(seconds * 100)
        return self.meter.progress()


def test_progress_share_is_that_of_ticks_driven_by_an_rla() -> None:
    run = Run()
    run.lasts(5, ASKS)
    assert run.lasts(15, DRIVES) == Progress(20, 75, 1)
