"""The interface vcan0, as a test sets it: down, up, gone, slow."""

import subprocess
import time
from pathlib import Path

NAME = "vcan0"
_LOOK_S = 0.01


class Link:
    """One CAN interface of this machine. Each word raises subprocess.CalledProcessError when the kernel refuses."""

    def down(self) -> None:
        """Take it down; its sockets see that it is down, once."""
        _do("ip", "link", "set", NAME, "down")

    def up(self) -> None:
        """Set it up."""
        _do("ip", "link", "set", NAME, "up")

    def delete(self) -> None:
        """Take it away, as an adapter that is unplugged; its sockets are dead for good."""
        _do("ip", "link", "del", NAME)

    def make(self) -> None:
        """Create the interface again, and set it up."""
        _do("ip", "link", "add", "dev", NAME, "type", "vcan")
        self.up()

    def hold_frames_for(self, milliseconds: int) -> None:
        """Carry each frame so much later, in order."""
        _do("tc", "qdisc", "replace", "dev", NAME, "root", "netem", "delay", f"{milliseconds}ms", "limit", "1000")

    def carry_at_most(self, bits_per_s: int, queue_bytes: int) -> None:
        """Be as slow as that, with so much room for frames that wait; a frame counts as 16 bytes."""
        limits = ("burst", "256", "limit", str(queue_bytes))
        _do("tc", "qdisc", "replace", "dev", NAME, "root", "tbf", "rate", f"{bits_per_s}bit", *limits)

    def carry_at_once(self) -> None:
        """Be as quick as ever, once what waits has been carried."""
        if " tbf " in _do("tc", "qdisc", "show", "dev", NAME):
            self.carry_at_most(10_000_000, queue_bytes=1 << 20)
        while "backlog 0b 0p" not in _do("tc", "-s", "qdisc", "show", "dev", NAME):
            time.sleep(_LOOK_S)
        self.lose_what_waits()

    def lose_what_waits(self) -> None:
        """Remove the queueing rules: waiting frames are lost without an error."""
        subprocess.run(["tc", "qdisc", "del", "dev", NAME, "root"], capture_output=True, check=False)

    def restore(self) -> None:
        """Restore the interface to its state before the test."""
        if not Path(f"/sys/class/net/{NAME}").exists():
            self.make()
        self.lose_what_waits()
        self.up()


def _do(*words: str) -> str:
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout
