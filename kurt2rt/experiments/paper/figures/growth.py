"""Fig. 2: number of RLAs against teaching time, for several R."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from kurt2rt.core.task_settings import PaperResult
from kurt2rt.experiments.paper.study import GrowthStudy
from kurt2rt.experiments.study.figure_style import save

_TITLES = {"shipped": "With the shipped settings", "plain": "Plain reading of the paper"}


def draw_growth(studies: Sequence[GrowthStudy], paper: PaperResult, path: Path) -> None:
    """One panel per reading: medians as lines, quartiles as bands, and the point that the paper's text gives."""
    figure = Figure(figsize=(5.6 * len(studies), 4.8), layout="constrained")
    panels = figure.subplots(1, len(studies), squeeze=False, sharey=True)[0]
    for axes, study in zip(panels, studies, strict=True):
        radii = study.radii
        colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, len(radii)))
        for radius, colour in zip(radii, colours, strict=True):
            curves = study.curves(radius)
            last_s = min(map(len, curves))
            low, median, high = np.percentile([curve[:last_s] for curve in curves], (25, 50, 75), axis=0)
            time_s = np.arange(1, last_s + 1)
            axes.fill_between(time_s, low, high, color=colour, alpha=0.2, linewidth=0)
            axes.plot(time_s, median, color=colour, linewidth=1.8, label=f"R = {radius:g}")
        if paper.teaching_s:
            label = f"the paper's text: {paper.rlas} RLAs, {paper.teaching_s:g} s"
            axes.plot([paper.teaching_s], [paper.rlas], "k*", markersize=12, linestyle="none", label=label)
        axes.set_title(_TITLES[study.reading])
        axes.set_xlabel("teaching in phase 1, s of robot time")
        axes.set_xlim(left=0)
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("RLAs")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize="small", frameon=False)
    save(figure, path)
