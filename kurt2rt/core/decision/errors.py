"""Errors for knowledge that names what this robot does not have."""

from hal.errors import UserError


class UnknownActionError(UserError, ValueError):
    """Knowledge or a policy names an action that the repertoire lacks."""


class UnknownBehaviourError(UserError, ValueError):
    """Knowledge names a taught behaviour that the task lacks."""
