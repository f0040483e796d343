"""Mechanisms: equations of motion without friction, each one a file."""

from stickslip.lazy import attach

MECHANISM_MODULES = {
    "SpringBlock": "blocks",
    "TowedBlock": "blocks",
    "Axis": "axes",
    "TwoMassAxis": "axes",
    "Pendulum": "axes",
    "PIDAxis": "axes",
    "PendulumCart": "capsules",
    "Capsule": "capsules",
    "TwoMassCapsule": "capsules",
    "BlockChain": "blocks",
    "TwoFeet": "blocks",
    "TwoLinkArm": "robots",
    "SerialArm": "robots",
    "Robot": "robots",
}
"""The mechanisms in the order of listings, with their modules: all that registers one."""

__getattr__, __dir__, __all__ = attach(__name__, MECHANISM_MODULES)
