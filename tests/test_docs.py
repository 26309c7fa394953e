"""README and documentation hold: commands run, examples load, links lead somewhere."""

import ast
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import pytest
import yaml

from behaviors.repertoire_settings import RepertoireSettings
from config import CONFIG_DIR
from config.settings import Settings, load_settings
from hal.robot_settings import RobotSettings
from kurt2rt.core.perception.definition import SituationDefinition
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.search.settings import SearchSettings
from kurt2rt.gym.registration import ENVIRONMENTS
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.service.settings import ServiceSettings
from simbridge.worlds.world_settings import WorldSettings
from tests.cli.helpers import CommandLine, started
from tests.experiments.helpers import examined, short_task, teach
from tests.plugin_packages import install
from tests.runs.replay.stored_runs import STORED
from tests.runs.replay.stories import slim

ROOT = Path(__file__).parents[1]
ROOMS = ("config", "hal", "behaviors", "simbridge", "kurt2rt", "tests")
SOURCES = (".py", ".yaml", ".dbc", ".js")
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])

SCHEMAS: dict[str, type[Settings]] = {
    "repertoire": RepertoireSettings,
    "robot": RobotSettings,
    "runtime": ServiceSettings,
    "search": SearchSettings,
    "situation": SituationDefinition,
    "task": TaskSettings,
    "world": WorldSettings,
}

Shorten = Callable[[Sequence[str]], list[str]]

SHORT_DOUBT = ("--seeds", "915", "--world", "a", "--seconds", "2", "--task", "short.yaml")
# Seconds to minutes, or without end, as they stand in the text: run whole, but small, in the deep suite.
LONG: dict[str, Shorten] = {
    "demo": lambda words: [*words, "--task", "short.yaml"],
    "study doubt": lambda words: [*words[:3], *SHORT_DOUBT],
    "study certify": lambda words: [*words[:3], "--runs", "3", "--seconds", "1", "--pictures", "1"],
    "exam": lambda words: [*words, "--task", "short.yaml"],
    "train": lambda words: shortened_lesson(words),
    "study paper": lambda words: [*words, "--seeds", "100"],
    "study phases": lambda words: [*words, "--seeds", "0"],
    "run": lambda words: shortened_run(words),
    "sim": lambda words: [*words, "--seconds", "1"],
    "doctor": lambda words: [*words, "--ticks", "5"],
}


SHORT_LESSON = (
    *("--set", "teaching.supervised_s=2", "--set", "teaching.corrections_s=1"),
    *("--set", "exam.duration_s=1"),
)
POOR_TERMINAL = {"PYTHONIOENCODING": "ascii", "COLUMNS": "0"}


def shortened_run(words: Sequence[str]) -> list[str]:
    # Its recording would be the newest, and too short for the moments that later commands name.
    unrecorded = [] if {"--record", "--no-record"} & set(words) else ["--no-record"]
    return [*words, "--seconds", "2", "--port", "0", "--page-port", "0", *unrecorded]


def shortened_lesson(words: Sequence[str]) -> list[str]:
    if {"route", "errands"} & set(words):
        starts = ("--set", "metric.starts=1") if "route" in words else ()
        return [*words, *SHORT_LESSON, *starts]
    return [*({"100-119": "100,101", "915-919": "915"}.get(word, word) for word in words), "--task", "short.yaml"]


SOONER = 5
"""Divisor of the replayed seconds; the deep suite replays all of them."""
TAUGHT_BY_THE_DEMO = "results/demo/wall_following-1.knowledge"


class Block(NamedTuple):
    """A fenced block of a document."""

    document: str
    line: int
    kind: str
    text: str


