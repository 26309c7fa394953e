"""Error of a command that found no robot."""

from kurt2rt.teacher.client.answer import NoAnswer, NoAnswerError


def no_robot(host: str, port: int, name: str) -> NoAnswerError:
    """Return the error for a robot expected at `host` and `port`; `name` is the device that asked."""
    return NoAnswerError(
        f"at {host}:{port} as {name}", NoAnswer.NO_ROBOT, do="start one in another terminal: kurt2rt run"
    )
