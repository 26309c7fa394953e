"""--lessons and --exams, with one meaning in every study: the loop that drives, which changes no result."""

from typing import Annotated

import typer

from kurt2rt.cli.interpreted_batch import say_if_interpreted
from kurt2rt.experiments.study.loop_choice import LoopChoice, LoopRequest, RequestedLoops

_MEANING = (
    "batch: compiled loops with equal results (extra fast); 1 % of the robots, at least three, are driven on the bus "
    "too and must agree. A task that the batch does not know is driven on the bus. auto: batch if it is installed and "
    "the study is long enough."
)
LessonsOption = Annotated[
    LoopRequest, typer.Option(help=f"What drives the lessons of phases 1 and 2. {_MEANING}", show_default=True)
]
ExamsOption = Annotated[LoopRequest, typer.Option(help="What drives the exams, as --lessons.", show_default=True)]


def requested_loops(lessons: LoopRequest, exams: LoopRequest) -> RequestedLoops:
    """Return the requests of both options; say on standard error that an explicit batch is not compiled."""
    # Not at the top: the simulator is an extra, and every command is loaded where --help is said.
    from simbridge.batch.compiled import IS_COMPILED

    if LoopRequest.BATCH in (lessons, exams):
        say_if_interpreted()
    return RequestedLoops(lessons, exams, compiled=IS_COMPILED)


def say_choice(choice: LoopChoice) -> None:
    """Say on standard error how many jobs a batch drives, how many have a witness, and what the batch does not know."""
    for refusal in choice.refusals:
        typer.echo(refusal, err=True)
    if choice.loops:
        jobs = f"{len(choice.loops)} job{'' if len(choice.loops) == 1 else 's'}"
        typer.echo(f"the study has {jobs} in the batch, {len(choice.witnessed)} of them on the CAN bus too", err=True)