def blocks(kind: str) -> Iterator[Block]:
    for path in DOCUMENTS:
        text = path.read_text(encoding="utf-8")
        for fenced in re.finditer(r"^```(\w+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
            if fenced[1] == kind:
                line = text.count("\n", 0, fenced.start()) + 1
                yield Block(str(path.relative_to(ROOT)), line, kind, fenced[2])


class Story(NamedTuple):
    """The commands of one console block, in order; what an earlier block said already is left out."""

    where: str
    commands: tuple[tuple[str, ...], ...]


def stories() -> list[Story]:
    told: set[str] = set()
    found = []
    for block in blocks("console"):
        lines = [line for line in block.text.splitlines() if line.startswith("$ kurt2rt ") and line not in told]
        told.update(lines)
        found.append(Story(where(block), tuple(tuple(shlex.split(line, comments=True)[2:]) for line in lines)))
    return [story for story in found if story.commands]


def command_of(words: Sequence[str]) -> str:
    """Return the name of a command, with its word within `study`."""
    return " ".join(words[: 2 if words and words[0] == "study" else 1])


def is_long(words: Sequence[str]) -> bool:
    if command_of(words) not in LONG or "--help" in words:
        return False
    return words[0] != "run" or "--seconds" not in words


def where(block: Block) -> str:
    return f"{block.document}:{block.line}"


def told_where(story: Story) -> str:
    return story.where


@pytest.fixture(scope="session")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return teach(tmp_path_factory.mktemp("demo") / "knowledge", short_task(3.0, 2.0)).knowledge


@pytest.fixture(scope="session")
def a_short_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    slim(STORED / "walls.mcap", segment := tmp_path_factory.mktemp("run") / "0001.mcap", 44.0 / SOONER)
    return segment


def sooner(words: Sequence[str]) -> list[str]:
    """Return the command with its times divided by SOONER."""
    times = ("--at", "--from", "--to", "--seconds")
    pairs = zip(("", *words), words, strict=False)
    return [str(float(word) / SOONER) if option in times else word for option, word in pairs]


@pytest.fixture
def folder(plugin_folder: Path, taught: Path) -> Path:
    """Return a reader's folder: a short task, the files of the demo, and a recorded run."""
    tmp_path = plugin_folder
    (tmp_path / TAUGHT_BY_THE_DEMO).parent.mkdir(parents=True)
    shutil.copy(taught, tmp_path / TAUGHT_BY_THE_DEMO)
    task = yaml.safe_load((CONFIG_DIR / "tasks" / "wall_following.yaml").read_text(encoding="utf-8"))
    task["teaching"].update(supervised_s=5.0, corrections_s=3.0)
    task["exam"].update(duration_s=5.0)
    (tmp_path / "short.yaml").write_text(yaml.safe_dump(task), encoding="utf-8")
    record(tmp_path, STORED / "walls.mcap")
    for name, text in changed_copies():
        (tmp_path / name).write_text(text, encoding="utf-8")
    write_printed_files(tmp_path)
    return tmp_path


def changed_copies() -> Iterator[tuple[str, str]]:
    """Yield name and text of each changed copy in a diff block. Each of its changes must apply to one place."""
    for block in blocks("diff"):
        names = re.match(r"--- (\S+)\n\+\+\+ (\S+)\n", block.text)
        assert names, f"{where(block)}: begin it with --- FILE and +++ COPY"
        text = (ROOT / names[1]).read_text(encoding="utf-8")
        for hunk in block.text[names.end() :].split("@@\n"):
            lines = hunk.splitlines(keepends=True)
            was = "".join(line[1:] for line in lines if line[0] in " -")
            assert text.count("\n" + was) == 1, f"{where(block)}: {names[1]} has not exactly one place of:\n{was}"
            text = text.replace("\n" + was, "\n" + "".join(line[1:] for line in lines if line[0] in " +"))
        yield names[2], text


def write_printed_files(folder: Path) -> None:
    """Write each module and settings file of a reader's own that begins with its file name."""
    for block in (*blocks("python"), *blocks("yaml")):
        if named := re.match(r"# (my_\w+)(\.py|\.yaml)\b", block.text):
            (folder / f"{named[1]}{named[2]}").write_text(block.text, encoding="utf-8")
            sys.modules.pop(named[1], None)  # of another test's folder


def record(folder: Path, segment: Path) -> None:
    """There is this recorded run."""
    recorded = folder / "var/runs/20261122T031005Z-wall_following/0001.mcap"
    recorded.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(segment, recorded)


def run(words: Sequence[str], folder: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "kurt2rt.cli.main", *words],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **POOR_TERMINAL},
    )
    assert done.stdout.strip(), f"kurt2rt {shlex.join(words)}: prints nothing"
    assert done.returncode == 0, f"kurt2rt {shlex.join(words)}: exit code {done.returncode}\n{done.stderr}"


