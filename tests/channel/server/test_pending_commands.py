"""The same command sent again gets the same reply, for as long as anybody may send it."""

from kurt2rt.channel.server.off_tick_requests import PendingCommands
from kurt2rt.channel.server.reply import done


async def test_pending_command_is_never_dropped() -> None:
    outcomes = PendingCommands(3)
    for number in range(6):
        outcomes.begin(f"{number}")
    assert all(outcomes.get(f"{number}") is not None for number in range(6))


async def test_pending_slow_command_does_not_block_eviction() -> None:
    outcomes = PendingCommands(3)
    outcomes.begin("waits")
    for number in range(100):
        outcomes.begin(f"{number}")
        outcomes.settle(f"{number}", done(number))
    assert len(outcomes) == 3
    assert outcomes.get("waits") is not None


async def test_pending_settled_commands_are_evicted() -> None:
    outcomes = PendingCommands(3)
    for number in range(50):
        outcomes.begin(f"{number}")
    for number in range(50):
        outcomes.settle(f"{number}", done(number))
    outcomes.begin("next")
    assert len(outcomes) == 3
