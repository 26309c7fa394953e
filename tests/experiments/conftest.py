import pytest

from tests.experiments.helpers import Taught, teach


@pytest.fixture(scope="session")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Taught:
    """One lesson in world A; to be looked at, not to be taught on."""
    return teach(tmp_path_factory.mktemp("lesson") / "first.knowledge")