def test_the_readme_says_what_to_type() -> None:
    assert any(story.where.startswith("README.md") for story in stories())


@pytest.mark.parametrize("story", [each for each in stories() if not all(map(is_long, each.commands))], ids=told_where)
def test_the_commands_of_the_documentation_run(
    story: Story, folder: Path, a_short_run: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    record(folder, a_short_run)
    monkeypatch.chdir(folder)
    kurt2rt = CommandLine(monkeypatch, capfd)
    for words in story.commands:
        if is_long(words):
            continue
        said = kurt2rt(*sooner(words))
        assert said.exit_code == 0, f"kurt2rt {shlex.join(words)}: {said.err}"


def test_long_documented_commands_are_run_and_not_only_explained() -> None:
    shortened = [LONG[command_of(words)](words) for story in stories() for words in story.commands if is_long(words)]
    assert [words for words in shortened if "--help" in words or command_of(words) not in LONG] == []


@pytest.mark.deep
@pytest.mark.parametrize("story", stories(), ids=told_where)
def test_long_documented_commands_run_with_smaller_numbers(story: Story, folder: Path) -> None:
    for words in story.commands:
        run(LONG[command_of(words)](words) if is_long(words) else words, folder)


def section(document: str, title: str) -> str:
    """Return the text below a heading of the second level in a page of docs/."""
    _, _, rest = (ROOT / "docs" / document).read_text(encoding="utf-8").partition(f"\n## {title}\n")
    assert rest, f"{document}: no section {title}"
    return rest.partition("\n## ")[0]


@pytest.fixture
def kurt2rt(folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> CommandLine:
    """Return the command line in the reader's folder."""
    monkeypatch.chdir(folder)
    return CommandLine(monkeypatch, capfd)


def test_added_sensor_on_a_current_channel_or_unknown_is_refused(kurt2rt: CommandLine) -> None:
    on_current, unknown, *_ = re.findall(r"^kurt2rt: (.+)$", section("extend.md", "A distance sensor"), re.MULTILINE)
    robot = Path("my_robot.yaml")
    robot.write_text(robot.read_text(encoding="utf-8").replace("ADC10", "ADC12"), encoding="utf-8")
    assert kurt2rt.refused("demo", "--robot-settings", "my_robot.yaml") == f"kurt2rt: {on_current}"
    assert kurt2rt.refused("demo", "--set", "situation=my_situation.yaml") == f"kurt2rt: {unknown}"


def test_added_sensor_refuses_old_knowledge_as_printed(kurt2rt: CommandLine) -> None:
    text = section("extend.md", "A distance sensor")
    refused = re.findall(r"^\$ kurt2rt (exam .+)\nkurt2rt: (.+)$", text, re.MULTILINE)
    assert len(refused) == 2
    for command, message in refused:
        assert kurt2rt.refused(*shlex.split(command)) == f"kurt2rt: {message}"


def test_added_sensor_is_a_feature_of_the_taught_run(kurt2rt: CommandLine) -> None:
    (words,) = {words for story in stories() for words in story.commands if "my_runtime.yaml" in words}
    assert words[-1] == "--page"
    said = kurt2rt(*words[:-1], "--teacher", "none", "--seconds", "0.3", "--port", "0")
    assert said.exit_code == 0, said.err
    with Journal.read_only(Path("var/s19.knowledge")) as journal:
        assert journal.binding.feature_names[18] == "s19"
        assert len(journal.binding.feature_names) == 74


def test_printed_tests_of_plug_ins_pass(folder: Path) -> None:
    text = (ROOT / "docs/extend.md").read_text(encoding="utf-8")
    files = re.findall(r"^\$ pytest (my_\w+\.py)$", text, re.MULTILINE)
    assert len(files) == 2
    with started("pytest", "-q", "-p", "no:cacheprovider", *files, folder=folder) as tests:
        said = tests.communicate()[0]
    assert tests.returncode == 0, said


def test_printed_learner_is_short_and_stands_in_the_table(kurt2rt: CommandLine) -> None:
    assert len(Path("my_learner.py").read_text(encoding="utf-8").splitlines()) <= 40
    line = "study compare --learner my_learner:Nearest --seeds 3901 --checkpoint 2 --jobs 1 --task short.yaml"
    said = kurt2rt(*line.split(), "--set", "exam.worlds=[a]", "--json")
    assert said.exit_code == 0, said.err
    success, *_ = json.loads(said.out)["tables"]
    assert [row[1] for row in success["rows"]] == ["RLA, as shipped", "my_learner:Nearest"]


def test_added_policy_is_refused_and_taught_as_printed(kurt2rt: CommandLine) -> None:
    text = section("extend.md", "A task and its policy")
    ((command, output),) = re.findall(r"^\$ kurt2rt (.+)\n(kurt2rt: .+\n)", text, re.MULTILINE)
    assert kurt2rt(*shlex.split(command)).err.replace(str(Path.cwd()), "FOLDER") == output
    short = ("teaching.supervised_s=3", "teaching.corrections_s=0", "exam.duration_s=2", "exam.worlds=[a]")
    said = kurt2rt("demo", "--task", "my_task.yaml", *(word for each in short for word in ("--set", each)))
    assert said.exit_code in (0, 1), said.err
    assert Path("results/demo/wandering-1.knowledge").is_file()


def test_robot_of_the_docs_is_made_and_taught(kurt2rt: CommandLine, plugin_folder: Path) -> None:
    text = section("other-robots.md", "Ten minutes to a robot that learns")
    made, installed, checked, taught = re.findall(r"^\$ (.+)$", text, re.MULTILINE)[:4]
    steps = f"next:\n  {installed}\n  {checked}\n  {taught.removesuffix(' --seed 620')}\n"
    assert kurt2rt(*shlex.split(made)[1:]).out.endswith(steps)
    assert installed == "pip install -e rover"
    project = tomllib.loads(Path("rover/pyproject.toml").read_text(encoding="utf-8"))["project"]
    install(plugin_folder / "rover" / "src", "rover", {"robots": project["entry-points"]["kurt2rt.robots"]})
    short = ("teaching.supervised_s=5", "teaching.corrections_s=0", "exam.duration_s=2", "exam.worlds=[a]")
    said = kurt2rt(*shlex.split(taught)[1:], *(word for each in short for word in ("--set", each)))
    assert said.exit_code in (0, 1), said.err
    assert Path("results/demo/rover_fleeing-620.knowledge").is_file()
    lines = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in Path("rover/src/rover").glob("*.py"))
    assert lines <= 300


@pytest.mark.deep
def test_the_demo_runs_as_it_stands(tmp_path: Path) -> None:
    run(["demo"], tmp_path)
    assert (tmp_path / TAUGHT_BY_THE_DEMO).is_file()
    assert (tmp_path / TAUGHT_BY_THE_DEMO).with_suffix(".png").is_file()


def shortened_example(text: str) -> str:
    """Return an example with its long loops and times divided by SOONER."""
    return re.sub(r"(\brange\(|\bseconds=)(\d\d+)", lambda found: f"{found[1]}{int(found[2]) // SOONER}", text)


def test_examples_in_python_run(tmp_path: Path) -> None:
    texts = {block.text: where(block) for block in blocks("python")}
    for text, place in texts.items():
        if re.match(r"# \S+\.py\n", text):
            continue  # a module, which other tests import
        (tmp_path / "example.py").write_text(shortened_example(text), encoding="utf-8")
        with started("example", folder=tmp_path) as example:
            complaints = example.communicate()[1]
        assert example.returncode == 0, f"{place}: {complaints}"


@pytest.fixture
def printed_files(plugin_folder: Path) -> None:
    """Write the printed files to the current folder, where a reader would put them."""
    write_printed_files(plugin_folder)


def printed_task(name: str, folder: Path, **shorter: Mapping[str, object]) -> Path:
    """Write a printed task, or a changed copy of a shipped one; `shorter` gives keys of its sections another value."""
    path = folder / name
    content = yaml.safe_load(dict(changed_copies()).get(name) or path.read_text(encoding="utf-8"))
    for section, values in shorter.items():
        content[section].update(values)
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path


PRINTED_TASKS = ("slow_answers.yaml", "my_task.yaml")


@pytest.mark.usefixtures("printed_files")
@pytest.mark.parametrize("name", PRINTED_TASKS)
def test_printed_task_after_a_short_lesson_succeeds(name: str, tmp_path: Path) -> None:
    world = yaml.safe_load(printed_task(name, tmp_path).read_text(encoding="utf-8"))["teaching"]["world"]
    shorter = {"supervised_s": 5.0, "corrections_s": 25.0, "reposition_every_s": 0.0}
    exam: dict[str, object] = {"worlds": [world], "duration_s": 8.0}
    task = load_task(str(printed_task(name, tmp_path, teaching=shorter, exam=exam)))
    taught = teach(tmp_path / "knowledge", task)
    (result,) = examined(task, taught.events, (world,))
    assert result.progress > 0.0
    assert result.passed, result


@pytest.mark.deep
@pytest.mark.usefixtures("printed_files")
@pytest.mark.parametrize("name", PRINTED_TASKS)
def test_printed_task_on_the_default_seed_succeeds(name: str, tmp_path: Path) -> None:
    task = load_task(str(printed_task(name, tmp_path)))
    assert [exam.passed for exam in demonstrated(task, 1, tmp_path)] == [True, True, True]


@pytest.mark.deep
def test_printed_streets_on_the_printed_seed_succeed(tmp_path: Path) -> None:
    (words,) = {line for line in printed_demos() if "streets" in line}
    task = taught_by_named(load_task("streets"), "ordinary")
    assert [exam.passed for exam in demonstrated(task, seed_of(words), tmp_path)] == [True]


def test_printed_demos_of_streets_name_one_seed() -> None:
    # Other seeds may get stuck there: docs/results.md#taught-by-an-ordinary-person
    assert {seed_of(line) for line in printed_demos() if "streets" in line} == {2}


def printed_demos() -> set[str]:
    """Return every `kurt2rt demo ...` of the documents as it stands there, without its output folder."""
    texts = (path.read_text(encoding="utf-8") for path in DOCUMENTS)
    lines = (line for text in texts for line in re.findall(r"^(?:\$ )?kurt2rt (demo .*)$", text, re.MULTILINE))
    return {line.partition(" --out")[0] for line in lines}


def seed_of(line: str) -> int:
    """Return the seed of a printed command; 1 if it names none."""
    words = shlex.split(line)
    return int(words[words.index("--seed") + 1]) if "--seed" in words else 1


def demonstrated(task: TaskSettings, seed: int, folder: Path) -> tuple[DriveRow, ...]:
    """Teach and examine as `kurt2rt demo` does."""
    return examined(task, teach(folder / "knowledge", task, seed).events, task.exam.worlds, seed)


@pytest.mark.usefixtures("printed_files")
@pytest.mark.parametrize("block", list(blocks("yaml")), ids=where)
def test_an_example_of_settings_loads(block: Block, tmp_path: Path) -> None:
    named = re.match(
        r"# (?:config/(\w+)s/|my_)(\w+)\.yaml\b", block.text.replace("config/runtime/", "config/runtimes/")
    )
    assert named, f"{where(block)}: begin it with a comment that names its file: config/tasks/NAME.yaml or my_task.yaml"
    path = tmp_path / "example.yaml"
    path.write_text(block.text, encoding="utf-8")
    load_settings(path, SCHEMAS[named[1] or named[2]])


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_links_and_paths_lead_to_files(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    links = [link.partition("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", text) if "://" not in link]
    missing = [link for link in links if link and not (path.parent / link).exists()]
    folders = "|".join((*ROOMS, "docs"))
    named = re.findall(rf"`((?:{folders})/[\w./-]*)`", text)
    missing += [name for name in named if not (ROOT / name).exists() and name not in ENVIRONMENTS]
    assert not missing, f"{path.name} names what is not there: {', '.join(missing)}"


def headings(path: Path) -> set[str]:
    """Return the anchors of a document: its headings as GitHub names them."""
    text = re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-") for title in titles}


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_a_link_to_a_heading_finds_it(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    missing = []
    for link in re.findall(r"\]\(([^)\s]*#[^)\s]+)\)", text):
        name, _, anchor = link.partition("#")
        if "://" not in link and anchor not in headings(path.parent / name if name else path):
            missing.append(link)
    assert not missing, f"{path.name} links to headings that are not there: {', '.join(missing)}"


def test_pointers_of_code_to_documents_find_their_heading() -> None:
    files = [path for room in ROOMS for path in (ROOT / room).rglob("*") if path.suffix in SOURCES]
    missing = []
    for path in files:
        for name, anchor in re.findall(r"\bdocs/([\w-]+\.\w+)(?:#([\w-]+))?", path.read_text(encoding="utf-8")):
            document = ROOT / "docs" / name
            if not document.exists() or (anchor and anchor not in headings(document)):
                missing.append(f"{path.relative_to(ROOT)}: docs/{name}#{anchor}")
    assert not missing


_GLOSSARY_TEXT = (ROOT / "docs/glossary.md").read_text(encoding="utf-8")
GLOSSARY = re.findall(r"^\| .* \| \[`(\w+)`\]\(\.\./(.+)\) \|$", _GLOSSARY_TEXT, re.MULTILINE)


@pytest.mark.parametrize(("name", "module"), GLOSSARY)
def test_name_of_glossary_is_defined_in_its_module(name: str, module: str) -> None:
    body = ast.parse((ROOT / module).read_text(encoding="utf-8")).body
    defined = {node.name for node in body if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)}
    assert name in defined | {ast.unparse(node.targets[0]) for node in body if isinstance(node, ast.Assign)}


def links_of(document: Path) -> set[Path]:
    links = re.findall(r"\]\(([^)\s#]+)", document.read_text(encoding="utf-8"))
    return {(document.parent / link).resolve() for link in links if "://" not in link}


def test_each_document_is_two_clicks_from_the_readme() -> None:
    first = links_of(ROOT / "README.md")
    near = first | set().union(*(links_of(path) for path in first if path.suffix == ".md"))
    assert {*DOCUMENTS, ROOT / "CITATION.cff"} <= near | {ROOT / "README.md"}


def test_citation_names_this_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert citation.keys() >= {"cff-version", "message", "title", "authors"}
    assert citation["version"] == project["version"]
    assert all(reference.keys() >= {"type", "title", "authors"} for reference in citation["references"])


def test_ten_minutes_are_short_enough() -> None:
    # At 100 words a minute, for it is done as it is read.
    words = (ROOT / "docs/teach-in-ten-minutes.md").read_text(encoding="utf-8").split()
    assert len(words) <= 700
