"""`kurt2rt study ...`: commands of studies besides those of the paper."""

import typer

from kurt2rt.cli.certify import certify
from kurt2rt.cli.compare import compare
from kurt2rt.cli.doubt import doubt
from kurt2rt.cli.search import search
from kurt2rt.cli.transfer import transfer
from kurt2rt.cli.worker import worker

study = typer.Typer(
    help="Measure taught robots: new worlds, doubt, certificates.\n\nAnd compare learners, and search settings.",
    no_args_is_help=True,
)
for _command in (transfer, compare, doubt, certify, search, worker):
    study.command()(_command)
