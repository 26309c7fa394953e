"""--shard, with one meaning in every study: this machine does a part of the robots."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.json_output import print_json
from kurt2rt.cli.study_run import study_run
from kurt2rt.cli.tables import console_of
from kurt2rt.experiments.study.loop_choice import NO_CHOICE, LoopChoice
from kurt2rt.experiments.study.plan import StudyPlan
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.shard import Shard, shard_of
from kurt2rt.platform.text_table import print_whole

ShardOption = Annotated[
    str | None,
    typer.Option(
        "--shard",
        metavar="K/N",
        help="Do the K-th of N parts of the robots only, without tables and verdicts; kurt2rt results merge puts the "
        "parts together.",
        show_default=False,
    ),
]


def run_shard(
    plan: StudyPlan,
    results: Results,
    command: str,
    shard: str,
    jobs: int,
    on: Path | None,
    *,
    choice: LoopChoice = NO_CHOICE,
    as_json: bool = False,
) -> None:
    """Run the jobs of a shard that have no result, and print what to do next.

    Args:
        command: typed words that decide the numbers, without the shard.
        shard: value of --shard.
        jobs: number of processes.
        on: value of --on.
        choice: loops of the plan's jobs.
        as_json: print one JSON document instead.

    Raises:
        ShardError: there is no such shard.
        StudyError: another run writes to the folder, or it has results of other settings.
        ClusterError: `on` is no file of a cluster, or no scheduler of it answers.
    """
    own = shard_of(plan, Shard.parse(shard))
    with study_run(plan, results, command, jobs, on, part=own, choice=choice):
        pass
    count = sum(map(len, own.waves))
    if as_json:
        print_json({"shard": shard, "seeds": own.seeds, "jobs": count, "folder": results.folder})
        return
    print_whole(
        console_of(),
        f"shard {shard} is done: {count} jobs in {results.folder}",
        f"next: the other shards, then kurt2rt results merge OUT {results.folder} ..., then {command} --out OUT",
    )
