"""Error of a status that cannot be read, as a code with its text."""

from config.errors import CodedError, TextCode


class StatusCode(TextCode):
    """Condition that keeps the status of a robot program from being read."""

    NO_PROGRAM = (
        "no program",
        "no robot program runs with {knowledge}, or it waits for its disk",
        "start kurt2rt run, or give its knowledge file",
    )
    NOT_READ = ("not read", "cannot be read ({error})", "be the user of the robot program")
    WAITS = ("waits", "the robot program stands and waits for {missing}", "")
    """`missing` is the text of what the start waits for."""
    SILENT = (
        "silent",
        "the robot program has said nothing for {silent_s:g} s",
        "it hangs or was stopped: end it and start it again",
    )
    ENDED = ("ended", "the robot program has ended", "")
    BROKEN_OFF = ("broken off", "the robot program ended ({error})", "")
    NOT_UNDERSTOOD = ("not understood", "is not understood ({error})", "use the kurt2rt that the robot runs")


class StatusError(CodedError):
    """Status of a robot program that cannot be read; `where` is the path of its socket."""
