"""File of a cluster: the address of its scheduler, and the key and certificate by which its members know each other."""

import os
import shlex
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit

from distributed import Security

from config.errors import UserError
from kurt2rt.platform.durable_files import fsync_folder

_MAKE = "kurt2rt study worker --new FILE --scheduler tls://HOST:PORT makes one"


class ClusterError(UserError):
    """A cluster cannot be used."""


class ClusterFile(NamedTuple):
    """Content of the file that every member of a cluster has."""

    address: str
    """`tls://HOST:PORT` of the scheduler."""
    security: Security
    """Key and certificate; a connection without them is refused at both ends."""


def make_cluster_file(path: Path, address: str) -> None:
    """Make the file of a cluster, readable by its owner only, with a new key and certificate, valid for a year.

    `address`: of its scheduler, `tls://HOST:PORT`. Raises ClusterError for another address, OSError.
    """
    _require_tls(address, path)
    made = Security.temporary()
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        # Readers of certificates pass over lines before the first block.
        file.write(f"{address}\n{made.tls_client_key}{made.tls_client_cert}")
        file.flush()
        os.fsync(file.fileno())
    fsync_folder(path.parent)


def read_cluster_file(path: Path) -> ClusterFile:
    """Return the content of a cluster's file.

    Raises ClusterError: it is none, or users other than its owner may read it and so run code on all members.
    """
    try:
        if path.stat().st_mode & 0o077:
            raise ClusterError("others may read it, and run programs by it", where=path, do=f"chmod 600 {path}")
        address = path.read_text().partition("\n")[0]
        names = [f"tls_{member}_{part}" for member in ("client", "worker", "scheduler") for part in ("cert", "key")]
        security = Security(require_encryption=True, tls_ca_file=str(path), **dict.fromkeys(names, str(path)))
        security.get_connection_args("client")
    except (OSError, ValueError) as error:
        raise ClusterError(f"is not a cluster file ({error})", where=path, do=_MAKE) from error
    _require_tls(address, path)
    return ClusterFile(address, security)


def scheduler_command(file: Path, address: str) -> str:
    """Return the command that starts the scheduler; started otherwise, Dask opens a port that runs any program."""
    there, certificate = urlsplit(address), str(file)
    return shlex.join(
        (
            *("dask", "scheduler", "--no-dashboard", "--protocol", "tls"),
            *("--host", str(there.hostname), "--port", str(there.port)),
            *("--tls-ca-file", certificate, "--tls-cert", certificate, "--tls-key", certificate),
        )
    )


def no_scheduler(file: Path, address: str) -> ClusterError:
    """Return the error of a cluster whose scheduler does not answer."""
    do = f"start one there: {scheduler_command(file, address)}"
    return ClusterError("no scheduler of this cluster answers", where=address, do=do)


def _require_tls(address: str, where: Path) -> None:
    """Refuse any other address, because remote jobs are pickles: who may send one runs any program."""
    try:
        parts = urlsplit(address)
        is_tls = parts.scheme == "tls" and bool(parts.hostname) and parts.port is not None
    except ValueError:
        is_tls = False
    if not is_tls:
        raise ClusterError(f"no address of a scheduler (got {address}, allowed tls://HOST:PORT)", where=where, do=_MAKE)
