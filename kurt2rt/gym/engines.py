"""Engines that an environment drives by: the CAN bus, or the compiled batch."""

from config.settings import SettingsError
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.gym.batch_drive import BatchDrive
from kurt2rt.gym.bus_drive import BusDrive
from kurt2rt.gym.episode_setup import PURPOSE, EpisodeSetup
from kurt2rt.gym.moment import AgentDrive
from simbridge.batch.compiled import IS_COMPILED
from simbridge.contracts.batch import BatchFactory


def quickest_engine() -> Engine:
    """Return the batch, or without the compiler (extra `fast`) the CAN bus, which is quicker then."""
    return Engine.COMPILED if IS_COMPILED else Engine.CAN


def read_engine(name: str) -> Engine:
    """Return the engine of a name. Raises config.settings.SettingsError for an unknown one."""
    if name not in set(Engine):
        raise SettingsError(f"engine: unknown (got {name}, allowed {', '.join(Engine)})")
    return Engine(name)


def open_drive(engine: Engine, factory: BatchFactory, setup: EpisodeSetup) -> AgentDrive:
    """Return a new drive of an agent.

    Raises:
        BatchRefusedError: the batch does not know an action of the task, or a feature of its situation.
        config.settings.SettingsError: task and world do not fit.
    """
    if engine is Engine.COMPILED:
        return BatchDrive(factory, setup)
    return BusDrive(factory.open(setup.world, setup.seed, PURPOSE), setup)
