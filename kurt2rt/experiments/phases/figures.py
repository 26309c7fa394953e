"""The figures of a path of all phases."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.core.critic.settings import load_critic
from kurt2rt.experiments.lockstep.drive_row import label_of
from kurt2rt.experiments.lockstep.teacher_workload import SAID
from kurt2rt.experiments.phases.results import MEASURES, PhasesStudy, exams_of, paired
from kurt2rt.experiments.phases.steps import BRANCHES, PATH, Step
from kurt2rt.experiments.study.figures import SavedFigure, saved
from kurt2rt.experiments.study.intervals import collisions_in_10_min, wilson_interval

_LOAD_COLOURS = {"lessons": "#1f6fb2", "corrections": "#d1495b", "rewards": "#2e8540", "appraisals": "#b8860b"}
_TEACHING = (Step.PHASE_2, Step.PHASE_3, Step.PHASE_4, Step.PHASE_5)
_AGREEMENT_EVERY_MIN = 1 / 6
_WORLD_COLOURS = ("#1f6fb2", "#d1495b", "#2e8540", "#b8860b", "#6b4c9a")


def draw_figures(study: PhasesStudy, folder: Path) -> Iterator[SavedFigure]:
    """Draw each figure into the folder and yield it.

    The files are phases.png, load.png, agreement.png, branches.png and intact.png. Raises OSError, and SettingsError if
    the task's critic cannot be loaded.
    """
    robots = len(study.plan.seeds)
    phase_by_phase = _stages(study, PATH)
    yield saved(phase_by_phase, folder / "phases.png", "Phase by phase", f"{robots} robots; bars are 95 % intervals.")
    yield saved(
        _load(study),
        folder / "load.png",
        "The teacher's load",
        "What he says in each minute, mean of all robots, along the path of all phases. Phase 5 has no teacher.",
    )
    yield saved(
        _agreement(study),
        folder / "agreement.png",
        "Agreement of the critic",
        "With the teacher's signals in phase 4, each compared before it was learnt: median (line) and quartiles (band) "
        "of the robots of which enough was heard. Above the bound the critic is trusted.",
    )
    branches, caption = _stages(study, BRANCHES), "Each with the same sets; bars are 95 % intervals."
    yield saved(branches, folder / "branches.png", "A corrupted set, and what repairs it", caption)
    yield saved(
        _intact(study),
        folder / "intact.png",
        "An intact set, before and after phase 5",
        "One point per robot and world. Above the line there is more of it after phase 5 than before.",
    )


def _stages(study: PhasesStudy, names: Sequence[Step]) -> Figure:
    """Return success and collisions of each stage, a color for each world."""
    figure = Figure(figsize=(11.0, 1.6 + 0.55 * len(names)), layout="constrained")
    success, collisions = figure.subplots(1, 2, sharey=True)
    places = np.arange(len(names))[::-1]
    # Not every stage is examined in every world: a world has its own colour and place all the same.
    exams = exams_of(*(study.stages[name] for name in names))
    every, most = list(dict.fromkeys(each.world for each in exams)), 1.0
    for each in exams:
        number, robots, rate = every.index(each.world), len(each.rows), collisions_in_10_min(each.rows)
        at = places[names.index(each.of)] + 0.14 * ((len(every) - 1) / 2 - number)
        colour = _WORLD_COLOURS[number % len(_WORLD_COLOURS)]
        label = f"world {label_of(each.world)}" if each.of == names[0] else None
        _bar(success, at, each.passed / robots, wilson_interval(each.passed, robots), colour, label)
        _bar(collisions, at, rate.value, (rate.low, rate.high), colour, None)
        most = max(most, rate.value)
    success.set_yticks(places, [name.label for name in names])
    success.set_xlim(-0.03, 1.03)
    success.set_xlabel("share of the robots that succeed")
    collisions.set_xlabel("collisions in 10 min")
    collisions.set_xlim(-0.03 * most, 1.5 * most)
    for axes in (success, collisions):
        axes.grid(alpha=0.25)
    figure.legend(loc="outside lower center", ncols=5, fontsize="small", frameon=False)
    return figure


def _bar(axes: Axes, at: float, value: float, span: tuple[float, float], colour: str, label: str | None) -> None:
    axes.plot(span, [at, at], color=colour, linewidth=1.5, alpha=0.6)
    axes.plot([value], [at], "o", color=colour, markersize=6, label=label)


def _load(study: PhasesStudy) -> Figure:
    """Curves of all kinds of what he says, with the borders between phases."""
    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    axes = figure.subplots()
    begins = 0.0
    highest = 1.0
    for name in _TEACHING:
        taught = study.taught(name)
        minutes = len(taught[0].workload)
        lasts = taught[0].teaching_s / 60.0
        ends = np.minimum(np.arange(1, minutes + 1), lasts)
        width = np.diff(ends, prepend=0.0)
        for kind in SAID:
            said = np.mean([[getattr(minute, kind) for minute in each.workload] for each in taught], axis=0) / width
            highest = max(highest, float(said.max()))
            axes.stairs(
                said,
                begins + np.concatenate(([0.0], ends)),
                color=_LOAD_COLOURS[kind],
                linewidth=1.8,
                label=kind.replace("lessons", "answers") if name == _TEACHING[0] else None,
            )
        title = "phases 1 and 2" if name == Step.PHASE_2 else name.label.split(",")[0]
        axes.annotate(title, (begins + lasts / 2, 1.0), xycoords=("data", "axes fraction"), ha="center", va="bottom")
        begins += lasts
        axes.axvline(begins, color="#999999", linewidth=0.8)
    axes.set_xlim(0.0, begins)
    axes.set_ylim(0.0, 1.05 * highest)
    axes.set_xlabel("robot time, min")
    axes.set_ylabel("said in a minute")
    axes.grid(alpha=0.25)
    figure.legend(loc="outside lower center", ncols=4, fontsize="small", frameon=False)
    return figure


def _agreement(study: PhasesStudy) -> Figure:
    """Median and quartiles against time, with the bound of trust."""
    figure = Figure(figsize=(7.5, 4.4), layout="constrained")
    axes = figure.subplots()
    curves = [each.agreement for each in study.taught(Step.PHASE_4)]
    shares = np.array([[np.nan if share is None else share for share in curve] for curve in curves], dtype=np.float64)
    times = _AGREEMENT_EVERY_MIN * np.arange(1, shares.shape[1] + 1)
    heard = ~np.isnan(shares).all(axis=0)
    if heard.any():
        low, median, high = np.nanpercentile(shares[:, heard], (25, 50, 75), axis=0)
        axes.fill_between(times[heard], low, high, alpha=0.2, color="#1f6fb2", linewidth=0)
        axes.plot(times[heard], median, color="#1f6fb2", linewidth=1.8, label="agreement")
    bound = load_critic(study.plan.about.task.critic).agreement.bound
    axes.axhline(bound, color="#d1495b", linestyle="--", label=f"trusted from {bound:g}")
    axes.set_ylim(0.0, 1.0)
    axes.set_xlabel("phase 4, min")
    axes.set_ylabel("agreement")
    axes.grid(alpha=0.25)
    axes.legend(loc="lower right", fontsize="small", frameon=False)
    return figure


def _intact(study: PhasesStudy) -> Figure:
    """Each robot before and after, by each measure but success."""
    pairs = paired(study.stages[Step.PHASE_2], study.stages[Step.INTACT])
    worlds = list(dict.fromkeys(each.world for each in pairs))
    shown = [measure for measure in MEASURES[1:] if any(each.measure == measure for each in pairs)]
    figure = Figure(figsize=(3.6 * len(shown), 4.2), layout="constrained")
    panels = figure.subplots(1, len(shown), squeeze=False)[0]
    for axes, measure in zip(panels, shown, strict=True):
        for each in pairs:
            if each.measure == measure:
                number = worlds.index(each.world)
                colour = mpl.colors.to_rgba(_WORLD_COLOURS[number % len(_WORLD_COLOURS)], 0.6)
                label = f"world {label_of(each.world)}" if measure is shown[0] else None
                axes.plot(*np.array(each.values, dtype=np.float64).T, "o", color=colour, markersize=5, label=label)
        low, high = (bound(*axes.get_xlim(), *axes.get_ylim()) for bound in (min, max))
        axes.plot([low, high], [low, high], color="#999999", linewidth=0.8, zorder=0)
        axes.set_title(measure.name, fontsize="medium")
        axes.set_xlabel("before")
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("after")
    figure.legend(loc="outside lower center", ncols=5, fontsize="small", frameon=False)
    return figure
