# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.mechanisms.actuators import MOTORS as MOTORS
from stickslip.mechanisms.actuators import Motor as Motor
from stickslip.mechanisms.actuators import Prescribed as Prescribed
from stickslip.mechanisms.actuators import Torque as Torque
from stickslip.mechanisms.axis import Axis as Axis
from stickslip.mechanisms.base import BoundedMechanism as BoundedMechanism
from stickslip.mechanisms.base import Contact as Contact
from stickslip.mechanisms.base import Guide as Guide
from stickslip.mechanisms.base import Mechanism as Mechanism
from stickslip.mechanisms.base import Stop as Stop
from stickslip.mechanisms.base import stops_between as stops_between
from stickslip.mechanisms.base import stops_of as stops_of
from stickslip.mechanisms.block_chain import BlockChain as BlockChain
from stickslip.mechanisms.capsule import Capsule as Capsule
from stickslip.mechanisms.clutch_train import ClutchTrain as ClutchTrain
from stickslip.mechanisms.clutch_train import Rotor as Rotor
from stickslip.mechanisms.contacts import has_one_slip as has_one_slip
from stickslip.mechanisms.contacts import normal_of as normal_of
from stickslip.mechanisms.contacts import only_contact as only_contact
from stickslip.mechanisms.contacts import refuse_too_many as refuse_too_many
from stickslip.mechanisms.contacts import slip_among as slip_among
from stickslip.mechanisms.contacts import slip_names as slip_names
from stickslip.mechanisms.contacts import slip_of as slip_of
from stickslip.mechanisms.contacts import slipping as slipping
from stickslip.mechanisms.contacts import static_normal_force as static_normal_force
from stickslip.mechanisms.contacts import static_normal_forces as static_normal_forces
from stickslip.mechanisms.disc_brake import DiscBrake as DiscBrake
from stickslip.mechanisms.drive_period import WHOLE as WHOLE
from stickslip.mechanisms.drive_period import cycle_of as cycle_of
from stickslip.mechanisms.drive_period import cycle_or_none as cycle_or_none
from stickslip.mechanisms.drive_period import repeats as repeats
from stickslip.mechanisms.lining import Lining as Lining
from stickslip.mechanisms.matrix_mechanism import MatrixMechanism as MatrixMechanism
from stickslip.mechanisms.pendulum import Pendulum as Pendulum
from stickslip.mechanisms.pendulum_cart import PendulumCart as PendulumCart
from stickslip.mechanisms.registry import MECHANISMS as MECHANISMS
from stickslip.mechanisms.registry import mechanisms as mechanisms
from stickslip.mechanisms.rigid_bodies import joint_places as joint_places
from stickslip.mechanisms.robot import Robot as Robot
from stickslip.mechanisms.robot import RobotJoint as RobotJoint
from stickslip.mechanisms.serial_arm import Link as Link
from stickslip.mechanisms.serial_arm import SerialArm as SerialArm
from stickslip.mechanisms.spring_block import SpringBlock as SpringBlock
from stickslip.mechanisms.towed_block import TowedBlock as TowedBlock
from stickslip.mechanisms.two_feet import TwoFeet as TwoFeet
from stickslip.mechanisms.two_link_arm import TwoLinkArm as TwoLinkArm
from stickslip.mechanisms.two_mass_axis import TwoMassAxis as TwoMassAxis
from stickslip.mechanisms.urdf import RobotDescription as RobotDescription
from stickslip.mechanisms.urdf import read_urdf as read_urdf

MECHANISM_MODULES: dict[str, str]

__all__ = [
    "Axis",
    "BlockChain",
    "BoundedMechanism",
    "Capsule",
    "ClutchTrain",
    "Contact",
    "DiscBrake",
    "Guide",
    "Lining",
    "Link",
    "MECHANISMS",
    "MOTORS",
    "MatrixMechanism",
    "Mechanism",
    "Motor",
    "Pendulum",
    "PendulumCart",
    "Prescribed",
    "Robot",
    "RobotDescription",
    "RobotJoint",
    "Rotor",
    "SerialArm",
    "SpringBlock",
    "Stop",
    "Torque",
    "TowedBlock",
    "TwoFeet",
    "TwoLinkArm",
    "TwoMassAxis",
    "mechanisms",
    "read_urdf",
    "slip_names",
    "static_normal_force",
    "static_normal_forces",
    "stops_between",
    "stops_of",
]
