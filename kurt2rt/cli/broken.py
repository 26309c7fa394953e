"""`kurt2rt broken`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hal.robot_kind import simulations_of
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.executor_option import OnOption
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.options import ALL_PROCESSORS, Jobs, RobotName, parse_seeds, results_option, task_option
from kurt2rt.cli.shards import ShardOption, run_shard
from kurt2rt.cli.study_run import study_run
from kurt2rt.cli.tables import console_of, tables_of
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.experiments.broken.plan import BrokenDrives, chosen_sensors, make_plan, read_study
from kurt2rt.experiments.broken.tables import all_tables
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.table import as_rich
from kurt2rt.platform.text_table import print_whole


@dataclass(frozen=True, slots=True)
class _Options:
    """Arguments and options of `kurt2rt broken`."""

    taught: Annotated[Path, typer.Argument(help="Folder with knowledge files, as kurt2rt lesson --seeds leaves them.")]
    task: Annotated[str, task_option("Default: wall_following.")] = "wall_following"
    seeds: Annotated[str, typer.Option(help="Robots by their seeds, e.g. 0-4.")] = "0-4"
    sensor: Annotated[
        list[str] | None,
        typer.Option(help="Sensor to break, such as s15; may be given again. Default: each one in turn."),
    ] = None
    fault: Annotated[
        list[FaultKind] | None, typer.Option(help="Way to break it; may be given again. Default: all of them.")
    ] = None
    world: Annotated[
        list[str] | None,
        typer.Option(
            help="World to drive in; may be given again: the sensors take them in turn. SEED in the name stands for "
            "the robot's seed. Default: those of the exam."
        ),
    ] = None
    healthy_world: Annotated[
        list[str] | None,
        typer.Option(help="World to drive in with all sensors working; may be given again. Default: those of --world."),
    ] = None
    seconds: Annotated[
        float, typer.Option(metavar="SECONDS", min=1.0, help="Longest driving with a fault until it is noticed.")
    ] = 12.0
    after: Annotated[float, typer.Option(metavar="SECONDS", min=0.0, help="Time to drive on after Go.")] = 6.0
    healthy: Annotated[
        float,
        typer.Option(metavar="SECONDS", min=0.0, help="Drive with all sensors working, in each world; 0: none."),
    ] = 120.0
    faulty: Annotated[
        bool, typer.Option("--faults/--no-faults", help="Break sensors; without, only drives of working sensors.")
    ] = True
    jobs: Jobs = ALL_PROCESSORS
    shard: ShardOption = None
    on: OnOption = None
    out: Annotated[Path, results_option("results/broken")] = Path("results/broken")
    robot_settings: RobotName = None
    as_json: AsJson = False


@takes_options(_Options)
def broken(options: _Options) -> None:
    """Break each range sensor in turn, and measure whether the robot notices and collides.

    Each robot drives without a teacher; after 2 s one sensor breaks. At the
    notice the robot stands and gets its Go, on which the neighbours' readings
    replace the sensor's. The teacher's policy drives from the same start with
    the same fault, for comparison. In further drives all sensors work, also
    while the robot is pressed against walls: each sensor named there is a false
    alarm.

    For example:

        kurt2rt lesson --teacher ordinary --seeds 930-934
        kurt2rt broken results/lesson --seeds 930-934
        kurt2rt broken results/lesson --seeds 930 --sensor s15 --fault low

    Results are kept in --out with hashes of what made them; a run that was
    interrupted goes on where it was.
    """
    task, robot = load_task_and_robot(options.task, options.robot_settings)
    results = Results(options.out)
    worlds = tuple(options.world or task.exam.worlds)
    sensors = chosen_sensors(robot.infrared.names, options.sensor)
    drives = BrokenDrives(
        taught=options.taught,
        seeds=tuple(parse_seeds(options.seeds)),
        worlds=worlds,
        healthy_worlds=tuple(options.healthy_world or worlds),
        sensors=sensors if options.faulty else (),
        faults=tuple(dict.fromkeys(options.fault or FaultKind)),
        longest_s=options.seconds,
        after_s=options.after,
        healthy_s=options.healthy,
    )
    parts = JobParts(factory=simulations_of(robot), robot=robot, results=results)
    plan, command = (
        make_plan(task, drives, parts),
        typed_command("broken", options, {"task": options.task, "seeds": options.seeds}),
    )
    if options.shard is not None:
        run_shard(plan, results, command, options.shard, options.jobs, options.on, as_json=options.as_json)
        return
    with study_run(plan, results, command, options.jobs, options.on):
        study = read_study(plan, results)
    tables = list(all_tables(study))
    if options.as_json:
        print_json({"tables": tables_of(tables)})
    else:
        print_whole(console_of(), *map(as_rich, tables))
