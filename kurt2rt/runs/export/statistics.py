"""Statistics of the columns of a data set, by which LeRobot normalises them."""

from collections.abc import Sequence

import numpy as np

from kurt2rt.runs.export.episodes import Column

Statistics = dict[str, dict[str, Column]]
"""Statistics by feature and name, each (length,); count (1,)."""
_QUANTILES = (0.01, 0.1, 0.5, 0.9, 0.99)


def statistics_of(values: Column) -> dict[str, Column]:
    """Return least, largest, mean, deviation and quantiles of a column, each (length,), and count (1,)."""
    wide = values.reshape(len(values), -1)
    # One value at a time: in float64, an hour of all of them takes as much memory as the rest of the export.
    quantiles = np.stack([np.quantile(each.astype(np.float64), _QUANTILES) for each in wide.T], axis=1)
    return {
        "min": wide.min(axis=0).astype(np.float64),
        "max": wide.max(axis=0).astype(np.float64),
        "mean": wide.mean(axis=0, dtype=np.float64),
        "std": np.array([each.std(dtype=np.float64) for each in wide.T]),
        "count": np.array([len(wide)]),
        **{f"q{round(100 * share):02d}": each for share, each in zip(_QUANTILES, quantiles, strict=True)},
    }


def merge_statistics(of_episodes: Sequence[Statistics]) -> Statistics:
    """Return the statistics of all episodes together; quantiles are means weighted by count, as LeRobot's are."""
    merged = {}
    for name in of_episodes[0]:
        stacked = {key: np.stack([each[name][key] for each in of_episodes]) for key in of_episodes[0][name]}
        counts = stacked["count"]
        total = counts.sum(axis=0)
        means = {key: (each * counts).sum(axis=0) / total for key, each in stacked.items()}
        variance = ((stacked["std"] ** 2 + (stacked["mean"] - means["mean"]) ** 2) * counts).sum(axis=0) / total
        merged[name] = means | {
            "min": stacked["min"].min(axis=0),
            "max": stacked["max"].max(axis=0),
            "std": np.sqrt(variance),
            "count": total,
        }
    return merged
