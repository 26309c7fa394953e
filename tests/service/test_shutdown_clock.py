"""Time that a program has to end: real time, without that in which a busy machine gave it no processor."""

import pytest

from kurt2rt.service.shutdown import ShutdownClock


@pytest.mark.parametrize(
    ("real_s", "delayed_s", "left_s"),
    [
        (0.25, 0.0, 0.75),  # an idle machine
        (1.0, 0.0, 0.0),
        (3.9, 3.6, 0.7 * 4.0 / 0.4),  # a tenth of a processor: it had 0.3 s, and has 0.7 s
        (30.0, 300.0, 0.0),  # ten threads that waited together
        (0.25, -5.0, 0.75),  # threads that waited have ended
    ],
)
def test_left_s_counts_time_without_a_processor_as_none(real_s: float, delayed_s: float, left_s: float) -> None:
    now, delayed = [100.0], [0.0]
    clock = ShutdownClock(lambda: now[0], lambda: delayed[0], lambda: 5.0)
    assert clock.left_s(1.0, 5.0) == 5.0
    clock.start()
    now[0], delayed[0] = now[0] + real_s, delayed[0] + delayed_s
    assert clock.left_s(1.0) == pytest.approx(left_s)
    assert clock.left_s(1.0, 0.0) == 0.0


def test_left_s_at_the_signal_is_as_slow_as_the_program_was() -> None:
    clock = ShutdownClock(lambda: 100.0, lambda: 6.0, lambda: 2.0)
    clock.start()
    assert clock.left_s(1.0) == pytest.approx(4.0)
