# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from dataclasses import dataclass

from collections.abc import Mapping as _Mapping
from stickslip.mechanisms import contact_inputs as contact_inputs
from stickslip.mechanisms import drives as drives
from stickslip.mechanisms.axes import Axis as _Axis
from stickslip.mechanisms.axes import PIDAxis as _PIDAxis
from stickslip.mechanisms.axes import Pendulum as _Pendulum
from stickslip.mechanisms.axes import TwoMassAxis as _TwoMassAxis
from stickslip.mechanisms.base import BoundedMechanism as BoundedMechanism
from stickslip.mechanisms.base import Contact as Contact
from stickslip.mechanisms.base import ContactInputs as ContactInputs
from stickslip.mechanisms.base import Guide as Guide
from stickslip.mechanisms.base import LINKS as LINKS
from stickslip.mechanisms.base import LinearOrRotary as LinearOrRotary
from stickslip.mechanisms.base import MatrixMechanism as MatrixMechanism
from stickslip.mechanisms.base import Mechanism as Mechanism
from stickslip.mechanisms.base import PREFIX as PREFIX
from stickslip.mechanisms.base import Stop as Stop
from stickslip.mechanisms.base import WHOLE as WHOLE
from stickslip.mechanisms.base import as_rotary as as_rotary
from stickslip.mechanisms.base import canonical_path as canonical_path
from stickslip.mechanisms.base import checked_contacts as checked_contacts
from stickslip.mechanisms.base import cycle_of as cycle_of
from stickslip.mechanisms.base import cycle_or_none as cycle_or_none
from stickslip.mechanisms.base import gear_inputs as gear_inputs
from stickslip.mechanisms.base import given_inputs as given_inputs
from stickslip.mechanisms.base import given_names as given_names
from stickslip.mechanisms.base import has_one_slip as has_one_slip
from stickslip.mechanisms.base import input_field as input_field
from stickslip.mechanisms.base import input_names as input_names
from stickslip.mechanisms.base import load_stated as load_stated
from stickslip.mechanisms.base import normal_of as normal_of
from stickslip.mechanisms.base import of_contact as of_contact
from stickslip.mechanisms.base import only_contact as only_contact
from stickslip.mechanisms.base import quantity_at as quantity_at
from stickslip.mechanisms.base import redriven as redriven
from stickslip.mechanisms.base import repeats as repeats
from stickslip.mechanisms.base import slip_among as slip_among
from stickslip.mechanisms.base import slip_names as slip_names
from stickslip.mechanisms.base import slip_of as slip_of
from stickslip.mechanisms.base import slipping as slipping
from stickslip.mechanisms.base import slips_by_angle as slips_by_angle
from stickslip.mechanisms.base import static_normal_force as static_normal_force
from stickslip.mechanisms.base import static_normal_forces as static_normal_forces
from stickslip.mechanisms.base import stops_between as stops_between
from stickslip.mechanisms.base import stops_of as stops_of
from stickslip.mechanisms.base import told_fields as told_fields
from stickslip.mechanisms.base import without_given as without_given
from stickslip.mechanisms.blocks import BlockChain as _BlockChain
from stickslip.mechanisms.blocks import SpringBlock as _SpringBlock
from stickslip.mechanisms.blocks import TowedBlock as _TowedBlock
from stickslip.mechanisms.blocks import TwoFeet as _TwoFeet
from stickslip.mechanisms.capsules import Capsule as _Capsule
from stickslip.mechanisms.capsules import Coil as _Coil
from stickslip.mechanisms.capsules import InnerMass as _InnerMass
from stickslip.mechanisms.capsules import MOTORS as MOTORS
from stickslip.mechanisms.capsules import Motor as Motor
from stickslip.mechanisms.capsules import Motor as _Motor
from stickslip.mechanisms.capsules import PendulumCart as _PendulumCart
from stickslip.mechanisms.capsules import Prescribed as _Prescribed
from stickslip.mechanisms.capsules import SoftStop as _SoftStop
from stickslip.mechanisms.capsules import Torque as _Torque
from stickslip.mechanisms.capsules import TwoMassCapsule as _TwoMassCapsule
from stickslip.mechanisms.drives import Drive as _Drive
from stickslip.mechanisms.drives import Profile as _Profile
from stickslip.mechanisms.electric_motor import CurrentLoop as CurrentLoop
from stickslip.mechanisms.electric_motor import DCMotor as _DCMotor
from stickslip.mechanisms.electric_motor import LOOPS as LOOPS
from stickslip.mechanisms.electric_motor import LoopMemory as LoopMemory
from stickslip.mechanisms.electric_motor import MotorLoop as MotorLoop
from stickslip.mechanisms.electric_motor import MotorLoop as _MotorLoop
from stickslip.mechanisms.electric_motor import PositionLoop as _PositionLoop
from stickslip.mechanisms.electric_motor import SampledLoop as _SampledLoop
from stickslip.mechanisms.electric_motor import VelocityLoop as _VelocityLoop
from stickslip.mechanisms.electric_motor import driven_by_motor as driven_by_motor
from stickslip.mechanisms.electric_motor import driving_inertia as driving_inertia
from stickslip.mechanisms.electric_motor import motor_of as motor_of
from stickslip.mechanisms.electric_motor import motors_of as motors_of
from stickslip.mechanisms.electric_motor import refuse_sampling as refuse_sampling
from stickslip.mechanisms.electric_motor import within_limit as within_limit
from stickslip.mechanisms.registry import MECHANISMS as MECHANISMS
from stickslip.mechanisms.registry import mechanisms as mechanisms
from stickslip.mechanisms.rigid_bodies import joint_places as joint_places
from stickslip.mechanisms.robots import Link as _Link
from stickslip.mechanisms.robots import Robot as _Robot
from stickslip.mechanisms.robots import RobotJoint as _RobotJoint
from stickslip.mechanisms.robots import SerialArm as _SerialArm
from stickslip.mechanisms.robots import TwoLinkArm as _TwoLinkArm
from stickslip.mechanisms.robots import coordinate_of as coordinate_of
from stickslip.mechanisms.urdf import RobotDescription as RobotDescription
from stickslip.mechanisms.urdf import has_macros as has_macros
from stickslip.mechanisms.urdf import read_urdf as read_urdf
from stickslip.mechanisms.urdf import urdf_joints as urdf_joints
from stickslip.quantities import Given as _Given
from typing import Literal as _Literal

