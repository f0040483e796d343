"""From a law and a mechanism to the text of a self-contained numeric module."""

from stickslip.formulation.joint_torques import JointTorques
from stickslip.formulation.model import Model, formulate
from stickslip.formulation.modes import PAINLEVE

__all__ = ["PAINLEVE", "JointTorques", "Model", "formulate"]
