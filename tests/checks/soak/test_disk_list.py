"""Notes of a soak on disk come back unchanged."""

from kurt2rt.checks.faults.complaint import ComplaintCode, complaint
from kurt2rt.checks.soak.disk_list import Spool
from kurt2rt.checks.soak.result import SoakStart

LOST = complaint(ComplaintCode.LESSONS_NOT_STORED, taught=3, stored=2, names="")


def test_notes_come_back_in_order_also_between_two_more() -> None:
    spool: Spool[SoakStart] = Spool()
    assert list(spool) == []
    first, second = SoakStart(0.0, 12.5, "none", ""), SoakStart(13.0, 2.25, "lossy", "ValueError()", LOST)

    spool.append(first)
    assert list(spool) == [first]
    spool.append(second)

    assert list(spool) == [first, second]
    assert len(spool) == 2
    spool.close()
    assert list(spool) == []