MECHANISM_MODULES: dict[str, str]

@dataclass(frozen=True, kw_only=True, init=False)
class Axis(_Axis):
    drive: _Drive | DCMotor | None = ...
    def __init__(
        self,
        *,
        rotary: bool = ...,
        inertia: _Given,
        drive: _Drive | _DCMotor | None = ...,
        stiffness: _Given = ...,
        damping: _Given = ...,
        load: _Given = ...,
        offset: _Given = ...,
        lower_stop: _Given | None = ...,
        upper_stop: _Given | None = ...,
        restitution: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BlockChain(_BlockChain):
    def __init__(
        self,
        *,
        blocks: int,
        mass: _Given,
        coupling: _Given,
        stiffness: _Given = ...,
        damping: _Given = ...,
        speed: _Given | None = ...,
        load: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Capsule(_Capsule):
    lower_soft_stop: SoftStop | None = ...
    upper_soft_stop: SoftStop | None = ...
    def __init__(
        self,
        *,
        capsule_mass: _Given,
        inner_mass: _Given,
        drive: _Motor = ...,
        stiffness: _Given = ...,
        damping: _Given = ...,
        gravity: _Given = ...,
        incline: _Given = ...,
        lower_stop: _Given | None = ...,
        upper_stop: _Given | None = ...,
        restitution: _Given = ...,
        lower_soft_stop: _SoftStop | None = ...,
        upper_soft_stop: _SoftStop | None = ...,
        drive_on: _Literal['both', 'inner mass'] = ...,
        squeeze: _Given = ...,
        angle: _Given | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Coil(_Coil):
    def __init__(
        self,
        *,
        drive: _Drive | None = ...,
        limit: _Given | None = ...,
        radius: _Given,
        middle: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class DCMotor(_DCMotor):
    def __init__(
        self,
        *,
        resistance: _Given,
        torque_constant: _Given,
        back_emf_constant: _Given | None = ...,
        gear_ratio: _Given = ...,
        rotor_inertia: _Given = ...,
        supply: _Given | None = ...,
        supply_resistance: _Given | None = ...,
        current_limit: _Given | None = ...,
        loop: _MotorLoop | None = ...,
        drive: _Drive | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class InnerMass(_InnerMass):
    lower_soft_stop: SoftStop | None = ...
    upper_soft_stop: SoftStop | None = ...
    def __init__(
        self,
        *,
        mass: _Given,
        angle: _Given = ...,
        drive: _Motor = ...,
        stiffness: _Given = ...,
        damping: _Given = ...,
        lower_stop: _Given | None = ...,
        upper_stop: _Given | None = ...,
        restitution: _Given = ...,
        lower_soft_stop: _SoftStop | None = ...,
        upper_soft_stop: _SoftStop | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Link(_Link):
    torque: _Drive | DCMotor | None = ...
    def __init__(
        self,
        *,
        mass: _Given,
        length: _Given,
        centre: _Given,
        inertia: _Given,
        rotor_inertia: _Given = ...,
        gear_ratio: _Given = ...,
        damping: _Given = ...,
        torque: _Drive | _DCMotor | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PIDAxis(_PIDAxis):
    def __init__(
        self,
        *,
        rotary: bool = ...,
        inertia: _Given,
        proportional: _Given,
        integral: _Given,
        derivative: _Given = ...,
        reference: _Given = ...,
        drive: _Drive | None = ...,
        load: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Pendulum(_Pendulum):
    drive: _Drive | DCMotor | None = ...
    def __init__(
        self,
        *,
        mass: _Given,
        length: _Given,
        inertia: _Given = ...,
        drive: _Drive | _DCMotor | None = ...,
        damping: _Given = ...,
        load: _Given = ...,
        gravity: _Given = ...,
        rest_angle: _Given | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PendulumCart(_PendulumCart):
    lower_soft_stop: SoftStop | None = ...
    upper_soft_stop: SoftStop | None = ...
    def __init__(
        self,
        *,
        cart_mass: _Given,
        ball_mass: _Given,
        length: _Given,
        pendulum: _Motor = ...,
        pivot_stiffness: _Given = ...,
        pivot_angle: _Given = ...,
        pivot_damping: _Given = ...,
        pivot_load: _Given | None = ...,
        lower_stop: _Given | None = ...,
        upper_stop: _Given | None = ...,
        restitution: _Given = ...,
        lower_soft_stop: _SoftStop | None = ...,
        upper_soft_stop: _SoftStop | None = ...,
        gravity: _Given = ...,
        incline: _Given = ...,
        wheelbase: _Given | None = ...,
        pivot_height: _Given = ...,
        centre_height: _Given = ...,
        ground: _Drive | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PositionLoop(_PositionLoop):
    def __init__(
        self,
        *,
        gain: _Given,
        rate_gain: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Prescribed(_Prescribed):
    def __init__(
        self,
        *,
        profile: _Profile,
        limit: _Given | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Robot(_Robot):
    joints: tuple[RobotJoint, ...]
    def __init__(
        self,
        *,
        joints: tuple[_RobotJoint, ...],
        gravity: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class RobotJoint(_RobotJoint):
    effort: _Drive | DCMotor | None = ...
    def __init__(
        self,
        *,
        joint: str,
        kind: _Literal['revolute', 'prismatic'] = ...,
        parent: str = ...,
        place: tuple[float, ...] = ...,
        orientation: tuple[float, ...] = ...,
        axis: tuple[float, ...] = ...,
        mass: _Given,
        centre_x: _Given = ...,
        centre_y: _Given = ...,
        centre_z: _Given = ...,
        inertia_xx: _Given = ...,
        inertia_yy: _Given = ...,
        inertia_zz: _Given = ...,
        inertia_xy: _Given = ...,
        inertia_xz: _Given = ...,
        inertia_yz: _Given = ...,
        added_moment_x: _Given = ...,
        added_moment_y: _Given = ...,
        added_moment_z: _Given = ...,
        added_inertia_xx: _Given = ...,
        added_inertia_yy: _Given = ...,
        added_inertia_zz: _Given = ...,
        added_inertia_xy: _Given = ...,
        added_inertia_xz: _Given = ...,
        added_inertia_yz: _Given = ...,
        added_armature: _Given = ...,
        damping: _Given = ...,
        armature: _Given = ...,
        coupling: _Mapping[str, float] | tuple[tuple[str, float], ...] = ...,
        effort: _Drive | _DCMotor | None = ...,
        lower_stop: _Given | None = ...,
        upper_stop: _Given | None = ...,
        restitution: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SampledLoop(_SampledLoop):
    def __init__(
        self,
        *,
        gain: _Given,
        integral_gain: _Given = ...,
        rate_gain: _Given = ...,
        period: _Given,
        delay: _Given = ...,
        duty_limit: _Given = ...,
        step: _Given | None = ...,
        encoder_step: _Given | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SerialArm(_SerialArm):
    links: tuple[Link, ...]
    def __init__(
        self,
        *,
        links: tuple[_Link, ...],
        gravity: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SoftStop(_SoftStop):
    def __init__(
        self,
        *,
        place: _Given,
        stiffness: _Given,
        damping: _Given = ...,
        sticks: bool = ...,
        spring: _Literal['linear', 'hertz', 'exponential'] = ...,
        stiffening: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SpringBlock(_SpringBlock):
    def __init__(
        self,
        *,
        mass: _Given,
        stiffness: _Given = ...,
        compression: _Given = ...,
        attached: bool = ...,
        drive: _Drive | None = ...,
        gravity: _Given = ...,
        incline: _Given = ...,
        lower_stop: _Given | None = ...,
        upper_stop: _Given | None = ...,
        restitution: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Torque(_Torque):
    def __init__(
        self,
        *,
        drive: _Drive | None = ...,
        limit: _Given | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class TowedBlock(_TowedBlock):
    def __init__(
        self,
        *,
        mass: _Given,
        stiffness: _Given,
        speed: _Given,
        damping: _Given = ...,
        load: _Given | None = ...,
        gravity: _Given = ...,
        modulation: _Drive | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class TwoFeet(_TwoFeet):
    def __init__(
        self,
        *,
        mass: _Given,
        front: _Given,
        rear: _Given,
        height: _Given = ...,
        stiffness: _Given = ...,
        damping: _Given = ...,
        drive: _Drive | None = ...,
        gravity: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class TwoLinkArm(_TwoLinkArm):
    def __init__(
        self,
        *,
        upper_mass: _Given,
        upper_length: _Given,
        upper_centre: _Given,
        upper_inertia: _Given,
        lower_mass: _Given,
        lower_centre: _Given,
        lower_inertia: _Given,
        rotor_inertia: _Given = ...,
        gear_ratio: _Given = ...,
        shoulder_drive: _Drive | None = ...,
        elbow_drive: _Drive | None = ...,
        gravity: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class TwoMassAxis(_TwoMassAxis):
    drive: _Drive | DCMotor | None = ...
    def __init__(
        self,
        *,
        rotary: bool = ...,
        motor_inertia: _Given,
        load_inertia: _Given,
        stiffness: _Given,
        damping: _Given = ...,
        drive: _Drive | _DCMotor | None = ...,
        rubs: _Literal['load', 'motor', 'both'] = ...,
        load: _Given = ...,
        offset: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class TwoMassCapsule(_TwoMassCapsule):
    first: InnerMass
    second: InnerMass
    def __init__(
        self,
        *,
        capsule_mass: _Given,
        first: _InnerMass,
        second: _InnerMass,
        gravity: _Given = ...,
        incline: _Given = ...,
        squeeze: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class VelocityLoop(_VelocityLoop):
    def __init__(
        self,
        *,
        gain: _Given,
    ) -> None: ...

__all__ = [
    "Axis",
    "BlockChain",
    "BoundedMechanism",
    "Capsule",
    "Coil",
    "Contact",
    "ContactInputs",
    "CurrentLoop",
    "DCMotor",
    "Guide",
    "InnerMass",
    "LOOPS",
    "Link",
    "MECHANISMS",
    "MOTORS",
    "MatrixMechanism",
    "Mechanism",
    "Motor",
    "MotorLoop",
    "PIDAxis",
    "Pendulum",
    "PendulumCart",
    "PositionLoop",
    "Prescribed",
    "Robot",
    "RobotDescription",
    "RobotJoint",
    "SampledLoop",
    "SerialArm",
    "SoftStop",
    "SpringBlock",
    "Stop",
    "Torque",
    "TowedBlock",
    "TwoFeet",
    "TwoLinkArm",
    "TwoMassAxis",
    "TwoMassCapsule",
    "VelocityLoop",
    "contact_inputs",
    "drives",
    "gear_inputs",
    "given_inputs",
    "mechanisms",
    "read_urdf",
    "slip_names",
    "static_normal_force",
    "static_normal_forces",
    "stops_between",
    "stops_of",
]
