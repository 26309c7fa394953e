"""Names of the environments in Gymnasium's registry."""

import gymnasium

ENVIRONMENTS = {
    "kurt2rt/WallFollowing-v0": "wall_following",
    "kurt2rt/Fleeing-v0": "fleeing",
    "kurt2rt/Circle-v0": "circle",
    "kurt2rt/Eight-v0": "eight",
    "kurt2rt/StraightOn-v0": "straight_on",
    "kurt2rt/TurnLeft-v0": "turn_left",
    "kurt2rt/TurnRight-v0": "turn_right",
}
"""Task of each environment; a version grows when its numbers change."""


def register_environments() -> None:
    """Register the environment of each task in Gymnasium's registry."""
    for name, task in ENVIRONMENTS.items():
        gymnasium.register(
            name,
            "kurt2rt.gym.environment:TaskEnvironment",
            vector_entry_point="kurt2rt.gym.vector:make_vector_environment",
            kwargs={"task": task},
        )
