"""Lines that `make size` counts, and rooms that it fails for."""

from tests.size import findings, room, token_lines

SOURCE = '''"""A module."""

# a comment
LINES = """two
lines"""


def double(x: int) -> int:
    """Return twice x.

    Over three lines.
    """
    return (
        2 * x
    )  # a bracket is a token
'''


def test_token_lines_leave_out_comments_docstrings_and_blanks() -> None:
    assert token_lines(SOURCE) == 6


def test_room_is_the_top_folder_or_the_one_within_kurt2rt() -> None:
    paths = ["hal/guard.py", "kurt2rt/core/rla/rla.py", "kurt2rt/runtime.py", "docs/examples/x.py"]
    assert [room(path) for path in paths] == ["hal", "kurt2rt/core", "kurt2rt", "docs"]


def test_findings_name_rooms_above_or_without_a_budget() -> None:
    found = list(findings({"hal": 11, "cli": 5, "new": 1}, {"hal": 10, "cli": 5, "old": 3}))
    assert [line.split(":")[0] for line in found] == ["hal", "new", "old"]
    assert "1 above its budget" in found[0]
