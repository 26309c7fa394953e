"""Texts of the page's server: its own refusals and notices; texts of the robot's codes are `outcome_text`'s."""

from collections.abc import Mapping
from enum import StrEnum


class PageNotice(StrEnum):
    """Code of a refusal or notice of the page's own server, as opposed to the robot's."""

    NOT_IN_CONTROL = "not in control"
    NO_STATE = "no state"
    BUSY = "busy"
    CONTROL_TAKEN = "control taken"
    NOTHING_DECIDED = "nothing decided"
    PRESS_LOST = "press lost"
    STOP_UNANSWERED = "stop unanswered"
    UNSEEN_STOP = "unseen stop"
    ROBOT_ABSENT = "robot absent"
    ROBOT_SILENT = "robot silent"
    FOREIGN_HOST = "foreign host"
    FOREIGN_PAGE = "foreign page"
    TOO_MANY_TOKENS = "too many tokens"
    UPLOAD_BUSY = "upload busy"
    UPLOAD_EMPTY = "upload empty"
    UPLOAD_TOO_LARGE = "upload too large"
    DOWNLOAD_TOO_LARGE = "download too large"


_TEXTS: Mapping[PageNotice, str] = {
    PageNotice.NOT_IN_CONTROL: "another page has control; touch Take control first",
    PageNotice.NO_STATE: "this page has not shown the robot since it started; look, and try again",
    PageNotice.BUSY: "the robot has not answered the last commands yet; wait",
    PageNotice.CONTROL_TAKEN: "this page has control",
    PageNotice.NOTHING_DECIDED: "nothing was decided yet",
    PageNotice.PRESS_LOST: "no word from this page for 250 ms: the robot was stopped; press again",
    PageNotice.STOP_UNANSWERED: "the robot did not answer the stop at the end of the press",
    PageNotice.UNSEEN_STOP: "page hidden, closed or too busy for 0.3 s: the robot was stopped; GO lets it drive on",
    PageNotice.ROBOT_ABSENT: "no robot at {place}; is kurt2rt run running?",
    PageNotice.ROBOT_SILENT: "no answer from the robot at {place}",
    PageNotice.FOREIGN_HOST: "not known as an address of this machine; start with --page-address and this name",
    PageNotice.FOREIGN_PAGE: "opened by a page of another site",
    PageNotice.TOO_MANY_TOKENS: "too many wrong tokens from this address; the right one still works",
    PageNotice.UPLOAD_BUSY: "another file is being uploaded; wait for it",
    PageNotice.UPLOAD_EMPTY: "the file is empty; choose an export or a knowledge file",
    PageNotice.UPLOAD_TOO_LARGE: "the file is too large (at most {most_mb} MB)",
    PageNotice.DOWNLOAD_TOO_LARGE: "{name}: the file is too large (got {size} bytes, at most {most})",
}


def text_of(notice: PageNotice, **fields: object) -> str:
    """Return the text of a notice, with the values of its fields."""
    return _TEXTS[notice].format(**fields)
