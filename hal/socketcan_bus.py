"""SocketCAN: the kernel's CAN, on the robot `can0`, in tests `vcan0`."""

from can.interfaces.socketcan import SocketcanBus


class SocketCanBus(SocketcanBus):
    """One end of a bus that the kernel carries."""

    confirms = False

    def __init__(self, interface: str) -> None:
        """Open a socket on an interface. Raises OSError, can.CanError, AttributeError (a Python without CAN)."""
        super().__init__(channel=interface)

    def now_s(self) -> float | None:
        """None as yet: frames count as just arrived."""
        return None

    def listen_to(self, frame_ids: frozenset[int]) -> None:
        """Let the kernel deliver only frames with these standard identifiers, and error frames."""
        self.set_filters([{"can_id": each, "can_mask": 0x7FF, "extended": False} for each in sorted(frame_ids)])
