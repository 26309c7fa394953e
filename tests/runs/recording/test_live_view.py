"""Foxglove looks on at a run while it goes on, and cannot do more than that."""

import asyncio
import json
import socket
from pathlib import Path
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect

from kurt2rt.runs.recording.live_view import LOOPBACK, LiveView, parse_address
from kurt2rt.runs.recording.topics import LOG, SCENE, TICK
from tests.runs.recording.desk_recording import NAME, RecordedDesk
from tests.runs.recording.test_recorder import AbsentDisk, entries_of

SUBPROTOCOL = "foxglove.sdk.v1"
MESSAGE_DATA = 1


def opened_desk(recordings: Path | None = None) -> tuple[RecordedDesk, LiveView]:
    views: list[LiveView] = []
    desk = RecordedDesk(recordings, live=(LOOPBACK, 0), opened=views.append)
    (view,) = views
    return desk, view


async def told(client: ClientConnection, operation: str) -> dict[str, Any]:
    """Return the next JSON message of that operation."""
    async for text in client:
        if isinstance(text, str):
            message: dict[str, Any] = json.loads(text)
            if message["op"] == operation:
                return message
    raise AssertionError(f"closed before {operation}")


async def advertised(client: ClientConnection, *topics: str) -> dict[str, int]:
    """Ids of topics."""
    ids: dict[str, int] = {}
    while not ids.keys() >= set(topics):
        ids |= {each["topic"]: each["id"] for each in (await told(client, "advertise"))["channels"]}
    return ids


async def test_live_view_client_sees_ticks_from_then_on() -> None:
    desk, view = opened_desk()
    async with connect(view.address, subprotocols=[SUBPROTOCOL], close_timeout=0.1) as client:  # type: ignore[list-item]
        hello = await told(client, "serverInfo")
        assert "clientPublish" not in hello["capabilities"]
        assert "parameters" not in hello["capabilities"]
        ids = await advertised(client, TICK, SCENE, LOG)
        subscription = {"id": 7, "channelId": ids[TICK]}
        await client.send(json.dumps({"op": "subscribe", "subscriptions": [subscription]}))
        while True:  # until the subscription has arrived there
            desk.second()
            try:
                async with asyncio.timeout(0.05):
                    data = await client.recv()
            except TimeoutError:
                continue
            if isinstance(data, bytes):
                break
        assert data[0] == MESSAGE_DATA
        tick = json.loads(data[13:])
        assert tick["tick"] in {record.tick for record in desk.records}
        desk.recorder.close()
    assert desk.recorder.trouble == ""
    assert desk.recorder.dropped == 0


def test_it_listens_on_this_machine_alone_unless_told() -> None:
    assert parse_address("8765") == ("127.0.0.1", 8765)
    assert parse_address("0.0.0.0:8765") == ("0.0.0.0", 8765)
    assert parse_address("[::1]:8765") == ("::1", 8765)
    for wrong in ("", "robot", "robot:", ":8765", "8765x", "70000", "-1"):
        with pytest.raises(ValueError, match="HOST:PORT"):
            parse_address(wrong)


def test_a_port_that_is_taken_is_told_and_tried_again(tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind((LOOPBACK, 0))
        taken.listen()
        port = taken.getsockname()[1]
        desk = RecordedDesk(tmp_path, live=(LOOPBACK, port))
        desk.second()
        assert str(port) in desk.recorder.trouble
    desk.second()
    assert desk.recorder.trouble == ""
    desk.recorder.close()
    assert desk.recorder.written == 200


def test_live_view_with_a_late_disk_loses_no_tick(tmp_path: Path) -> None:
    disk = AbsentDisk()
    desk = RecordedDesk(tmp_path, disk=disk, live=(LOOPBACK, 0))
    desk.second()
    disk.there = True
    desk.second()
    desk.second()
    desk.recorder.close()
    assert desk.recorder.trouble == ""
    assert len(entries_of(tmp_path / NAME)) == 300
