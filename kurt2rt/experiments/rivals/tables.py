"""Tables of a league."""

from collections.abc import Callable, Iterator, Sequence
from statistics import median

from kurt2rt.experiments.rivals.cells import heading, rows_of, share_text
from kurt2rt.experiments.rivals.claims import claim_table, hands_table
from kurt2rt.experiments.rivals.outcome import RivalOutcome
from kurt2rt.experiments.rivals.paired import Saving, compare_all, saving_of
from kurt2rt.experiments.rivals.plan import League, Row
from kurt2rt.experiments.rivals.rival import SHIPPED
from kurt2rt.experiments.study.table import Table

_GATES = (
    "Default gates are first choices; the forest's is 0.2 since it asked everywhere with 0.4, on robots 4100 to 4102. "
)
_AGENTS = "Agents have the defaults of their libraries but for a few settings, chosen on robots 3900 to 3908. "


def tuning_text(league: League) -> str:
    """Return which rivals have settings that were searched, in a sentence or two."""
    others = [row.entry.rival for row in league.rows if row.entry.rival.name != SHIPPED]
    tuned = list(dict.fromkeys(each.title for each in others if each.tuned))
    own = list(dict.fromkeys(each.title for each in others if not (each.tuned or each.is_agent)))
    said = f"Tuned equally by `kurt2rt tune`: {'; '.join(tuned)}. " if tuned else ""
    defaults = f"Not tuned, with the defaults of their classes: {'; '.join(own)}. " if own else ""
    agents = _AGENTS if any(each.is_agent for each in others) else ""
    gates = _GATES if any(each.name == "forest" and not each.tuned for each in others) else ""
    return f"{said}{defaults}{gates}{agents}The settings of the RLA system as shipped were searched for longer."


def all_tables(league: League) -> Iterator[Table]:
    """Yield all tables: success by presses, the comparison, the effort, the machine, and failures if there are any."""
    yield success_table(league)
    claim = claim_table(league)
    if claim.rows:
        yield claim
    if any(row.entry.rival.is_held for row in league.rows):
        yield hands_table(league)
    yield comparison_table(league)
    yield effort_table(league)
    yield machine_table(league)
    if any(each.failure for row in league.rows for each in row.outcomes):
        yield failure_table(league)


def success_table(league: League) -> Table:
    """Return the robots that pass in all worlds, by presses, with 95 % intervals."""
    after = league.plan.after

    def cells(row: Row) -> Iterator[str]:
        for place in range(len(after) + 1):
            yield share_text(row.passed(place), len(row.judged))
        yield f"{row.mean_share:.0%}" if row.judged else ""

    lasting = ", ".join(f"{task.name} {task.exam.duration_s:.0f} s" for task in league.plan.tasks)
    return Table(
        "Robots that pass, by presses",
        ("task", "learner", *(f"after {presses}" for presses in after), "at the end", "mean"),
        rows_of(league, cells),
        words=2,
        note=f"A robot passes if it passes in every world of the task's exam, without a teacher ({lasting}), judged by "
        "the drive of the teacher's policy from the same start; a world in which the policy does not pass is left out. "
        "With 95 % intervals. A robot that gave cause for fewer presses has all that it was taught. Mean: of the "
        f"shares in this row. {tuning_text(league)} All see the situation with the weights of the RLAs.",
    )


def comparison_table(league: League) -> Table:
    """Return the paired comparison of each rival with the RLA system as shipped, at the end of the lessons."""
    rows = []
    for task in league.plan.tasks:
        shipped, others = league.of_task(task.name)
        compared = compare_all(shipped.outcomes, [row.outcomes for row in others])
        for row, (pairs, p_value, corrected) in zip(others, compared, strict=True):
            saved = _saving_text(saving_of(shipped.outcomes, row.outcomes))
            rows.append((*heading(row), *map(str, pairs), f"{p_value:.3f}", f"{corrected:.3f}", saved))
    return Table(
        "Compared with the RLA system as shipped, robot by robot",
        (
            *("task", "learner", "only the RLA system passes", "only the learner passes", "p", "p by Holm"),
            "presses fewer, mean (95 %)",
        ),
        tuple(rows),
        words=2,
        note="At the end of the lessons, on the same robots. p: McNemar's exact test, two-sided; by Holm: corrected "
        "for the number of rows of the task. Presses fewer than the RLA system's: mean of the differences robot by "
        "robot, with Student's interval; below 0 the learner takes more.",
    )


def _saving_text(saved: Saving | None) -> str:
    return "-" if saved is None else f"{saved.mean:.1f} ({saved.low:.1f} to {saved.high:.1f})"


