import pytest

from config.errors import UserError
from kurt2rt.library.extras import extra_named


def test_missing_package_of_an_extra_names_the_extra() -> None:
    with pytest.raises(UserError, match=r"mcap is not installed.*install the extra 'recording'"), extra_named():
        raise ModuleNotFoundError("No module named 'mcap'", name="mcap")


def test_missing_module_of_no_extra_stays_as_it_is() -> None:
    with pytest.raises(ModuleNotFoundError), extra_named():
        raise ModuleNotFoundError("No module named 'mistyped'", name="mistyped")
