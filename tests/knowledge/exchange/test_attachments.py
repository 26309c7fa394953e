"""Attachments of a run: settings as they were in force, and the knowledge at its start."""

import pytest

from config.settings_files import kept_name
from kurt2rt.core.rla.statistics import Expectation, Statistics
from kurt2rt.knowledge.exchange.attachments import decode_statistics, encode_statistics
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_head import RunHead, decode_head, encode_head


@pytest.mark.parametrize(
    "name", ["", ".", "..", "../../secret", "/etc/secret", "~/secret", "a/b", "/etc/secret.yaml", "x/"]
)
def test_kept_name_stays_in_its_folder(name: str) -> None:
    kept = kept_name(name)
    assert "/" not in kept
    assert kept not in (".", "..")
    assert kept_name(name) != kept_name(f"{name}/other")
    assert kept_name("walls") == "walls.yaml"


def test_decode_statistics_are_exact_and_in_order() -> None:
    expectation = Expectation("ann-1", 1, 0.1, b"\x00\xff", b"")
    saved = Statistics({7: 1, 2: 3}, {(7, 2): 1}, {2: 1 / 3, 7: -0.1}, {"best score": 0.3}, {2: expectation})
    again = decode_statistics(encode_statistics(saved))
    assert repr(again) == repr(saved)
    with pytest.raises(ValueError, match="statistics"):
        decode_statistics(b"{}")


def test_decode_head_other_version_is_refused() -> None:
    head = RunHead(
        "0.1", "00ff", "2026-11-22T03:00:00Z", "wall_following", "kurt2", "sim", "", True, True, "", "", {"a": "b"}
    )
    metadata = encode_head(head)
    assert all(isinstance(value, str) for value in metadata.values())
    assert decode_head(metadata) == head
    with pytest.raises(RecordingError, match=r"version 2, this kurt2rt reads version 1; .*\(0\.1\)"):
        decode_head({**metadata, "version": "2"})
    with pytest.raises(RecordingError, match="boot"):
        decode_head({key: value for key, value in metadata.items() if key != "boot"})
