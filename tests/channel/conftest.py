"""Fixtures that tests of the channel share."""

from collections.abc import Iterator

import pytest

from kurt2rt.channel.security.pairing import Pairing
from tests.channel.channel_fixture import ChannelFixture
from tests.channel.sides import Sides


@pytest.fixture
def sides(pairing: Pairing) -> Iterator[Sides]:
    """Return a device and its robot."""
    both = Sides(pairing)
    yield both
    both.close()


@pytest.fixture
def desk() -> ChannelFixture:
    """Return a robot that needs a teacher, and its request handler."""
    return ChannelFixture()