def effort_table(league: League) -> Table:
    """Return the effort of the teacher, and collisions and alarms while the robots were taught."""
    columns: Sequence[tuple[str, Callable[[RivalOutcome], float]]] = (
        ("presses", lambda each: each.presses),
        ("questions", lambda each: each.asks),
        ("corrections", lambda each: each.corrections),
        ("labels", lambda each: each.labels),
        ("teacher drives, s", lambda each: each.driven_s),
        ("robot waits, s", lambda each: each.waited_s),
    )

    def cells(row: Row) -> Iterator[str]:
        for _, value in columns:
            yield f"{median(map(value, row.outcomes)):.0f}"
        yield str(sum(each.collisions for each in row.outcomes))
        yield str(sum(each.alarms for each in row.outcomes))
        yield str(sum(each.rescues for each in row.outcomes))

    return Table(
        "Effort, and safety while it is taught",
        ("task", "learner", *(name for name, _ in columns), "collisions", "alarms", "rescues"),
        rows_of(league, cells),
        words=2,
        note=f"Medians of {len(league.plan.seeds)} robots; collisions, alarms and rescues of all. Labels: situations "
        "with an action that the learner kept, ten a second of a hold; of the RLA system its lessons, because a hold "
        "teaches it nothing where it says so already. A reward is a label as well, and no press."
        + _if_agents(league, " Of an agent collisions and rescues are those of its training."),
    )


def _if_agents(league: League, text: str) -> str:
    """Return a text, or none for a league without agents."""
    return text if any(entry.rival.is_agent for entry in league.plan.entries) else ""


def _tick_p99_ms(row: Row) -> str:
    """Return the median over the lessons on the CAN bus; the batch has no ticks of the robot's program."""
    measured = [each.tick_p99_us for each in row.outcomes if each.tick_p99_us is not None]
    return f"{median(measured) / 1000:.2f}" if measured else "-"


def _change_ticks(row: Row) -> str:
    """Return median and 95th percentile over all corrections of all robots."""
    ticks = sorted(each for outcome in row.outcomes for each in outcome.change_ticks)
    return f"{median(ticks):.0f} ({ticks[int(0.95 * (len(ticks) - 1))]})" if ticks else "-"


def _followed(row: Row) -> str:
    shares = [each.followed_share for each in row.outcomes if each.followed_share is not None]
    return f"{median(shares):.0%}" if shares else "-"


def _machine_cells(row: Row) -> tuple[str, ...]:
    return (
        *_of_learner(row),
        _tick_p99_ms(row),
        f"{median(each.knowledge_bytes for each in row.outcomes) / 1000:.0f}",
        f"{1000 * median(each.undo_s for each in row.outcomes):.1f}",
        f"{sum(each.undo_restores for each in row.outcomes)} of {len(row.outcomes)}",
        _change_ticks(row),
        _followed(row),
    )


def machine_table(league: League) -> Table:
    """Return what learners take of the machine, and the undo of their last lesson."""
    return Table(
        "Machine and undo",
        (
            *("task", "learner", "retraining, s", "longest decision, ms", "p99 of a tick, ms", "knowledge, kB"),
            *("undo, ms", "undo restores", "correction acts, ticks", "lessons followed"),
        ),
        rows_of(league, _machine_cells),
        words=2,
        note="Medians of processor time; a tick's is a duration, which other work of the machine lengthens. "
        "Retraining: all lessons, each with the decision after it. The robot's clock stands still meanwhile: the guard "
        "of a real robot would refuse a decision that takes longer than 20 ms, and the robot would stand for a moment. "
        "Undo: of the last label, or of the last lesson of RLAs; it restores if all decisions at all lessons are those "
        "of a robot that never got it. A correction acts with the first tick of another action: median and 95th "
        "percentile; a hold acts at once, whatever was learned, and changes nothing where the robot does the same. "
        "Lessons followed: the next decision is as told, in the situation of the lesson; of the RLA system the lessons "
        "that changed it."
        + _if_agents(league, " An agent's training is without the simulation, and it cannot undo a reward."),
    )


def failure_table(league: League) -> Table:
    """Return the failures of learners, a row for each robot."""
    return Table(
        "Failures of learners",
        ("task", "learner", "robot", "failure"),
        tuple(
            (*heading(row), str(each.seed), each.failure)
            for row in league.rows
            for each in row.outcomes
            if each.failure
        ),
        words=4,
    )


def _of_learner(row: Row) -> tuple[str, str]:
    if not (row.entry.rival.is_learner or row.entry.rival.is_agent):
        return "", ""
    return (
        f"{median(each.retraining_s for each in row.outcomes):.2f}",
        f"{median(each.longest_decision_ms for each in row.outcomes):.1f}",
    )
