"""Fixtures of pytest for tests of robot code: simulated KURT2s that are stepped faster than real time.

PYTEST_DONT_REWRITE: asserts of this package are not those of a test.
"""

import fcntl
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

# pytest loads this module in every project, so the package is imported by the fixtures alone.
if TYPE_CHECKING:
    from kurt2rt.library.knowledge import Knowledge
    from kurt2rt.library.simulated_robot import SimulatedRobot

pytest.register_assert_rewrite("kurt2rt.checks.plugins")  # the tests that plug-ins inherit tell what they compared
_MARK = "kurt2"
_VCAN = "kurt2_vcan"
_ROBOT = ("task", "world", "seed", "robot")
_LESSON = ("lesson_seed", "lesson_seconds")

Lessons = Callable[..., "Knowledge"]
"""Function of `task`, `seed`, `seconds` and `robot` that returns the knowledge of a scripted teacher's lesson."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the name of the vcan interface as an option and as a key of the ini file."""
    group = parser.getgroup("kurt2rt", "simulated KURT2 (kurt2rt)")
    group.addoption("--kurt2-vcan", dest=_VCAN, metavar="NAME", help="vcan interface of the fixture kurt2_on_vcan")
    parser.addini(_VCAN, "vcan interface of the fixture kurt2_on_vcan", default="vcan0")


def pytest_configure(config: pytest.Config) -> None:
    """Register the mark of the fixtures in pytest."""
    config.addinivalue_line(
        "markers",
        f"{_MARK}({', '.join(f'{name}=...' for name in (*_ROBOT, *_LESSON))}): task, world and seed of the robot that "
        "kurt2, kurt2_on_vcan and taught_robot give, and seed and seconds of the lesson behind taught_robot",
    )


@pytest.fixture
def kurt2(request: pytest.FixtureRequest) -> "Iterator[SimulatedRobot]":
    """Return a simulated KURT2 that knows nothing yet; its time passes only in `step` and `run`.

    Choose task, world and seed by a mark: @pytest.mark.kurt2(world="a", seed=3).
    """
    with _opened(request) as robot:
        yield robot


@pytest.fixture
def kurt2_on_vcan(request: pytest.FixtureRequest) -> "Iterator[SimulatedRobot]":
    """Return a simulated KURT2 whose CAN frames pass over the kernel's vcan0; without that interface skip the test.

    --kurt2-vcan or kurt2_vcan in the ini file name another one. One test at a time has it, also with pytest-xdist.
    """
    name = request.config.getoption(_VCAN) or request.config.getini(_VCAN)
    with _locked(name), _opened(request, bus=name) as robot:
        yield robot


@pytest.fixture
def taught_robot(request: pytest.FixtureRequest, kurt2_lessons: Lessons) -> "Iterator[SimulatedRobot]":
    """Return a simulated KURT2 that a scripted teacher taught; the lesson is given once in a session.

    A mark chooses as for kurt2, and a shorter lesson: @pytest.mark.kurt2(world="b", lesson_seconds=20).
    """
    marked = _marked(request)
    wanted: dict[str, Any] = {name: marked[name] for name in ("task", "robot") if name in marked}
    wanted |= {name.removeprefix("lesson_"): marked[name] for name in _LESSON if name in marked}
    with _opened(request, knowledge=kurt2_lessons(**wanted)) as robot:
        yield robot


@pytest.fixture(scope="session")
def kurt2_lessons(tmp_path_factory: pytest.TempPathFactory) -> Lessons:
    """Return kurt2rt.teach without a path, which gives each lesson once in a session: kurt2_lessons(task="circle")."""
    taught: dict[tuple[tuple[str, Any], ...], Knowledge] = {}
    folder = tmp_path_factory.mktemp("kurt2")

    def lesson(**wanted: Any) -> "Knowledge":
        from kurt2rt.library.knowledge import teach

        key = tuple(sorted(wanted.items()))
        if key not in taught:
            with _errors_of_one_line():
                taught[key] = teach(folder / f"{len(taught)}.knowledge", **wanted)
        return taught[key]

    return lesson


@contextmanager
def _opened(request: pytest.FixtureRequest, **more: Any) -> "Iterator[SimulatedRobot]":
    from kurt2rt.library.simulated_robot import SimulatedRobot

    marked = _marked(request)
    with _errors_of_one_line():
        robot = SimulatedRobot(**{name: marked[name] for name in _ROBOT if name in marked}, **more)
    with robot:
        yield robot


@contextmanager
def _errors_of_one_line() -> Iterator[None]:
    """Fail the test with the line of a kurt2rt.Error; skip it if the kernel has no vcan interface."""
    from config.errors import UserError
    from kurt2rt.library.named_bus import NoVcanError

    try:
        yield
    except NoVcanError as error:
        raise pytest.skip.Exception(str(error)) from None
    except UserError as error:
        raise pytest.fail.Exception(str(error), pytrace=False) from None


def _marked(request: pytest.FixtureRequest) -> dict[str, Any]:
    """Return the arguments of the test's marks; the mark nearest to the test wins."""
    allowed, found = (*_ROBOT, *_LESSON), dict[str, Any]()
    for mark in request.node.iter_markers(_MARK):
        if mark.args or not mark.kwargs.keys() <= set(allowed):
            wrong = ", ".join([*map(repr, mark.args), *sorted(mark.kwargs.keys() - set(allowed))])
            pytest.fail(f"mark {_MARK}: unknown (got {wrong}, allowed {'=, '.join(allowed)}=)", pytrace=False)
        found = {**mark.kwargs, **found}
    return found


@contextmanager
def _locked(bus: str) -> Iterator[None]:
    """Wait until no other process of this user has the bus in a test."""
    path = Path(tempfile.gettempdir(), f"kurt2rt-{os.getuid()}-{bus.replace('/', '_')}.lock")
    with path.open("a", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
