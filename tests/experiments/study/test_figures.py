"""Pictures that several studies share."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from kurt2rt.experiments.study.figures import draw_passed
from kurt2rt.experiments.study.intervals import wilson_interval
from tests.experiments.rows import FAILED, NOT_JUDGED, row


def test_shares_stand_at_their_values_with_their_intervals(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    worlds = {"world A": [row()] * 9 + [row(verdict=FAILED)], "world B": [row(verdict=NOT_JUDGED)]}
    assert draw_passed(worlds, "", Path("never.png")).path == Path("never.png")
    (axes,) = drawn[0].axes
    bar, dot = (np.asarray(line.get_xydata()).tolist() for line in axes.lines[:2])
    assert dot == [[0.9, 0.0]]
    assert bar == [[end, 0.0] for end in wilson_interval(9, 10)]
    assert [each.get_text() for each in axes.get_yticklabels()] == ["world A", "world B"]
    assert [each.get_text() for each in axes.texts] == ["9 of 10", "0 of 0"]
