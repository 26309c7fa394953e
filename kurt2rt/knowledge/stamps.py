"""When each lesson was written: kept of every lesson for as long as the program runs, and seldom looked at."""

from collections.abc import Iterable, Iterator, MutableMapping
from datetime import UTC, datetime, timedelta

_EPOCH = datetime.fromtimestamp(0, UTC)
_MS = timedelta(milliseconds=1)


class Stamps(MutableMapping[str, str]):
    """Wall clock in ISO 8601 by command id, as a text to everybody who looks; a number takes a third of the room."""

    def __init__(self, stamps: Iterable[tuple[str, str]] = ()) -> None:
        """`stamps`: command ids, each with its stamp."""
        self._kept: dict[str, float | str] = {}
        """Milliseconds since 1970; what is not written as `utc_now` does stays as it is."""
        self.update(stamps)

    def __getitem__(self, command_id: str) -> str:
        kept = self._kept[command_id]
        return kept if isinstance(kept, str) else _text(kept)

    def __setitem__(self, command_id: str, stamped_at: str) -> None:
        self._kept[command_id] = _packed(stamped_at)

    def __delitem__(self, command_id: str) -> None:
        del self._kept[command_id]

    def __iter__(self) -> Iterator[str]:
        return iter(self._kept)

    def __len__(self) -> int:
        return len(self._kept)


def _packed(stamped_at: str) -> float | str:
    try:
        packed = (datetime.fromisoformat(stamped_at) - _EPOCH) / _MS
        return packed if _text(packed) == stamped_at else stamped_at
    except (ValueError, TypeError, OverflowError):  # no date, or none with a zone
        return stamped_at


def _text(milliseconds: float) -> str:
    return (_EPOCH + timedelta(milliseconds=milliseconds)).isoformat(timespec="milliseconds")
