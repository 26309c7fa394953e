"""`kurt2rt rivals`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType

from hal.robot_kind import simulations_of
from hal.robot_settings import RobotSettings, load_robot_of
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.executor_option import OnOption
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.loop_options import ExamsOption, LessonsOption, requested_loops
from kurt2rt.cli.options import (
    ALL_PROCESSORS,
    DEFAULT_OF_THE_TASK,
    Changes,
    Jobs,
    RobotName,
    changes_of,
    parse_seeds,
    results_option,
    task_option,
    teacher_option,
)
from kurt2rt.cli.shards import ShardOption, run_shard
from kurt2rt.cli.study_run import study_run
from kurt2rt.cli.tables import console_of, tables_of
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.core.task_robot import require_robot_of
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.rivals.leagues import LeagueName, rows_of_league
from kurt2rt.experiments.rivals.rival import Rival
from kurt2rt.experiments.rivals.tuned import load_tuned
from kurt2rt.experiments.study.loop_choice import LoopRequest
from kurt2rt.platform.text_table import print_whole

_AFTER = (10, 20, 40)
_SEED_OF_THE_CHECK = 1
_NOT_TUNED = "none"


@dataclass(frozen=True, slots=True)
class _Options:
    """Options of `kurt2rt rivals`."""

    league: Annotated[
        LeagueName | None,
        typer.Option(
            help="League whose rivals take part, besides those of --learner. Default: presses without --learner, else "
            "no more than those.",
            show_default=False,
        ),
    ] = None
    learner: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[=GATE]",
            help="Learner: a name, or module:Name of your own, which Python finds in this folder too. GATE is the "
            "number by which it asks; of the agents dqn, qr-dqn and ppo it is the robot life in s in which they are "
            "trained. May be given again.",
            show_default=False,
        ),
    ] = None
    task: Annotated[list[str] | None, task_option("Repeat for several. Default: wall_following.")] = None
    teacher: Annotated[str | None, teacher_option(DEFAULT_OF_THE_TASK)] = None
    seeds: Annotated[str, typer.Option(help="Robots by their seeds, e.g. 4106-4125.")] = "4106-4125"
    after: Annotated[
        list[int] | None,
        typer.Option(
            min=1,
            help="Number of presses after which the robot is examined, besides the end of its lesson; may be given "
            f"again. Default: {', '.join(map(str, _AFTER))}.",
            show_default=False,
        ),
    ] = None
    tuned: Annotated[
        str,
        typer.Option(
            metavar="NAME|PATH",
            help="Settings that `kurt2rt tune` found for the rivals: a name in config/rivals/tuned, a file, or none.",
        ),
    ] = _NOT_TUNED
    check: Annotated[
        bool,
        typer.Option(
            "--check", help="Only check that the learners keep the promises of the door, in seconds, and teach nothing."
        ),
    ] = False
    changes: Changes = None
    jobs: Jobs = ALL_PROCESSORS
    shard: ShardOption = None
    on: OnOption = None
    lessons: LessonsOption = LoopRequest.AUTO
    exams: ExamsOption = LoopRequest.AUTO
    out: Annotated[Path, results_option("results/rivals")] = Path("results/rivals")
    robot_settings: RobotName = None
    as_json: AsJson = False


@takes_options(_Options)
def rivals(options: _Options) -> None:
    """Compare learners of other kinds with the RLA system, taught by the same teacher.

    Each learner is taught as each robot, through the same lessons, guard and
    sensors, and examined without its teacher after 10, 20 and 40 presses and
    at the end. The tables show the robots that pass, the teacher's effort,
    collisions while it was taught, the machine's time, and what an undo
    restores; each row is compared with the RLA system robot by robot.

    For example, the league with the settings that an equal tuning found;
    another league; one learner with another gate; an agent that is trained
    for an hour; your own; and all three leagues on one page, with yours:

        kurt2rt rivals --tuned presses
        kurt2rt rivals --league holds
        kurt2rt rivals --learner k-nn=0.8 --task fleeing --task eight
        kurt2rt rivals --league signals --learner ppo=3600
        kurt2rt rivals --learner mine:Mine --check
        kurt2rt rivals --league all --tuned presses --learner mine:Mine

    Results are kept in --out with hashes of what made them; a run that was
    interrupted goes on where it was. docs/add-a-learner.md says how to write
    a learner.
    """
    names = dict.fromkeys(options.task or ("wall_following",))
    robot = load_robot_of(options.robot_settings, next(iter(names)))
    tasks = [taught_by_named(load_task(name, changes=changes_of(options.changes)), options.teacher) for name in names]
    for name, task in zip(names, tasks, strict=True):
        require_robot_of(task, name, robot)
    named = [Rival.parse(name) for name in options.learner or ()]
    rows = rows_of_league(options.league or LeagueName.PRESSES) if options.league or not named else ()
    of_league = [Rival.parse(name) for name in rows]
    chosen = list(dict.fromkeys((*of_league, *named)))
    if options.check:
        _check(chosen, tasks[0], robot, options)
        return
    # Not at the top: the simulator and drawing are extras, and every command is loaded where --help is said.
    from kurt2rt.experiments.rivals.plan import make_plan, read_league
    from kurt2rt.experiments.rivals.report import write_report
    from kurt2rt.experiments.rivals.sections import make_sections, overview_tables, report_name
    from kurt2rt.experiments.study.eligibility import reasons_against_judging
    from kurt2rt.experiments.study.jobs import JobParts
    from kurt2rt.experiments.study.results import Results
    from kurt2rt.experiments.study.table import as_rich

    results = Results(options.out)
    parts = JobParts(factory=simulations_of(robot), robot=robot, results=results)
    after = sorted(set(options.after or _AFTER))
    tuned = None if options.tuned == _NOT_TUNED else load_tuned(options.tuned)
    plan = make_plan(
        tasks,
        chosen,
        parse_seeds(options.seeds),
        after,
        parts,
        optional=set(of_league).difference(named),
        tuned=tuned,
        loops=requested_loops(options.lessons, options.exams),
    )
    command = typed_command("rivals", options, {"seeds": options.seeds})
    if options.shard is not None:
        run_shard(plan, results, command, options.shard, options.jobs, options.on, as_json=options.as_json)
        return
    not_judged = [*reasons_against_judging(plan.seeds), *plan.left_out]
    with study_run(plan, results, command, options.jobs, options.on, choice=plan.choice) as bar:
        bar.say("figures and report")
        league = read_league(plan, results)
        sections = make_sections(league, options.out)
        overview = overview_tables(league, sections)
        report = options.out / report_name(sections)
        write_report(plan, sections, overview, not_judged, command, report)
    if options.as_json:
        own = (table | {"league": each.name} for each in sections for table in tables_of(each.tables))
        tables = [*tables_of(overview), *own]
        print_json({"tables": tables, "not_judged": not_judged, "report": report})
        return
    shown: list[RenderableType] = [*map(as_rich, overview)]
    for each in sections:
        shown += ([each.title] if overview else []) + [*map(as_rich, each.tables)]
    print_whole(console_of(), *shown, *not_judged, f"report  {report}")


def _check(chosen: list[Rival], task: TaskSettings, robot: RobotSettings, options: _Options) -> None:
    """Print the promises that learners break. Raises typer.Exit with code 1 if one does."""
    from kurt2rt.checks.plugins.learner_check import check_learner

    found = {
        each.name: check_learner(each.factory(), learner_setting(task, robot, seed=_SEED_OF_THE_CHECK, gate=each.gate))
        for each in chosen
        if each.is_learner
    }
    trained = {
        each.name: "is trained by its own trials, so lessons teach it nothing" for each in chosen if each.is_agent
    }
    if options.as_json:
        print_json(
            {
                "broken": {name: each.broken for name, each in found.items()},
                "notes": {name: each.note for name, each in found.items()} | trained,
            }
        )
    else:
        for name, text in trained.items():
            typer.echo(f"{name}: {text}")
        for name, (broken, note) in found.items():
            typer.echo(f"{name}: " + ("keeps all promises" if not broken else "breaks promises"))
            for line in (*broken, *filter(None, (note,))):
                typer.echo(f"  {line}")
    if any(each.broken for each in found.values()):
        raise typer.Exit(1)
