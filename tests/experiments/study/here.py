"""Executor of tests: jobs run in this process."""

from kurt2rt.experiments.study.local_executor import LocalExecutor
from kurt2rt.experiments.study.pool import JobProcesses

HERE = LocalExecutor(JobProcesses(1))
"""It starts no process, so there is nothing to end."""
