"""File of tuned settings: what was found, and where it came from."""

from collections.abc import Sequence
from pathlib import Path

import yaml

from kurt2rt.experiments.rivals.tuned import TunedRival, TunedRivals
from kurt2rt.experiments.study.html_report import spans
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.tuning.settings import TuningSettings
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.platform.durable_files import write_durably


def write_tuned(
    settings: TuningSettings, trials: int, found: Sequence[TunedRival], made_of: Provenance, command: str, path: Path
) -> None:
    """Write the settings of the best trials as YAML to `path`. Raises OSError.

    Args:
        settings: of the tuning.
        trials: number of trials of each rival.
        found: settings of each rival in each task.
        made_of: program and versions that made the trials.
        command: typed words.
        path: of the file, which is replaced.
    """
    content = TunedRivals(
        league=settings.name,
        command=command,
        date=utc_now(),
        source=made_of.source,
        versions=made_of.versions,
        teacher=settings.teacher,
        trials=trials,
        seeds=spans(settings.seeds.seeds),
        rivals=tuple(found),
    ).model_dump(mode="json")
    write_durably(path, yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120))
