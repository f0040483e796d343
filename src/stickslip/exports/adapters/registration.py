"""The environments that Gymnasium finds by their names."""

from stickslip.show.display import require_library

IDS = {"stickslip/Cart-v0": "cart", "stickslip/Capsule-v0": "capsule"}
"""Names of the environments, and of their tasks."""
HOME = "stickslip.exports.adapters.environments"


def register_environments() -> None:
    """Tell Gymnasium the environments, as importing `stickslip.exports.gym` does.

    Raises
    ------
    InputError
        If gymnasium is not installed.

    Examples
    --------
    >>> import gymnasium
    >>> register_environments()
    >>> gymnasium.make("stickslip/Cart-v0").action_space.shape
    (1,)
    """
    registration = require_library("gymnasium.envs.registration", "gym")
    for name, task in IDS.items():
        if name not in registration.registry:
            registration.register(
                id=name,
                entry_point=f"{HOME}:MotorEnvironment",
                vector_entry_point=f"{HOME}:MotorVectorEnvironment",
                kwargs={"task": task},
            )
