import pytest

from tests.experiments.phases.tiny import Tiny, do_tiny


@pytest.fixture(scope="session")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Tiny:
    """The smallest run that has everything; to be looked at."""
    return do_tiny(tmp_path_factory.mktemp("phases"))
