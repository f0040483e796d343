"""Other libraries of Python: environments of Gymnasium, systems of python-control, SciPy's ODEs."""

from stickslip.lazy import attach

HOMES = {
    "CAPSULE": "motor_task",
    "CART": "motor_task",
    "DescribingFunction": "control_systems",
    "ModeProblem": "initial_value_problems",
    "ModeSolution": "initial_value_problems",
    "MotorEnvironment": "environments",
    "MotorTask": "motor_task",
    "MotorVectorEnvironment": "environments",
    "register_environments": "motor_task",
    "to_describing_function": "control_systems",
    "to_ivp": "initial_value_problems",
    "to_nonlinear_system": "control_systems",
}

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES)
