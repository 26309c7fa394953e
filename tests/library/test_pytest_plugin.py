"""The plug-in of pytest, as a project outside of this repository meets it: in a pytest process of its own."""

import re
from pathlib import Path

import pytest

pytest_plugins = ["pytester"]

PAGE = Path(__file__).parents[2] / "docs" / "python.md"

GIVEN = """
import can, pytest
import kurt2rt
from conftest import LOADED

seen = []

def test_import_of_the_plugin_loads_no_robot():
    assert not {"hal", "numpy", "kurt2rt.library.simulated_robot"} & LOADED

@pytest.mark.kurt2(world="b", seed=3)
class TestMarked:
    def test_class(self, kurt2):
        kurt2.teach("forward")
        seen.append((kurt2, kurt2.pose))
        assert "world b" in repr(kurt2)

    @pytest.mark.kurt2(seed=4)
    def test_nearest_mark_wins(self, kurt2):
        kurt2.teach("forward")
        assert "world b" in repr(kurt2)
        assert kurt2.pose != seen[0][1]

def test_robot_of_an_earlier_test_is_closed():
    with pytest.raises(kurt2rt.Error, match="is closed"):
        seen[0][0].step()

@pytest.mark.kurt2(lesson_seconds=3)
@pytest.mark.parametrize("_", [1, 2])
def test_two_robots_have_one_lesson(_, taught_robot, kurt2_lessons):
    lesson = kurt2_lessons(seconds=3)
    assert taught_robot.rlas == lesson.rlas != ()
    taught_robot.teach("stand")
    seen.append((taught_robot, lesson))
    assert _ == 1 or seen[-2][1] is lesson and seen[-2][0] is not taught_robot

def test_frames_pass_over_the_bus_of_the_ini_file(kurt2_on_vcan):
    with can.Bus("mine", interface="virtual") as bus:
        kurt2_on_vcan.step()
        assert bus.recv(0.0)
"""
WRONG = """
import pytest

@pytest.mark.kurt2(worlds="b")
def test_unknown_argument(kurt2): pass

@pytest.mark.kurt2(world="moon")
def test_unknown_world(kurt2): pass

@pytest.mark.kurt2(task="juggling")
def test_unknown_task(taught_robot): pass

@pytest.fixture
def no_vcan(request, monkeypatch):
    monkeypatch.setattr(request.config.option, "kurt2_vcan", "vcan_not_there")

def test_without_vcan(no_vcan, kurt2_on_vcan): pass
"""


def test_plugin_in_another_project(pytester: pytest.Pytester) -> None:
    (example,) = re.findall(r"^```python\n(# test_my_robot\.py\n.*?)^```$", PAGE.read_text(), re.MULTILINE | re.DOTALL)
    example = example.replace('can.Bus("vcan0", interface="socketcan")', 'can.Bus("mine", interface="virtual")')
    pytester.makeini("[pytest]\nkurt2_vcan = virtual:mine\n")
    pytester.makeconftest("import sys; LOADED = set(sys.modules)")
    pytester.makepyfile(test_given=GIVEN, test_my_robot=example, test_wrong=WRONG)
    other = ("-p", "no:asyncio", "-p", "no:cacheprovider")  # another plug-in's warnings are not ours
    result = pytester.runpytest_subprocess(*other, "-W", "error", "--strict-markers", "-rs")
    result.assert_outcomes(passed=10, errors=3, skipped=1)
    result.stdout.fnmatch_lines(
        [
            "mark kurt2: unknown (got worlds, allowed task=, world=, seed=, robot=, lesson_seed=, lesson_seconds=)",
            "moon: no such name in worlds; *",
            "juggling: no such name in tasks; *",
            "SKIPPED *bus 'vcan_not_there': the kernel has no such interface; sudo modprobe vcan && *",
        ]
    )
    result.stdout.no_fnmatch_line("Traceback*")
