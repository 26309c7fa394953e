"""Error of a unit that cannot be made or installed, as a code with its text."""

from config.errors import CodedError, TextCode

_SUDO = "say it with sudo"
_UNREADABLE = "the service's user cannot read it, because {closed} is closed to others"
_HIDDEN = "the service does not see what is in {closed}"
_COPY = "say: sudo install -D -m 644 {path_word} {copy_word}, and name that one"
_OTHER_NAME = "give another --name"


class UnitCode(TextCode):
    """Condition that keeps a unit from being made or installed, with its text and remedy."""

    BAD_NAME = ("bad name", "cannot name a unit and its user", "give up to 31 of a-z, 0-9 and -, a letter first")
    UNPRINTABLE = ("unprintable", "cannot stand in a unit", "give a path without control characters")
    RELATIVE_PATH = (
        "relative path",
        "{given}: the service would look for it in {state}",
        "give its whole path in the settings",
    )
    INSTALLATION_UNREADABLE = (
        "installation unreadable",
        _UNREADABLE,
        "install kurt2rt in a folder for all, such as /opt/kurt2rt",
    )
    FILE_UNREADABLE = ("file unreadable", _UNREADABLE, _COPY)
    FILE_HIDDEN = ("file hidden", _HIDDEN, _COPY)
    """The unit does not see the folder that holds the file."""
    FOLDER_HIDDEN = ("folder hidden", _HIDDEN, "name a folder elsewhere")
    FOLDER_UNREACHABLE = (
        "folder unreachable",
        "the service's user cannot get there, because {closed} is closed to others",
        "name a folder elsewhere, or say: sudo chmod o+x {closed_word}",
    )
    FOLDER_OF_ANOTHER = ("folder of another", "belongs to {owner}", "say: sudo chown {user}: {path_word}")
    """Another user owns the folder, so the unit's user may not write it."""
    NAME_TAKEN = ("name taken", "is another program's", _OTHER_NAME)
    USER_TAKEN = ("user taken", "is a user of this machine already", _OTHER_NAME)
    NOT_OURS = ("not ours", "is another program's and stays", "give the --name that you installed with")
    NO_UNIT = ("no unit", "there is no such unit", "kurt2rt service install makes one")
    NOT_WRITTEN = ("not written", "cannot be written ({error})", _SUDO)
    NOT_REMOVED = ("not removed", "cannot be removed ({error})", _SUDO)
    NOT_READ = ("not read", "cannot be read ({error})", _SUDO)
    NO_COMMAND = ("no command", "{command} is not on this machine", "the unit needs systemd")
    COMMAND_FAILED = ("command failed", "{says}", "")


class UnitError(CodedError):
    """Unit that cannot be made or installed; `where` names the file, user or setting."""
