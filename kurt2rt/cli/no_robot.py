"""The line for a command that found no robot to talk to."""

from kurt2rt.teacher.client.answer import NoAnswerError


def no_robot(host: str, port: int, name: str) -> NoAnswerError:
    """Return the error: `host` and `port` are where the robot should be, `name` is the device that asked."""
    return NoAnswerError(
        f"no robot answers at {host}:{port} as {name}", do="start one in another terminal: kurt2rt run"
    )
