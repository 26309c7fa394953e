"""Note that a batch is not compiled."""

import typer


def say_if_interpreted() -> None:
    """Say on standard error that numba is missing, if it is, and what that means."""
    # Not at the top: the simulator is an extra, and every command is loaded where --help is said.
    from simbridge.batch.compiled import IS_COMPILED

    if not IS_COMPILED:
        typer.echo("numba is not installed (extra fast): the batch runs as plain Python, as slow as the bus", err=True)
