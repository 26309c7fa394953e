"""Conditions that keep knowledge from being read or written, as codes, and the text of each."""

from collections.abc import Mapping
from enum import StrEnum


class KnowledgeCode(StrEnum):
    """Condition that keeps knowledge from being read or written."""

    # SQLite
    LOCKS_STUCK = "locks stuck"
    DISK_FULL = "disk full"
    DISK_FAILS = "disk fails"
    DATABASE_LOCKED = "database locked"
    READ_ONLY = "read only"
    NOT_OPENED = "not opened"
    PAGES_DAMAGED = "pages damaged"
    SQLITE_REFUSES = "sqlite refuses"
    # The knowledge file
    FOLDER_NOT_LOCKABLE = "folder not lockable"
    DISK_WITHOUT_LOCKS = "disk without locks"
    ANOTHER_WRITER = "another writer"
    LOCK_NOT_RELEASED = "lock not released"
    STATUS_UNREADABLE = "status unreadable"
    FILE_GONE = "file gone"
    FOREIGN_LOG = "foreign log"
    NOT_CREATED = "not created"
    NOT_A_FILE = "not a file"
    HARD_LINKS = "hard links"
    UNREADABLE = "unreadable"
    NO_SQLITE_FILE = "no sqlite file"
    OTHER_PROGRAM = "other program"
    NEWER_FORMAT = "newer format"
    FOREIGN_SCHEMA = "foreign schema"
    LOG_NOT_SYNCED = "log not synced"
    NO_WRITE_AHEAD_LOG = "no write-ahead log"
    MOVED_IN_USE = "moved in use"
    FOLDER_NOT_MADE = "folder not made"
    # Its content
    BINDING_DAMAGED = "binding damaged"
    INTEGRITY = "integrity"
    """One line of SQLite's integrity check."""
    ROW_MISPLACED = "row misplaced"
    ROW_CHANGED = "row changed"
    NOT_AN_EVENT = "not an event"
    LESSON_MISFIT = "lesson misfit"
    EVENT_NOT_WRITABLE = "event not writable"
    ROW_NOT_GIVEN = "row not given"
    OTHER_FEATURES = "other features"
    OTHER_LEVEL_FEATURES = "other level features"
    OTHER_TASK = "other task"
    OTHER_TASK_GIVEN = "other task given"
    TASK_NOT_FOUND = "task not found"
    # The writer, and copies
    WRITER_CLOSED = "writer closed"
    LESSONS_NOT_WRITTEN = "lessons not written"
    NOT_DURABLE = "not durable"
    NOT_YET_DURABLE = "not yet durable"
    NOT_SIMULATED = "not simulated"
    UNKNOWN_COPY = "unknown copy"
    COPY_UNREADABLE = "copy unreadable"
    FOLDER_NOT_WRITABLE = "folder not writable"
    NOT_SAVED = "not saved"
    ALREADY_THERE = "already there"
    # New files from others
    NOT_BUILT = "not built"
    NO_TEMPORARY_FILES = "no temporary files"
    DUPLICATE_COMMAND = "duplicate command"
    # Packages
    PACKAGE_NOT_A_FILE = "package not a file"
    PACKAGE_TOO_LARGE = "package too large"
    PACKAGE_UNREADABLE = "package unreadable"
    PACKAGE_DAMAGED = "package damaged"
    PACKAGE_PART_MISSING = "package part missing"
    PACKAGE_PART_CHANGED = "package part changed"
    PACKAGE_DUPLICATE_NAME = "package duplicate name"
    PACKAGE_UNSAFE = "package unsafe"
    PACKAGE_COMPRESSION = "package compression"
    PACKAGE_NOT_OURS = "package not ours"
    PACKAGE_NEWER_FORMAT = "package newer format"
    PACKAGE_INVALID = "package invalid"
    PACKAGE_OTHER_FEATURES = "package other features"
    NOT_EXPORTABLE = "not exportable"
    MANIFEST_DAMAGED = "manifest damaged"
    SIGNATURE_DAMAGED = "signature damaged"
    SIGNATURE_WRONG = "signature wrong"
    OTHER_SIGNER = "other signer"
    KEY_IS_FOLDER = "key is folder"
    KEY_NOT_MADE = "key not made"
    NO_PRIVATE_KEY = "no private key"
    NO_PUBLIC_KEY = "no public key"
    # Versions
    BRANCH_NOTE_DAMAGED = "branch note damaged"
    NO_SUCH_POINT = "no such point"
    STAMP_INVALID = "stamp invalid"
    CHANGED_MEANWHILE = "changed meanwhile"
    MERGE_MISFIT = "merge misfit"
    NO_LESSON = "no lesson"
    NO_LESSON_BY = "no lesson by"
    NO_UNDONE_LESSON_BY = "no undone lesson by"
    LESSON_REFUSED = "lesson refused"
    """Field `outcome`: the kurt2rt.core.outcome.RefusalCode of it."""
    # Views
    NO_SUCH_RLA = "no such rla"
    NO_RLA_AT_LEVEL = "no rla at level"
    NO_RLA_OF_BEHAVIOUR = "no rla of behaviour"
    NO_SUCH_FOLDER = "no such folder"
    TAUGHT_BY_PEOPLE = "taught by people"
    # Recorded runs that knowledge is tried on, exams, uploads
    NO_RECORDED_RUN = "no recorded run"
    NO_RUN_FITS = "no run fits"
    NOTHING_DROVE = "nothing drove"
    DECISION_WOULD_CHANGE = "decision would change"
    EXAM_RUNS = "exam runs"
    EXAM_NOT_STARTED = "exam not started"
    UPLOAD_REFUSED = "upload refused"


