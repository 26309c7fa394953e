"""Golden files of the texts that users read: `tests/golden/<surface>_texts.txt`, one file per surface.

The sentences of the tables in `SURFACES` stand in these files; tests elsewhere assert the codes, numbers and types of
these texts. Texts without a table, such as most errors of settings files and help texts, are still asserted in the
tests of their modules. `python -m tests.golden_texts` rewrites the files from the text tables; review the diff and
commit it with the change.

To add a table of texts:

1. Write `tests/texts/<table>.py` with a function without arguments per surface. It yields `(label, text)` for every
   code of the table, with sample fields. The label begins with the code and names what the sample varies, if anything.
   Iterate over the StrEnum and index a dict of samples by it, so that a code without a sample fails.
2. Add one line to each surface in `SURFACES` that shows this table.
3. Run `python -m tests.golden_texts`.
"""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from tests.texts import (
    commission,
    doctor,
    health,
    knowledge,
    no_answer,
    outcomes,
    page,
    robot,
    robot_bus,
    settings,
    shutdown,
    sim_console,
    standing,
    startup,
    studies,
    units,
    why,
    wire,
)

COMMAND = "python -m tests.golden_texts"
FOLDER = Path(__file__).parent / "golden"

Listing = Callable[[], Iterable[tuple[str, str]]]

SURFACES: Mapping[str, Mapping[str, Listing]] = {
    "page": {
        "outcomes of commands": outcomes.on_page,
        "standing": standing.on_page,
        "stops": standing.stops,
        "troubles": health.troubles,
        "notices of the page's server": page.notices,
        "sentences of the page": page.sentences,
    },
    "terminal": {
        "outcomes of commands": outcomes.in_terminal,
        "standing": standing.in_terminal,
        "stops": standing.stops,
        "troubles": health.troubles,
    },
    "reports": {
        "errors of a unit": units.errors,
        "errors of a status": units.status_errors,
        "health report": health.reports,
        "malformed requests": wire.refusals,
        "faults of a commissioning": commission.faults,
        "skipped steps of a commissioning": commission.skips,
        "errors of knowledge": knowledge.knowledge_errors,
        "differences of features": knowledge.differences,
        "findings of the doctor": doctor.findings,
        "summary of the doctor": doctor.summaries,
        "errors of settings": settings.errors,
        "reasons of a decision": why.reasons,
        "actions without a stop": why.own_actions,
        "sentences about a decision": why.sentences,
        "summaries of a run": why.summaries,
    },
    "robot": {"questions": robot.questions, "goals": robot.goals, "lessons": robot.lessons, "features": robot.features},
    "studies": {
        "targets": studies.targets,
        "results": studies.results,
        "reasons against judging": studies.reasons,
        "exams": studies.exams,
        "controls without effect": studies.controls,
    },
    "log": {
        "outcomes of commands": outcomes.in_log,
        "events that do not fit": outcomes.event_faults,
        "missing answers": no_answer.texts,
        "standing": standing.in_log,
        "stops": standing.stops,
        "troubles": health.troubles,
        "troubles of robot and bus": robot_bus.troubles,
        "a bus that cannot be opened": robot_bus.opening,
        "shutdown": shutdown.stages,
        "answers of kurt2rt sim": sim_console.answers,
        "news of kurt2rt sim": sim_console.news,
        "start": startup.lines,
    },
}
"""Listings by surface and title of their section."""


def golden_file(surface: str) -> Path:
    """Return the path of a surface's golden file."""
    return FOLDER / f"{surface}_texts.txt"


def texts(surface: str) -> str:
    """Return the content that a surface's golden file has to have.

    Raises:
        ValueError: a table lists a label twice.
    """
    lines = [f"Texts of the surface: {surface}. Written by `{COMMAND}`; do not edit."]
    for title, listing in SURFACES[surface].items():
        pairs = list(listing())
        labels = [label for label, _ in pairs]
        if len(set(labels)) != len(labels):
            raise ValueError(f"{surface}, {title}: a label stands twice (got {labels}); name what each sample varies")
        lines += ["", f"== {title}", *(f"{label}: {text}".rstrip() for label, text in pairs)]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name in SURFACES:
        golden_file(name).write_text(texts(name), encoding="utf-8")
