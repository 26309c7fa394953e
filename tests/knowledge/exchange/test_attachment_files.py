"""Files of a foreign package stay in the folder of their extraction."""

import pytest

from kurt2rt.knowledge.exchange.attachment_files import LARGEST_BYTES, MOST_FILES, unsafe_reason


@pytest.mark.parametrize(
    "name",
    [
        *("", "..", "settings/../../x", "settings/..", "settings/./x", "settings//x", "settings/", "/etc/x"),
        *("C:/x", "c:x", "settings\\..\\x", "settings/nul", "settings/COM1.yaml", "settings/a\nb", "settings/a\0b"),
        *("settings/\ud800", "settings/" + "x" * 256, "x/" * 600 + "x"),
    ],
)
def test_unsafe_reason_escaping_names_are_refused(name: str) -> None:
    assert repr(name)[:20] in unsafe_reason({"settings/task.json": 1, name: 1})


def test_unsafe_reason_limits_are_kept() -> None:
    assert str(MOST_FILES) in unsafe_reason({f"settings/{number}": 1 for number in range(MOST_FILES + 1)})
    assert "256 MB" in unsafe_reason({"a": LARGEST_BYTES, "b": 1})
    assert "'a'" in unsafe_reason({"a": 1, "a/b": 1})
    assert unsafe_reason({"settings/situations/Ann's own é.yaml": LARGEST_BYTES}) == ""
