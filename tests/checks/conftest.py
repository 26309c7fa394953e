from tests.cli.conftest import kurt2rt

__all__ = ["kurt2rt"]
