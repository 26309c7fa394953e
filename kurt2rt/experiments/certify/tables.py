"""Tables of a certificate: probabilities and rates with their 95 % intervals, and the worst runs."""

import math
from collections.abc import Iterator, Sequence

from kurt2rt.experiments.certify.outcome import RunOutcome
from kurt2rt.experiments.certify.plan import Certificate
from kurt2rt.experiments.certify.summary import PlaceSummary, Share, summarise
from kurt2rt.experiments.lockstep.report import label_of
from kurt2rt.experiments.study.intervals import Rate
from kurt2rt.experiments.study.table import Table


def all_tables(certificate: Certificate, worst: Sequence[RunOutcome]) -> Iterator[Table]:
    """Yield all tables: probabilities, rates and, if there are any, the worst runs."""
    summaries = list(summarise(certificate))
    yield probability_table(certificate, summaries)
    yield rate_table(summaries)
    if worst:
        yield worst_table(certificate, worst)


def probability_table(certificate: Certificate, summaries: Sequence[PlaceSummary]) -> Table:
    """Return the probability of each event within one run, by place."""
    task = certificate.plan.task
    return Table(
        f"Probability within {task.exam.duration_s:g} s of {task.name}",
        ("world", "runs", "a collision", "stuck", "a question", "stopped by a watch", "none of these"),
        tuple(
            (
                label_of(each.place),
                str(each.runs),
                *map(_format_share, (each.collided, each.stuck, each.asked, each.stopped, each.clean)),
            )
            for each in summaries
        ),
        note="With 95 % intervals (Wilson). Each run is another robot: gains and turns of its sensors, their noise, "
        "the slip of its wheels, start and world follow from the run's number. A run ends where the robot is stuck or "
        f"stopped. {_format_witnesses(certificate)}",
    )


def rate_table(summaries: Sequence[PlaceSummary]) -> Table:
    """Return events in an hour, the share of time in unknown situations, and the speed, by place."""
    return Table(
        "In an hour of driving",
        ("world", "hours", "collisions", "first question", "all questions", "time in the unknown", "m in a minute"),
        tuple(
            (
                label_of(each.place),
                f"{each.hours:.1f}",
                *map(_format_rate, (each.collisions_per_hour, each.first_questions_per_hour, each.questions_per_hour)),
                f"{each.unknown_share:.3%}",
                f"{each.m_per_minute:.1f}",
            )
            for each in summaries
        ),
        note="With 95 % intervals: Poisson's exact one, and for events that come in clusters the wider of it and a "
        "bootstrap. No teacher answers: a robot that asks stands until its noise lets it drive on. First question: "
        "questions in an hour of a robot that has not asked yet.",
    )


def worst_table(certificate: Certificate, worst: Sequence[RunOutcome]) -> Table:
    """Return one row for each of the worst runs."""
    period_s = certificate.plan.blocks[0].robot.cycle_s

    def format_tick(tick: int) -> str:
        return f"{tick * period_s:.1f}" if tick else ""

    return Table(
        "Worst runs",
        (
            *("run", "world", "broken sensor"),
            *("collisions", "first after s", "first question after s", "stuck after s", "stopped"),
        ),
        tuple(
            (
                str(each.number),
                label_of(each.world),
                each.broken,
                str(each.collisions),
                *map(format_tick, (each.first_collision, each.first_question, each.ticks if each.stuck else 0)),
                each.stopped,
            )
            for each in worst
        ),
        words=3,
        note="Most collisions first. The number of a run is its seed.",
    )


def _format_witnesses(certificate: Certificate) -> str:
    """Return how many runs the batch and the CAN loop drove with equal outcomes, and how many the loop alone."""
    alone = len(certificate.on_bus)
    if alone == len(certificate.outcomes):
        return "All runs were driven on the CAN loop."
    left = f"; {alone} with a broken sensor, or that left the batch, were driven there alone" if alone else ""
    return f"{certificate.compared} runs were driven on the CAN loop too, with equal results{left}."


def _format_rate(rate: Rate) -> str:
    if math.isinf(rate.high):
        return f"{rate.value:.2f}"
    return f"{rate.value:.2f} ({rate.low:.2f} to {rate.high:.2f})"


def _format_share(share: Share) -> str:
    return f"{share.value:.2%} ({share.low:.2%} to {share.high:.2%})"
