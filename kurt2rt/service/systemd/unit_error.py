"""Error of a unit that cannot be made, installed or checked, as a code with its text."""

from hal.errors import TextCode, UserError

_SUDO = "say it with sudo"
_OTHER_NAME = "give another --name"


class UnitCode(TextCode):
    """Condition that keeps a unit from being made, installed or checked."""

    BAD_NAME = ("bad name", "cannot name a unit and its user", "give up to 31 of a-z, 0-9 and -, a letter first")
    UNPRINTABLE = ("unprintable", "cannot stand in a unit", "give a path without control characters")
    RELATIVE_PATH = (
        "relative path",
        "{given}: the service would look for it in {state}",
        "give its whole path in the settings",
    )
    MODULE_OF_THIS_FOLDER = (
        "module of this folder",
        "the service would not find {module}: it is in {file}, and is not installed",
        "make a package of it and install it next to kurt2rt (docs/extend.md)",
    )
    NO_ACCESS = ("no access", "{says}", "")
    """A path that the unit's user cannot use; `says` is the text of the access finding."""
    NAME_TAKEN = ("name taken", "is another program's", _OTHER_NAME)
    USER_TAKEN = ("user taken", "is a user of this machine already", _OTHER_NAME)
    NOT_OURS = ("not ours", "is another program's and stays", "give the --name that you installed with")
    NO_UNIT = ("no unit", "there is no such unit", "kurt2rt service install makes one")
    NOT_WRITTEN = ("not written", "cannot be written ({error})", _SUDO)
    NOT_REMOVED = ("not removed", "cannot be removed ({error})", _SUDO)
    NOT_READ = ("not read", "cannot be read ({error})", _SUDO)
    NO_COMMAND = ("no command", "{command} is not on this machine", "the unit needs systemd")
    COMMAND_FAILED = ("command failed", "{says}", "")
    NO_TOOL = ("no tool", "{tool} is not on this machine", "on Debian: apt-get install systemd")
    NO_EXPOSURE = ("no exposure", "{tool} security says no exposure: {says!r}", "look at it yourself")
    TOOL_HANGS = ("tool hangs", "{tool} {command} does not end", "look at the machine's load")


class UnitError(UserError):
    """A unit cannot be made, installed or checked."""

    def __init__(self, code: UnitCode, *, where: object = "", **fields: object) -> None:
        """Fill the code's text with `fields`; `where` names the file, user or setting."""
        super().__init__(code.text.format_map(fields), where=where, do=code.do.format_map(fields))
        self.code = code
