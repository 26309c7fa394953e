"""Gymnasium environments of the basic tasks; importing this package registers them as `kurt2rt/<Task>-v0`."""

from kurt2rt.gym.registration import register_environments

register_environments()
