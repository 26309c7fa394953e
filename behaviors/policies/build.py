"""From a task's policy settings to the policy."""

from behaviors.policies.policy import ReferencePolicy
from behaviors.policies.wall_following import WallFollowing, WallFollowingSettings
from hal.robot_settings import InfraredSettings


def build_policy(settings: WallFollowingSettings, infrared: InfraredSettings) -> ReferencePolicy:
    """The reference policy that a scripted teacher of this task consults."""
    return WallFollowing(settings, infrared)
