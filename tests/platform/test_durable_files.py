"""Files that survive a power cut: content and folder entry are synced."""

from pathlib import Path

import pytest

from kurt2rt.platform import durable_files


@pytest.fixture
def synced(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Folders whose names were made durable, in order."""
    folders: list[Path] = []
    sound = durable_files.fsync_folder

    def fsync_folder(folder: Path) -> None:
        sound(folder)
        folders.append(folder)

    monkeypatch.setattr(durable_files, "fsync_folder", fsync_folder)
    return folders


def test_all_folders_that_were_made_are_durable(tmp_path: Path, synced: list[Path]) -> None:
    durable_files.make_folder(tmp_path / "var" / "runs")
    assert (tmp_path / "var" / "runs").is_dir()
    assert set(synced) == {tmp_path / "var", tmp_path}
    durable_files.make_folder(tmp_path / "var" / "runs")
    assert len(synced) == 2


def test_a_file_is_there_whole_or_as_it_was(tmp_path: Path, synced: list[Path]) -> None:
    path = tmp_path / "var" / "report.txt"
    durable_files.write_durably(path, "first\n")
    durable_files.write_durably(path, "second\n")
    assert path.read_text(encoding="utf-8") == "second\n"
    assert [each.name for each in path.parent.iterdir()] == ["report.txt"]
    assert synced == [tmp_path, path.parent, path.parent]


def test_folders_that_are_made_are_this_users_alone(tmp_path: Path) -> None:
    (tmp_path / "open").mkdir(mode=0o755)
    made = tmp_path / "open" / "var" / "runs"
    durable_files.make_private_folder(made)
    modes = [each.stat().st_mode & 0o777 for each in (made, made.parent, made.parent.parent)]
    assert modes == [0o700, 0o700, 0o755]
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(FileExistsError):
        durable_files.make_private_folder(tmp_path / "file")
