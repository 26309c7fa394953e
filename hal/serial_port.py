"""Serial ports by pyserial (extra `serial`)."""

import contextlib

import serial

from hal.bus import BusError

_REMEDY = "plug the robot in, check the name of the port and the permission to use it"
_MOST_BYTES = 1 << 16


class SerialPort:
    """Serial port by the path of its device (hal.byte_port.BytePort), which no other program may open."""

    def __init__(self, device: str, bit_rate_bit_s: int) -> None:
        """Open the port; bytes that came before are dropped. Raises hal.bus.BusError."""
        self.name = f"serial port {device}"
        self._device = device
        self._bit_rate_bit_s = bit_rate_bit_s
        self._serial = self._open()

    @property
    def waiting(self) -> int:
        """Number of written bytes that have not left yet; 0 after the port was lost."""
        with contextlib.suppress(OSError):
            return int(self._serial.out_waiting)
        return 0

    def read(self) -> bytes:
        """Return all bytes that arrived. Raises hal.bus.BusError."""
        try:
            return bytes(self._serial.read(_MOST_BYTES))
        except OSError as error:
            raise self._lost(error) from error

    def write(self, data: bytes) -> None:
        """Write bytes. Raises hal.bus.BusError if the port does not take them as a whole."""
        try:
            taken = self._serial.write(data)
        except OSError as error:
            raise self._lost(error) from error
        if taken != len(data):
            raise BusError("takes no more bytes", where=self.name, do=_REMEDY)

    def reopen(self) -> None:
        """Open the port again. Raises hal.bus.BusError while it is still lost."""
        self.close()
        self._serial = self._open()

    def close(self) -> None:
        """Close the port; may be called twice."""
        self._serial.close()

    def _open(self) -> serial.Serial:
        try:
            # Timeouts of 0: nothing waits.
            return serial.Serial(self._device, self._bit_rate_bit_s, timeout=0, write_timeout=0, exclusive=True)
        except OSError as error:
            raise self._lost(error) from error

    def _lost(self, error: OSError) -> BusError:
        return BusError(" ".join(str(error).split()), where=self.name, do=_REMEDY)
