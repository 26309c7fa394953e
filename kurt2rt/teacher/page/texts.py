"""Texts of the page's server: its own refusals and notices; texts of the robot's codes are `outcome_text`'s."""

from config.errors import TextCode


class PageNotice(TextCode):
    """Code of a refusal or notice of the page's own server, as opposed to the robot's."""

    NOT_IN_CONTROL = ("not in control", "another page has control; touch Take control first")
    NO_STATE = ("no state", "this page has not shown the robot since it started; look, and try again")
    BUSY = ("busy", "the robot has not answered the last commands yet; wait")
    CONTROL_TAKEN = ("control taken", "this page has control")
    NOTHING_DECIDED = ("nothing decided", "nothing was decided yet")
    PRESS_LOST = ("press lost", "no word from this page for 250 ms: the robot was stopped; press again")
    STOP_UNANSWERED = ("stop unanswered", "the robot did not answer the stop at the end of the press")
    UNSEEN_STOP = (
        "unseen stop",
        "page hidden, closed or too busy for 0.3 s: the robot was stopped; GO lets it drive on",
    )
    ROBOT_ABSENT = ("robot absent", "no robot at {place}; is kurt2rt run running?")
    ROBOT_SILENT = ("robot silent", "no answer from the robot at {place}")
    FOREIGN_HOST = ("foreign host", "not known as an address of this machine; start with --page-address and this name")
    FOREIGN_PAGE = ("foreign page", "opened by a page of another site")
    TOO_MANY_TOKENS = ("too many tokens", "too many wrong tokens from this address; the right one still works")
    UPLOAD_BUSY = ("upload busy", "another file is being uploaded; wait for it")
    UPLOAD_EMPTY = ("upload empty", "the file is empty; choose an export or a knowledge file")
    UPLOAD_TOO_LARGE = ("upload too large", "the file is too large (at most {most_mb} MB)")
    DOWNLOAD_TOO_LARGE = ("download too large", "{name}: the file is too large (got {size} bytes, at most {most})")


def text_of(notice: PageNotice, **fields: object) -> str:
    """Return the text of a notice, with the values of its fields."""
    return notice.text.format(**fields)
