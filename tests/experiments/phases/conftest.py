import pytest

from tests.experiments.phases.tiny import Tiny, do_tiny


@pytest.fixture(scope="session")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Tiny:
    """Return the smallest run with all kinds of results; read only."""
    return do_tiny(tmp_path_factory.mktemp("phases"))
