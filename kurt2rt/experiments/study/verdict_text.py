"""Texts of verdicts in the tables of reports."""

from collections.abc import Mapping, Sequence

from kurt2rt.experiments.study.verdict import Result, Target, Verdict

_TEXTS: Mapping[Target, tuple[str, str, str]] = {
    Target.RLAS: ("RLAs, median", "at most {limit}", "{rlas:g}"),
    Target.TEACHING: ("teaching", "at most {limit_s:g} s", "{teaching_s:g} s"),
    Target.SUCCESS: ("success in {world}", "at least {needed} of {judged}", "{success}"),
    Target.JUNCTIONS_RIGHT: ("junctions right in {world}", "at least {share:.0%}", "{right}"),
    Target.COLLISIONS: ("collisions in 10 min in {world}", "below {limit:g}", "{rate:.2f}"),
    Target.REPAIRED_BY_REWARDS: (
        "repaired by phase 3, {world}",
        "at least {needed} of {robots}",
        "{succeeded} of {robots}",
    ),
    Target.REPAIRED_BY_CRITIC: (
        "repaired by the critic alone, {world}",
        "at least {needed} of {robots}",
        "{succeeded} of {robots}",
    ),
    Target.NEGATIVE_REWARDS: ("blame in phase 3, most of all robots", "at most {limit}", "{most}"),
    Target.FEWER_COLLISIONS: (
        "collisions fall by the critic alone",
        "by {share:.0%}",
        "by {fall:.0%} ({low:.0%} to {high:.0%}), {before:.2f} to {after:.2f} in 10 min",
    ),
    Target.INTACT_STAYS_CLEAN: (
        "an intact set in phase 5, {world}: {measure}",
        "no robot that was clean is not after",
        "{before:.3f} -> {after:.3f}; robots no longer clean: {no_longer_clean}",
    ),
    Target.INTACT_NOT_WORSE: (
        "an intact set in phase 5, {world}: {measure}",
        "worse by at most {margin:.0%}, at the bad end of 95 %",
        "{before:.3f} -> {after:.3f}, at worst {worst:.1%} {direction}",
    ),
    Target.INTERVENTIONS: (
        "interventions an hour after phase 5",
        "below {limit:g}",
        "{rate:.2f} ({low:.2f} to {high:.2f}); {robots}",
    ),
    Target.MID_RLAS: ("mid-level RLAs, most", "at most {limit}", "{most}"),
    Target.DECISIONS_RIGHT: ("decisions right", "at least {share:.0%}", "{right:.2%} of {junctions}"),
    Target.WITHOUT_ERROR: (
        "drives without an error",
        "at least {needed} of {robots}",
        "{without_error} of {robots}",
    ),
    Target.RIGHT_IN_NEW_WORLD: (
        "right there after at most {presses} presses",
        "at least {needed} of {judged}",
        "{right} of {judged}",
    ),
    Target.PRESSES_UNTIL_RIGHT: ("presses until right, median", "at most {limit}", "{median}"),
    Target.RIGHT_AT_HOME: (
        "right at home as soon as right there",
        "{robots} of {robots}",
        "{right} of {robots} (before: {before})",
    ),
}
"""Name, requirement and measured value."""

RESULT_TEXTS: Mapping[Result, str] = {
    Result.MET: "met",
    Result.MISSED: "MISSED",
    Result.NOT_JUDGED: "not judged",
}
"""A miss is in capitals, so that it is seen without color."""


def cells_of(verdict: Verdict) -> tuple[str, str, str]:
    """Return name, requirement and measured value."""
    name, requirement, measured = (text.format(**verdict.values) for text in _TEXTS[verdict.target])
    return name, requirement, measured


def result_text(verdict: Verdict, not_judged_because: Sequence[str] = ()) -> str:
    """Return the result in words; not judged if there are reasons against a verdict."""
    return RESULT_TEXTS[Result.NOT_JUDGED if not_judged_because else verdict.result]