_SQLITE = " (SQLite: {error})"
_BACKUP = "keep the file, and go on with a backup copy"
_KNOWLEDGE_FILE = "give the path of a kurt2rt knowledge file, or of a new one"
_PACKAGE = "give a file of kurt2rt knowledge export"
_NEW_COPY = "get another copy of it"
_EXPORT_AGAIN = "export it again"
_ROOMY_FOLDER = "give a path in a folder that may be written and has room"
_HEALTH = "look at the disk's health"
_LOCAL = "give a path on a local disk"
_NEW_FILE = "give the path of a new file"
_KEY = "kurt2rt knowledge key makes one"

TEXTS: Mapping[KnowledgeCode, tuple[str, str]] = {
    KnowledgeCode.LOCKS_STUCK: ("its locks are stuck", f"{_HEALTH}, and restart the robot program" + _SQLITE),
    KnowledgeCode.DISK_FULL: ("the disk is full", "make room on it" + _SQLITE),
    KnowledgeCode.DISK_FAILS: ("the disk fails", "look at its health and room, and keep a copy of the file" + _SQLITE),
    KnowledgeCode.DATABASE_LOCKED: ("another program holds it locked", "close that program" + _SQLITE),
    KnowledgeCode.READ_ONLY: ("it may not be written", "give write permission for the file and its folder" + _SQLITE),
    KnowledgeCode.NOT_OPENED: ("it cannot be opened", "look at permissions and room of its folder" + _SQLITE),
    KnowledgeCode.PAGES_DAMAGED: ("the file is damaged", _BACKUP + _SQLITE),
    KnowledgeCode.SQLITE_REFUSES: ("SQLite refuses it", _BACKUP + _SQLITE),
    KnowledgeCode.FOLDER_NOT_LOCKABLE: (
        "cannot be locked ({error})",
        "give a path in a folder that exists and may be written",
    ),
    KnowledgeCode.DISK_WITHOUT_LOCKS: ("cannot be locked ({error})", _LOCAL),
    KnowledgeCode.ANOTHER_WRITER: (
        "another kurt2rt is writing it ({error})",
        "stop that one, or give another knowledge file",
    ),
    KnowledgeCode.LOCK_NOT_RELEASED: ("its lock cannot be released ({error})", "it ends with this program"),
    KnowledgeCode.STATUS_UNREADABLE: ("its status cannot be read ({error})", _HEALTH),
    KnowledgeCode.FILE_GONE: (
        "is gone, but its log {log} is still there and may hold lessons",
        "put the file back next to it, or move the log away",
    ),
    KnowledgeCode.FOREIGN_LOG: ("a log {log} of another file is next to it", "give another path"),
    KnowledgeCode.NOT_CREATED: ("cannot be created ({error})", _ROOMY_FOLDER),
    KnowledgeCode.NOT_A_FILE: ("is a folder or device, not a file", _KNOWLEDGE_FILE),
    KnowledgeCode.HARD_LINKS: (
        "has {names} names (hard links), allowed is 1: lessons that a robot writes under one name are lost under "
        "the other",
        "make a copy (cp), then remove the other names",
    ),
    KnowledgeCode.UNREADABLE: ("cannot be read ({error})", _KNOWLEDGE_FILE),
    KnowledgeCode.NO_SQLITE_FILE: ("is not a knowledge file (no SQLite file)", _KNOWLEDGE_FILE),
    KnowledgeCode.OTHER_PROGRAM: ("is an SQLite file of another program", _KNOWLEDGE_FILE),
    KnowledgeCode.NEWER_FORMAT: (
        "has format {version} of a newer kurt2rt, this one knows up to {allowed}",
        "update kurt2rt",
    ),
    KnowledgeCode.FOREIGN_SCHEMA: (
        "holds a {kind} {name!r} that kurt2rt did not make",
        "it may be damaged or meant to harm: go on with a backup copy",
    ),
    KnowledgeCode.LOG_NOT_SYNCED: ("its log cannot be synced ({error})", _HEALTH),
    KnowledgeCode.NO_WRITE_AHEAD_LOG: (
        "its disk cannot hold an SQLite log (mode {mode})",
        "give a path on a local disk",
    ),
    KnowledgeCode.MOVED_IN_USE: (
        "it or its log was moved, deleted or replaced while in use",
        "put the same files back, or stop the robot and give a knowledge file",
    ),
    KnowledgeCode.FOLDER_NOT_MADE: ("cannot be made ({error})", "give a file in another folder"),
    KnowledgeCode.BINDING_DAMAGED: ("table binding is damaged ({error})", _BACKUP),
    KnowledgeCode.INTEGRITY: ("its pages are damaged ({line})", _BACKUP),
    KnowledgeCode.ROW_MISPLACED: ("stands where row {expected} should", "keep the file"),
    KnowledgeCode.ROW_CHANGED: ("was changed after it was written (checksum)", _BACKUP),
    KnowledgeCode.NOT_AN_EVENT: ("not a teaching event: {error}", _BACKUP),
    KnowledgeCode.LESSON_MISFIT: ("does not fit the lessons before it: {error}", _BACKUP),
    KnowledgeCode.EVENT_NOT_WRITABLE: ("cannot be written: {error}", "teach it again"),
    KnowledgeCode.ROW_NOT_GIVEN: ("SQLite gave no row for command {command_id!r}", "teach it again"),
    KnowledgeCode.OTHER_FEATURES: (
        "taught with other features: {difference}",
        "use the situation definition and robot it was taught with, or give another knowledge file",
    ),
    KnowledgeCode.OTHER_LEVEL_FEATURES: (
        "its level {level} was taught with other features: {difference}",
        "use the {level} settings it was taught with, or give another knowledge file",
    ),
    KnowledgeCode.OTHER_TASK: (
        "taught for the task {taught!r}, not for {wanted!r}",
        "start that task, or give another knowledge file",
    ),
    KnowledgeCode.OTHER_TASK_GIVEN: (
        "was taught for the task {taught!r}, not for {wanted!r}",
        "leave out --task, or give another knowledge file",
    ),
    KnowledgeCode.TASK_NOT_FOUND: (
        "was taught for the task {taught!r}, whose settings are not found ({error})",
        "give them: --task PATH.yaml",
    ),
    KnowledgeCode.WRITER_CLOSED: ("its writer is closed", "open the journal again to teach"),
    KnowledgeCode.LESSONS_NOT_WRITTEN: ("{reason}", "closed with {count} lessons not written"),
    KnowledgeCode.NOT_DURABLE: ("{reason}", ""),
    KnowledgeCode.NOT_YET_DURABLE: ("the newest lessons are not saved yet", "try again later"),
    KnowledgeCode.NOT_SIMULATED: ("this robot is not simulated here", "examine its knowledge with kurt2rt exam"),
    KnowledgeCode.UNKNOWN_COPY: ("is no copy of this run of the program", "save or export again"),
    KnowledgeCode.COPY_UNREADABLE: ("cannot be read ({error})", "save or export again"),
    KnowledgeCode.FOLDER_NOT_WRITABLE: (
        "nothing can be saved there ({error})",
        "give a folder that may be written and has room",
    ),
    KnowledgeCode.NOT_SAVED: ("cannot be saved ({error})", _ROOMY_FOLDER),
    KnowledgeCode.ALREADY_THERE: ("is there already", _NEW_FILE),
    KnowledgeCode.NOT_BUILT: ("no knowledge file can be made of it: {reason}", ""),
    KnowledgeCode.NO_TEMPORARY_FILES: ("cannot be unpacked ({error})", "make room where temporary files go"),
    KnowledgeCode.DUPLICATE_COMMAND: (
        "has the command id {command_id!r} of row {row}",
        "keep the file, and get another copy",
    ),
    KnowledgeCode.PACKAGE_NOT_A_FILE: ("is a folder or device", _PACKAGE),
    KnowledgeCode.PACKAGE_TOO_LARGE: ("is larger than {allowed_mb} MB, which no knowledge is", _PACKAGE),
    KnowledgeCode.PACKAGE_UNREADABLE: ("cannot be read ({error})", _PACKAGE),
    KnowledgeCode.PACKAGE_DAMAGED: ("is torn or changed, or no file of kurt2rt knowledge export ({error})", _NEW_COPY),
    KnowledgeCode.PACKAGE_PART_MISSING: ("has no {name}", _NEW_COPY),
    KnowledgeCode.PACKAGE_PART_CHANGED: ("{name} was changed after it was exported (SHA-256)", _NEW_COPY),
    KnowledgeCode.PACKAGE_DUPLICATE_NAME: ("holds a file twice", _NEW_COPY),
    KnowledgeCode.PACKAGE_UNSAFE: ("{reason}", "nothing of it was read: get another copy from a source that you trust"),
    KnowledgeCode.PACKAGE_COMPRESSION: ("is packed in a way that kurt2rt knowledge export does not use", _NEW_COPY),
    KnowledgeCode.PACKAGE_NOT_OURS: ("its {name} is none of kurt2rt", _PACKAGE),
    KnowledgeCode.PACKAGE_NEWER_FORMAT: (
        "has format {version} of a newer kurt2rt, this one knows up to {allowed}",
        "update kurt2rt",
    ),
    KnowledgeCode.PACKAGE_INVALID: ("cannot be understood ({error})", _EXPORT_AGAIN),
    KnowledgeCode.PACKAGE_OTHER_FEATURES: (
        "was taught with other features: {difference}",
        "import it with the task and robot settings that it was taught with (--task, --robot-settings)",
    ),
    KnowledgeCode.NOT_EXPORTABLE: ("cannot be exported: it {reason}", "name its settings otherwise"),
    KnowledgeCode.MANIFEST_DAMAGED: ("its {name} is damaged ({error})", _NEW_COPY),
    KnowledgeCode.SIGNATURE_DAMAGED: ("its {name} is damaged ({error})", _NEW_COPY),
    KnowledgeCode.SIGNATURE_WRONG: ("its signature does not fit: it was changed after it was signed", _NEW_COPY),
    KnowledgeCode.OTHER_SIGNER: ("is {signed}, not signed by {trusted}", "nothing was imported"),
    KnowledgeCode.KEY_IS_FOLDER: ("is a folder", "give the key file to make"),
    KnowledgeCode.KEY_NOT_MADE: ("no key can be made there ({error})", _NEW_FILE),
    KnowledgeCode.NO_PRIVATE_KEY: ("is no Ed25519 key that can sign ({error})", _KEY),
    KnowledgeCode.NO_PUBLIC_KEY: (
        "is no Ed25519 public key ({error})",
        "give the .pub file of a signer that you trust",
    ),
    KnowledgeCode.BRANCH_NOTE_DAMAGED: (
        "its note on the file it was branched from is damaged ({error})",
        "keep the file",
    ),
    KnowledgeCode.NO_SUCH_POINT: (
        "holds no lesson {given!r}, and that is no time either",
        "give an id as kurt2rt knowledge lessons shows it, or a time such as 2026-11-22T03:10",
    ),
    KnowledgeCode.STAMP_INVALID: ("the stamp of a lesson is no time ({error})", "give the id of a lesson instead"),
    KnowledgeCode.CHANGED_MEANWHILE: ("was taught while the merge was planned", "merge again"),
    KnowledgeCode.MERGE_MISFIT: (
        "cannot be merged into {into}: {error}",
        "undo there what is in the way, or go on in one of them",
    ),
    KnowledgeCode.NO_LESSON: ("holds no lesson that {state}", ""),
    KnowledgeCode.NO_LESSON_BY: ("holds no lesson by {teacher} that stands", "{others}"),
    KnowledgeCode.NO_UNDONE_LESSON_BY: ("holds no undone lesson by {teacher} that can stand again{reason}", ""),
    KnowledgeCode.LESSON_REFUSED: ("{reason}", "kurt2rt knowledge lessons shows the ids of lessons"),
    KnowledgeCode.NO_SUCH_RLA: ("holds no RLA {rla_id}", "kurt2rt knowledge show lists them"),
    KnowledgeCode.NO_RLA_AT_LEVEL: ("holds no RLA of the level {level!r}", "it has RLAs of: {found}"),
    KnowledgeCode.NO_RLA_OF_BEHAVIOUR: ("holds no RLA of the behaviour {behaviour!r}", "it has: {found}"),
    KnowledgeCode.NO_SUCH_FOLDER: (
        "is not there",
        "give the folder that your knowledge files are in, or one of them",
    ),
    KnowledgeCode.TAUGHT_BY_PEOPLE: ("{people} taught in it, and a scripted teacher would change it", "{instead}"),
    KnowledgeCode.NO_RECORDED_RUN: ("holds no recorded run", "kurt2rt run makes them, --runs gives their folder"),
    KnowledgeCode.NO_RUN_FITS: ("none of its runs can be tried: {reason}", ""),
    KnowledgeCode.NOTHING_DROVE: (
        "in none of its {runs} runs of such knowledge anything drove (0 s)",
        "they prove nothing, and nothing was deleted: record a run in which the robot drives",
    ),
    KnowledgeCode.DECISION_WOULD_CHANGE: (
        "at {at_s:.2f} s the robot would do something else: {new}, and not {old}",
        "nothing was deleted",
    ),
    KnowledgeCode.EXAM_RUNS: ("an exam is under way", "wait for its end"),
    KnowledgeCode.EXAM_NOT_STARTED: ("the exam cannot be started ({error})", "install kurt2rt whole"),
    KnowledgeCode.UPLOAD_REFUSED: ("{reason}", ""),
}
"""(fault, remedy) of each code, with the error's fields in braces."""
