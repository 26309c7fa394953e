"""Conditions that keep knowledge from being read or written, as codes, and the text of each."""

from config.errors import TextCode

_SQLITE = " (SQLite: {error})"
_BACKUP = "keep the file, and go on with a backup copy"
_KNOWLEDGE_FILE = "give the path of a knowledge file; kurt2rt knowledge list finds them"
_PACKAGE = "give a file of kurt2rt knowledge export"
_NEW_COPY = "get another copy of it"
_EXPORT_AGAIN = "export it again"
_ROOMY_FOLDER = "give a path in a folder that may be written and has room"
_HEALTH = "look at the disk's health"
_LOCAL = "give a path on a local disk"
_ITS_KURT2RT = "read it with the kurt2rt that wrote it"
_NEW_FILE = "give the path of a new file"


class KnowledgeCode(TextCode):
    """Condition that keeps a knowledge file or package from being read or written, with text and remedy."""

    # SQLite
    LOCKS_STUCK = ("locks stuck", "its locks are stuck", f"{_HEALTH}, and restart the robot program" + _SQLITE)
    DISK_FULL = ("disk full", "the disk is full", "make room on it" + _SQLITE)
    DISK_FAILS = ("disk fails", "the disk fails", "look at its health and room, and keep a copy of the file" + _SQLITE)
    DATABASE_LOCKED = ("database locked", "another program holds it locked", "close that program" + _SQLITE)
    READ_ONLY = ("read only", "it may not be written", "give write permission for the file and its folder" + _SQLITE)
    NOT_OPENED = ("not opened", "it cannot be opened", "look at permissions and room of its folder" + _SQLITE)
    PAGES_DAMAGED = ("pages damaged", "the file is damaged", _BACKUP + _SQLITE)
    SQLITE_REFUSES = ("sqlite refuses", "SQLite refuses it", _BACKUP + _SQLITE)
    # The knowledge file
    FOLDER_NOT_LOCKABLE = (
        "folder not lockable",
        "cannot be locked ({error})",
        "give a path in a folder that exists and may be written",
    )
    DISK_WITHOUT_LOCKS = ("disk without locks", "cannot be locked ({error})", _LOCAL)
    ANOTHER_WRITER = (
        "another writer",
        "another kurt2rt is writing it ({error})",
        "stop that one, or give another knowledge file",
    )
    LOCK_NOT_RELEASED = ("lock not released", "its lock cannot be released ({error})", "it ends with this program")
    STATUS_UNREADABLE = ("status unreadable", "its status cannot be read ({error})", _HEALTH)
    FILE_GONE = (
        "file gone",
        "is gone, but its log {log} is there and may hold lessons",
        "put the file back, or move the log away",
    )
    FOREIGN_LOG = ("foreign log", "a log {log} of another file is next to it", "give another path")
    NOT_CREATED = ("not created", "cannot be created ({error})", _ROOMY_FOLDER)
    NOT_A_FILE = ("not a file", "is a folder or device, not a file", _KNOWLEDGE_FILE)
    HARD_LINKS = (
        "hard links",
        "has {names} names (hard links), allowed is 1: lessons that a robot writes under one name are lost under "
        "the other",
        "make a copy (cp), then remove the other names",
    )
    UNREADABLE = ("unreadable", "cannot be read ({error})", _KNOWLEDGE_FILE)
    NO_SQLITE_FILE = ("no sqlite file", "is not a knowledge file (no SQLite file)", _KNOWLEDGE_FILE)
    OTHER_PROGRAM = ("other program", "is an SQLite file of another program", _KNOWLEDGE_FILE)
    OTHER_FORMAT = ("other format", "has format {version}, this kurt2rt knows format {allowed}", _ITS_KURT2RT)
    FOREIGN_SCHEMA = (
        "foreign schema",
        "holds a {kind} {name!r} that kurt2rt did not make",
        "it may be damaged or meant to harm: go on with a backup copy",
    )
    LOG_NOT_SYNCED = ("log not synced", "its log cannot be synced ({error})", _HEALTH)
    NO_WRITE_AHEAD_LOG = (
        "no write-ahead log",
        "its disk cannot hold an SQLite log (mode {mode})",
        "give a path on a local disk",
    )
    MOVED_IN_USE = (
        "moved in use",
        "it or its log was moved, deleted or replaced while in use",
        "put the files back, or start with another file",
    )
    FOLDER_NOT_MADE = ("folder not made", "cannot be made ({error})", "give a file in another folder")
    # Its content
    BINDING_DAMAGED = ("binding damaged", "table binding is damaged ({error})", _BACKUP)
    INTEGRITY = ("integrity", "its pages are damaged ({line})", _BACKUP)
    """One line of SQLite's integrity check."""
    ROW_MISPLACED = ("row misplaced", "stands where row {expected} should", "keep the file")
    ROW_CHANGED = ("row changed", "was changed after it was written (checksum)", _BACKUP)
    NOT_AN_EVENT = ("not an event", "not a teaching event: {error}", _BACKUP)
    LESSON_MISFIT = ("lesson misfit", "does not fit the lessons before it: {error}", _BACKUP)
    EVENT_NOT_WRITABLE = ("event not writable", "cannot be written: {error}", "teach it again")
    ROW_NOT_GIVEN = ("row not given", "SQLite gave no row for command {command_id!r}", "teach it again")
    OTHER_FEATURES = (
        "other features",
        "taught with other features: {difference}",
        "use the situation definition and robot it was taught with, or give another knowledge file",
    )
    OTHER_LEVEL_FEATURES = (
        "other level features",
        "its level {level} was taught with other features: {difference}",
        "use the {level} settings it was taught with, or give another knowledge file",
    )
    OTHER_TASK = (
        "other task",
        "taught for the task {taught!r}, not for {wanted!r}",
        "start that task, or give another knowledge file",
    )
    OTHER_TASK_GIVEN = (
        "other task given",
        "was taught for the task {taught!r}, not for {wanted!r}",
        "leave out --task, or give another knowledge file",
    )
    TASK_NOT_FOUND = (
        "task not found",
        "was taught for the task {taught!r}, which is neither shipped nor installed ({error})",
        "give its settings yourself: --task PATH.yaml (in Python: task=PATH)",
    )
    # The writer, and copies
    WRITER_CLOSED = ("writer closed", "its writer is closed", "open the journal again to teach")
    LESSONS_NOT_WRITTEN = ("lessons not written", "{reason}", "closed with {count} lessons not written")
    NOT_DURABLE = ("not durable", "{reason}", "")
    NOT_YET_DURABLE = ("not yet durable", "the newest lessons are not saved yet", "try again later")
    NOT_SIMULATED = ("not simulated", "this robot is not simulated here", "examine its knowledge with kurt2rt exam")
    UNKNOWN_COPY = ("unknown copy", "not a copy of this run of the program", "save or export again")
    COPY_UNREADABLE = ("copy unreadable", "cannot be read ({error})", "save or export again")
    FOLDER_NOT_WRITABLE = (
        "folder not writable",
        "nothing can be saved there ({error})",
        "give a folder that may be written and has room",
    )
    NOT_SAVED = ("not saved", "cannot be saved ({error})", _ROOMY_FOLDER)
    ALREADY_THERE = ("already there", "is there already", _NEW_FILE)
    # New files from others
    NOT_BUILT = ("not built", "no knowledge file can be made of it: {reason}", "")
    NO_TEMPORARY_FILES = ("no temporary files", "cannot be unpacked ({error})", "make room where temporary files go")
    DUPLICATE_COMMAND = (
        "duplicate command",
        "has the command id {command_id!r} of row {row}",
        "keep the file, and get another copy",
    )
    # Packages
    PACKAGE_NOT_A_FILE = ("package not a file", "is a folder or device", _PACKAGE)
    PACKAGE_TOO_LARGE = ("package too large", "is larger than {allowed_mb} MB, too large for knowledge", _PACKAGE)
    PACKAGE_UNREADABLE = ("package unreadable", "cannot be read ({error})", _PACKAGE)
    PACKAGE_DAMAGED = (
        "package damaged",
        "is damaged, or not a file of kurt2rt knowledge export ({error})",
        _NEW_COPY,
    )
    PACKAGE_PART_MISSING = ("package part missing", "has no {name}", _NEW_COPY)
    PACKAGE_PART_CHANGED = ("package part changed", "{name} was changed after it was exported (SHA-256)", _NEW_COPY)
    PACKAGE_DUPLICATE_NAME = ("package duplicate name", "holds {name} twice", "pack each package for itself")
    PACKAGE_UNSAFE = (
        "package unsafe",
        "{reason}",
        "nothing of it was read: get another copy from a source that you trust",
    )
    PACKAGE_COMPRESSION = (
        "package compression",
        "is packed in a way that kurt2rt knowledge export does not use",
        _NEW_COPY,
    )
    PACKAGE_NOT_OURS = ("package not ours", "its {name} was not made by kurt2rt", _PACKAGE)
    PACKAGE_OTHER_FORMAT = (
        "package other format",
        "has format {version}, this kurt2rt knows format {allowed}",
        _ITS_KURT2RT,
    )
    PACKAGE_INVALID = ("package invalid", "cannot be understood ({error})", _EXPORT_AGAIN)
    PACKAGE_OTHER_FEATURES = (
        "package other features",
        "was taught with other features: {difference}",
        "import it with the task and robot settings that it was taught with (--task, --robot-settings)",
    )
    NOT_EXPORTABLE = ("not exportable", "cannot be exported: it {reason}", "name its settings otherwise")
    MANIFEST_DAMAGED = ("manifest damaged", "its {name} is damaged ({error})", _NEW_COPY)
    # Versions
    NO_LESSON = ("no lesson", "holds no lesson that {state}", "")
    NO_LESSON_BY = ("no lesson by", "holds no lesson by {teacher} that is not undone", "{others}")
    NO_UNDONE_LESSON_BY = (
        "no undone lesson by",
        "holds no undone lesson by {teacher} that can be redone{reason}",
        "",
    )
    LESSON_REFUSED = ("lesson refused", "{reason}", "kurt2rt knowledge lessons shows the ids of lessons")
    """Field `outcome`: the kurt2rt.core.outcome.RefusalCode of it."""
    # Views
    NO_SUCH_RLA = ("no such rla", "holds no RLA {rla_id}", "kurt2rt knowledge show lists them")
    NO_RLA_AT_LEVEL = ("no rla at level", "holds no RLA of the level {level!r}", "it has RLAs of: {found}")
    NO_RLA_OF_BEHAVIOUR = ("no rla of behaviour", "holds no RLA of the behaviour {behaviour!r}", "it has: {found}")
    NO_SUCH_FOLDER = (
        "no such folder",
        "is not there",
        "give the folder that your knowledge files are in, or one of them",
    )
    TAUGHT_BY_PEOPLE = (
        "taught by people",
        "{people} taught in it, and a scripted teacher would change it",
        "{instead}",
    )
    # Recorded runs that knowledge is tried on, exams, uploads
    NO_RECORDED_RUN = ("no recorded run", "holds no recorded run", "kurt2rt run makes them, --runs gives their folder")
    NO_RUN_FITS = ("no run fits", "none of its runs can be tried: {reason}", "")
    EXAM_RUNS = ("exam runs", "an exam is under way", "wait for its end")
    EXAM_NOT_STARTED = ("exam not started", "the exam cannot be started ({error})", "install kurt2rt whole")
    UPLOAD_REFUSED = ("upload refused", "{reason}", "")
