import pickle

import pytest

from config.errors import UserError
from config.settings import SettingsError
from hal.bus import BusError


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (UserError("full"), "full"),
        (UserError("full", where="a.knowledge"), "a.knowledge: full"),
        (UserError("full", do="make room"), "full; make room"),
        (UserError("full", where="a.knowledge", do="make room"), "a.knowledge: full; make room"),
    ],
)
def test_user_error_of_parts_is_one_line(error: UserError, line: str) -> None:
    assert str(error) == line


@pytest.mark.parametrize("kind", [UserError, BusError, SettingsError])
def test_user_error_pickled_keeps_its_parts(kind: type[UserError]) -> None:
    error = pickle.loads(pickle.dumps(kind("full", where="a.knowledge", do="make room")))
    assert type(error) is kind
    assert (error.where, error.what, error.do) == ("a.knowledge", "full", "make room")


def test_errors_of_bus_and_settings_are_builtin_errors_too() -> None:
    assert issubclass(BusError, OSError)
    assert issubclass(SettingsError, ValueError)
