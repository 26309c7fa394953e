"""Codec between integers and frames, compiled from a DBC file that cantools reads once."""

import struct
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import cast

import cantools
from cantools.database import Message, Signal
from cantools.database.can import Database

from config import CONFIG_DIR
from config.errors import UserError
from hal.frame import Frame

_STRUCT_LETTERS = {8: "b", 16: "h", 32: "i", 64: "q"}


_LONGEST = 8
"""Bytes of the longest frame of classic CAN."""


class CodecError(UserError, ValueError):
    """Unusable CAN database. The text is one line: file, message, what is wrong."""


class InvalidFrameError(ValueError):
    """Received frame that does not fit its identifier."""


class MessageCodec:
    """Codec of one message without multiplexing: raw integers in the order of `signals` to a frame and back."""

    def __init__(self, source: str, message: Message) -> None:
        """Compile a message of the database `source`. Raises CodecError for little-endian and floating signals."""
        signals = sorted(message.signals, key=_first_bit)
        for signal in signals:
            if signal.byte_order != "big_endian" or signal.conversion.is_float:
                raise CodecError(
                    "must be a big-endian integer",
                    where=f"{source}: {message.name}.{signal.name}",
                    do="mend the database, or use that of this robot",
                )
        self.name = message.name
        self.frame_id = message.frame_id
        self.length = message.length
        self.signals = tuple(signal.name for signal in signals)
        self._ranges = tuple(_raw_range(signal) for signal in signals)
        self._covers_bytes = max(((_first_bit(signal) + signal.length + 7) // 8 for signal in signals), default=0)
        # Shift and width of each signal in the payload read as one big-endian integer.
        self._places = tuple(
            (8 * message.length - _first_bit(signal) - signal.length, signal.length, signal.is_signed)
            for signal in signals
        )
        self._struct = _byte_aligned_struct(signals, message.length)

    def pack(self, *raw: int) -> Frame:
        """Return the frame of raw values. Raises ValueError that names message, signal, value and range."""
        if self._struct is None:
            return Frame(self.frame_id, self._pack_bits(raw))
        try:
            return Frame(self.frame_id, self._struct.pack(*raw))
        except struct.error:
            raise self._why_not(raw) from None

    def unpack(self, data: bytes | bytearray) -> tuple[int, ...]:
        """Return the raw values of a payload of any DLC. Raises InvalidFrameError if it does not cover the signals."""
        length = self.length
        if len(data) < length:
            if len(data) < self._covers_bytes:
                raise InvalidFrameError(f"{self.name}: {len(data)} bytes, needs at least {self._covers_bytes}")
            data = data.ljust(length, b"\0")
        if self._struct is None:
            return self._unpack_bits(data)
        return self._struct.unpack_from(data)

    def _pack_bits(self, raw: tuple[int, ...]) -> bytes:
        if len(raw) != len(self.signals) or any(
            not low <= value <= high for value, (low, high) in zip(raw, self._ranges, strict=True)
        ):
            raise self._why_not(raw)
        payload = 0
        for value, (shift, width, _) in zip(raw, self._places, strict=True):
            payload |= (value & ((1 << width) - 1)) << shift
        return payload.to_bytes(self.length, "big")

    def _unpack_bits(self, data: bytes | bytearray) -> tuple[int, ...]:
        payload = int.from_bytes(data[: self.length], "big")
        values = []
        for shift, width, signed in self._places:
            value = (payload >> shift) & ((1 << width) - 1)
            values.append(value - (1 << width) if signed and value >> (width - 1) else value)
        return tuple(values)

    def _why_not(self, raw: tuple[int, ...]) -> ValueError:
        if len(raw) != len(self.signals):
            return ValueError(f"{self.name}: {len(raw)} values given, needs {', '.join(self.signals)}")
        for signal, value, (low, high) in zip(self.signals, raw, self._ranges, strict=True):
            if not low <= value <= high:
                return ValueError(f"{self.name}.{signal}: {value} given, allowed are integers from {low} to {high}")
        return ValueError(f"{self.name}: {raw} given, all values must be integers")


class Codec:
    """All plain messages of a CAN database; CONTROL with its modes is in hal.control."""

    def __init__(self, source: str, messages: tuple[MessageCodec, ...]) -> None:
        """Hold messages of the database `source`. Raises CodecError if two of them share a name or an identifier."""
        self.source = source
        self._by_name = {message.name: message for message in messages}
        self.by_id: Mapping[int, MessageCodec] = MappingProxyType({message.frame_id: message for message in messages})
        for message in messages:
            if self._by_name[message.name] is not message or self.by_id[message.frame_id] is not message:
                raise CodecError(
                    f"another message has its name or its identifier 0x{message.frame_id:02X}",
                    where=f"{source}: {message.name}",
                    do="leave one of them out",
                )

    def message(self, name: str, signals: Sequence[str] | None = None) -> MessageCodec:
        """Return a message by name, with exactly these signals in this order; None: with any.

        Raises CodecError that lists the names, of messages or of signals.
        """
        if name not in self._by_name:
            raise CodecError(
                f"no plain message {name}", where=self.source, do=f"name one of: {', '.join(self._by_name) or 'none'}"
            )
        message = self._by_name[name]
        if signals is not None and message.signals != tuple(signals):
            raise CodecError(
                f"its signals are {', '.join(message.signals) or 'none'}",
                where=f"{self.source}: {name}",
                do=f"give it {', '.join(signals)}",
            )
        return message


def load_database(database: str = "kurt2.dbc") -> Database:
    """Load a CAN database of config/can by name, or a DBC file by path. Raises CodecError."""
    return _database_of(*_read(database))


def load_codec(database: str = "kurt2.dbc") -> Codec:
    """Load the codec of a database in config/can by name, or of a DBC file by path. Raises CodecError."""
    return _codec_of(database, *_read(database))


def _read(database: str) -> tuple[Path, str]:
    """Return the path and the text of a database. Raises CodecError."""
    path = Path(database)
    if not path.is_file():
        path = CONFIG_DIR / "can" / database
    try:
        return path, path.read_text(encoding="cp1252")
    except (OSError, ValueError) as error:
        raise _unusable(path, error) from error


def _database_of(path: Path, text: str) -> Database:
    try:
        return cast(Database, cantools.database.load_string(text, database_format="dbc"))
    except cantools.Error as error:
        raise _unusable(path, error) from error


def _unusable(path: Path, error: Exception) -> CodecError:
    return CodecError(
        f"cannot be used as a CAN database: {' '.join(str(error).split())}", where=path, do="mend or replace it"
    )


@lru_cache(maxsize=4)
def _codec_of(database: str, path: Path, text: str) -> Codec:
    """Compile a database, cached by its content: each simulated robot loads it three times."""
    messages = filter(_is_plain, _database_of(path, text).messages)
    return Codec(database, tuple(MessageCodec(database, message) for message in messages))


def _is_plain(message: Message) -> bool:
    """Return whether a message is a frame as this robot's are: an 11-bit identifier, 8 bytes, no multiplexing."""
    return not (message.is_multiplexed() or message.is_extended_frame or message.length > _LONGEST)


def _first_bit(signal: Signal) -> int:
    """Return the most significant bit, counted from the front of the payload (DBC counts each byte from its end)."""
    return 8 * (signal.start // 8) + 7 - signal.start % 8


def _raw_range(signal: Signal) -> tuple[int, int]:
    if signal.is_signed:
        return -(1 << (signal.length - 1)), (1 << (signal.length - 1)) - 1
    return 0, (1 << signal.length) - 1


def _byte_aligned_struct(signals: list[Signal], length: int) -> struct.Struct | None:
    """Return one struct for the whole payload, or None if a signal (24 bits, single bits) does not fit one."""
    layout, at_bit = ">", 0
    for signal in signals:
        first = _first_bit(signal)
        if first % 8 or signal.length not in _STRUCT_LETTERS:
            return None
        letter = _STRUCT_LETTERS[signal.length]
        layout += "x" * ((first - at_bit) // 8) + (letter if signal.is_signed else letter.upper())
        at_bit = first + signal.length
    return struct.Struct(layout + "x" * (length - at_bit // 8))


SIMULATED_HARDWARE_ID = 0x5349
"""Hardware id of simulated controllers, "SI" in ASCII. The ids of real controllers are not published."""


def hardware(hardware_id: int) -> str:
    """Return the hardware id of an INFO frame in words for the user, such as `hardware 7`."""
    return f"hardware {hardware_id}" + (" (the simulated robot)" if hardware_id == SIMULATED_HARDWARE_ID else "")
