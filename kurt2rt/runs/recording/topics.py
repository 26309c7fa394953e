"""Topics of a recorded run: the project's own and those that Foxglove displays by itself."""

import json
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from foxglove import Channel, Context
from foxglove import channel as sdk_channel
from foxglove.channels import (
    FrameTransformsChannel,
    LaserScanChannel,
    LogChannel,
    PoseInFrameChannel,
    SceneUpdateChannel,
)
from foxglove.messages import Log, LogLevel

from hal.guard_reason import GuardReason
from hal.odometry import PlanePose, WheelOdometry
from hal.robot_settings import RobotSettings
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.rla.rla_system import knowledge_hash_of
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.event_codec import encode_event
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.platform.yield_gil import yield_gil
from kurt2rt.runs.recording.entries import tick_entry
from kurt2rt.runs.recording.foxglove_scene import (
    ROBOT,
    START,
    WORLD,
    RobotScene,
    describe_decision,
    pose_in,
    timestamp,
    transforms,
    world_scene,
)
from kurt2rt.runs.recording.run_folder import TICK_TOPIC
from kurt2rt.runs.recording.tick_json import encode_tick, tick_properties
from simbridge.contracts.simulation import SimulatedPlace, WorldPlan

TICK, LESSON, SITUATION, HEALTH, LOG = TICK_TOPIC, "/lesson", "/situation", "/health", "/log"
SCAN, POSE, TF, TRUTH, SCENE, GROUND = "/scan", "/pose", "/tf", "/truth", "/scene", "/world"

SCANS_HZ, SCENES_HZ = 20, 10
_GROUND_EVERY_S = 5


class TickNote(NamedTuple):
    """Record of a tick that waits for the recorder's thread, with the truth on a simulated robot."""

    record: TickRecord
    time_ns: int
    """Time since 1970."""
    saved: bool
    """True if statistics were saved after the tick."""
    truth: SimulatedPlace | None
    world: WorldPlan | None


class QuestionNote(NamedTuple):
    """Question of the robot that waits for the recorder's thread; its text is `str(question)`."""

    question: object


class HealthNote(NamedTuple):
    """Health report that waits for the recorder's thread, in plain values."""

    report: Mapping[str, Any]


Note = TickNote | QuestionNote | HealthNote | Acknowledgement


_NUMBER, _COUNT, _TEXT = {"type": "number"}, {"type": "integer"}, {"type": "string"}
_EVENT = {
    "type": "object",
    "properties": {
        **dict.fromkeys(("kind", "action", "command_id", "teacher"), _TEXT),
        **dict.fromkeys(("rla_id", "phase", "tick"), _COUNT),
    },
}
_LESSON = {"event": _EVENT, "acknowledged": _TEXT, "sequence": _COUNT, "error": _TEXT, "stamped_at": _TEXT}


def _schema(title: str, properties: Mapping[str, Any]) -> dict[str, Any]:
    """Return the JSON schema of a message; the keys of its properties are its fields."""
    return {"title": f"kurt2rt.{title}", "type": "object", "properties": dict(properties)}


class Topics:
    """Logger of a run's notes to the topics of a context, for a file or a live view, at the newest tick's time."""

    def __init__(self, context: Context, settings: RobotSettings, features: tuple[str, ...], began_ns: int) -> None:
        """`features`: names of the situation's values. `began_ns`: time since 1970 of notes before the first tick."""
        self._features = features
        self._time_ns = began_ns
        self._world: WorldPlan | None = None
        self._pictures = RobotScene(settings)
        self._odometry = WheelOdometry(settings.geometry)
        self._reckoned = PlanePose()
        period_s = settings.cycle_s
        self._scan_ticks = max(1, round(1 / SCANS_HZ / period_s))
        self._scene_ticks = max(1, round(1 / SCENES_HZ / period_s))
        self._ground_ticks = round(_GROUND_EVERY_S / period_s)
        self._next_scan = self._next_scene = self._next_ground = 0
        self._begins: PlanePose | None = None
        self._doing = ""
        self._reasons: tuple[GuardReason, ...] = ()
        self._saving_error: str | None = None
        self._tick = _channel(TICK, _schema("Tick", tick_properties()), context)
        self._lesson = _channel(LESSON, _schema("Lesson", _LESSON), context)
        self._situation = _channel(SITUATION, _schema("Situation", dict.fromkeys(features, _NUMBER)), context)
        self._health = _channel(HEALTH, _schema("Health", {}), context)
        self._scan = LaserScanChannel(SCAN, context=context)
        self._pose = PoseInFrameChannel(POSE, context=context)
        self._tf = FrameTransformsChannel(TF, context=context)
        self._truth = PoseInFrameChannel(TRUTH, context=context)
        self._scene = SceneUpdateChannel(SCENE, context=context)
        self._ground = SceneUpdateChannel(GROUND, context=context)
        self._log = LogChannel(LOG, context=context)

    def log(self, note: Note) -> None:
        """Log one note to its topics. Raises RecordingError or KnowledgeError for a note that cannot be encoded."""
        match note:
            case TickNote():
                self._time_ns = note.time_ns
                self._log_tick(note)
                self._world = note.world or self._world
                if self._world is not None and note.record.tick >= self._next_ground:
                    self._next_ground = note.record.tick + self._ground_ticks
                    self._ground.log(world_scene(self._world, self._time_ns), log_time=self._time_ns)
            case QuestionNote(question):
                self._log_text(str(question), LogLevel.Warning)
            case HealthNote(report):
                self._health.log(_json(report), log_time=self._time_ns)
            case Acknowledgement():
                self._log_acknowledgement(note)

    def repeat_periodic(self) -> None:
        """Repeat the periodic messages at the next tick, for a new receiver."""
        self._next_scan = self._next_scene = self._next_ground = 0

    def _log_tick(self, note: TickNote) -> None:
        record = note.record
        readings = record.readings
        motion = self._odometry.motion(readings.encoder_left_ticks, readings.encoder_right_ticks)
        pose = self._reckoned.moved(motion.forward_m, motion.turn_rad)
        self._reckoned = pose._replace(heading_rad=math.remainder(pose.heading_rad, math.tau))
        if self._tick.has_sinks():  # the most work of all, for which a live view seldom asks
            knowledge = None
            if record.knowledge is not None:
                knowledge = knowledge_hash_of(yield_gil(sorted(record.knowledge, key=lambda rla: rla.rla_id)))
            self._tick.log(
                encode_tick(tick_entry(record, saved=note.saved, knowledge=knowledge)), log_time=self._time_ns
            )
        for event in record.events:
            self._lesson.log(b'{"event":%s}' % encode_event(event).encode(), log_time=self._time_ns)
        self._log_changes(record)
        if note.truth is not None:
            self._log_truth(note.truth)
        if record.tick >= self._next_scan:
            self._next_scan = record.tick + self._scan_ticks
            self._log_pose(record)
        if record.tick >= self._next_scene or record.question_begins:
            self._next_scene = record.tick + self._scene_ticks
            self._log_scene(record)

    def _log_acknowledgement(self, acknowledgement: Acknowledgement) -> None:
        content = {
            "acknowledged": acknowledgement.command_id,
            "sequence": acknowledgement.sequence,
            "error": acknowledgement.error,
            "stamped_at": acknowledgement.stamped_at,
        }
        self._lesson.log(
            _json({key: value for key, value in content.items() if value is not None}), log_time=self._time_ns
        )
        if acknowledgement.error is not None:
            self._log_text(f"not saved: {acknowledgement.command_id}: {acknowledgement.error}", LogLevel.Error)

    def _log_text(self, text: str, level: LogLevel) -> None:
        self._log.log(
            Log(timestamp=timestamp(self._time_ns), level=level, message=text, name="kurt2rt"), log_time=self._time_ns
        )

    def _log_changes(self, record: TickRecord) -> None:
        """Log results, and changes of activity, guard reasons and trouble."""
        for result in record.results:
            level = LogLevel.Info if result.accepted else LogLevel.Warning
            self._log_text(f"{result.command_id}: {text_of(result.outcome)}", level)
        doing = describe_decision(record.decision, record.behaviour)
        if doing != self._doing:
            self._doing = doing
            self._log_text(doing, LogLevel.Debug)
        if record.guard_result.reasons != self._reasons:
            self._reasons = record.guard_result.reasons
            if self._reasons:
                # Each turn begins at the slew limit: nothing that anybody needs to be warned of.
                gently = LogLevel.Debug if all(reason.routine for reason in self._reasons) else LogLevel.Warning
                level = LogLevel.Error if record.guard_result.latched else gently
                self._log_text(f"guard: {', '.join(self._reasons)}", level)
        if record.saving_error != self._saving_error:
            self._saving_error = record.saving_error
            self._log_text(self._saving_error or "lessons are saved again", LogLevel.Error)

    def _log_pose(self, record: TickRecord) -> None:
        if self._scan.has_sinks():
            self._scan.log(self._pictures.scan(record.readings.infrared_counts, self._time_ns), log_time=self._time_ns)
        pose = self._reckoned
        self._pose.log(pose_in(START, pose, self._time_ns), log_time=self._time_ns)
        moves = [(START, ROBOT, pose)]
        if self._begins is not None:
            # Reckoned and true place drift apart from the same beginning. The root comes first: a viewer takes the
            # first parent that it hears of for the ground.
            moves.insert(0, (WORLD, START, self._begins))
        # One message holds the whole tree: after a seek a viewer has but the last one of each topic.
        self._tf.log(transforms(moves, self._time_ns), log_time=self._time_ns)

    def _log_truth(self, truth: SimulatedPlace) -> None:
        here = PlanePose(truth.x_m, truth.y_m, truth.heading_rad)
        if self._begins is None:
            self._begins = here
        self._truth.log(pose_in(WORLD, here, self._time_ns), log_time=self._time_ns)

    def _log_scene(self, record: TickRecord) -> None:
        if self._situation.has_sinks():
            values: list[float] = record.situation.vector.tolist()
            self._situation.log(_json(dict(zip(self._features, values, strict=True))), log_time=self._time_ns)
        if self._scene.has_sinks():
            scene = self._pictures.scene(
                record.readings.infrared_counts, record.decision, record.behaviour, self._time_ns
            )
            self._scene.log(scene, log_time=self._time_ns)


def _channel(topic: str, schema: dict[str, Any], context: Context) -> Channel:
    channel = Channel(topic, schema=schema, context=context)
    # The SDK keeps every channel by its id for lookups. No code here looks one up, and each recorded run would
    # add 8 kB to the process.
    getattr(sdk_channel, "_channels_by_id", {}).pop(channel.id(), None)
    return channel


def _json(content: Mapping[str, Any]) -> bytes:
    return json.dumps(content, separators=(",", ":")).encode()
