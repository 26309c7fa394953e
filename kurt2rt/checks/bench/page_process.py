"""Page process, as `kurt2rt teach` serves it: `python -m kurt2rt.checks.bench.page_process`."""

import sys
from pathlib import Path
from typing import Any

import anyio

from kurt2rt.channel.security.pairing import read_device
from kurt2rt.checks.bench.job_loop import run_jobs
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.access import Access
from kurt2rt.teacher.page.server import listen, run_page


async def main(folder: Path, port: int) -> None:
    """Serve the page of the pairing in `folder` for the robot at the local `port` until the input ends.

    Raises CredentialsError if the pairing cannot be read, PageError if no TCP port is free.
    """
    device = read_device(folder)
    access = Access(device.name, device.token, ())
    with listen(0, everywhere=False) as listener:
        page_port = listener.getsockname()[1]

        async def place() -> dict[str, Any]:
            """Return the port of the page, and the cookie that opens it."""
            return {"port": page_port, "cookie": f"{access.cookie_name}={access.cookie}"}

        async def until_ended() -> None:
            await run_jobs({"place": place})

        async with TeacherClient(folder, port=port) as robot:
            await run_page(robot, access, f"127.0.0.1:{port}", listener, until_ended)


if __name__ == "__main__":
    anyio.run(main, Path(sys.argv[1]), int(sys.argv[2]))
