"""Mechanisms: equations of motion without friction, each one a file."""

from stickslip.lazy import attach

MECHANISM_MODULES = {
    "SpringBlock": "blocks",
    "TowedBlock": "blocks",
    "Axis": "axes",
    "TwoMassAxis": "axes",
    "Pendulum": "axes",
    "PendulumCart": "capsules",
    "Capsule": "capsules",
    "TwoMassCapsule": "capsules",
    "BlockChain": "blocks",
    "ClutchTrain": "brakes",
    "DiscBrake": "brakes",
    "TwoFeet": "blocks",
    "TwoLinkArm": "robots",
    "SerialArm": "robots",
    "Robot": "robots",
}
"""The mechanisms in the order of listings, with their modules: all that registers one."""

HOMES = {
    **MECHANISM_MODULES,
    "BoundedMechanism": "base",
    "Contact": "base",
    "ContactInputs": "base",
    "CurrentLoop": "electric_motor",
    "DCMotor": "electric_motor",
    "Guide": "base",
    "InnerMass": "capsules",
    "LOOPS": "electric_motor",
    "Lining": "brakes",
    "Link": "robots",
    "MECHANISMS": "registry",
    "MOTORS": "capsules",
    "MatrixMechanism": "base",
    "Mechanism": "base",
    "Motor": "capsules",
    "MotorLoop": "electric_motor",
    "PositionLoop": "electric_motor",
    "Prescribed": "capsules",
    "RobotDescription": "urdf",
    "RobotJoint": "robots",
    "Rotor": "brakes",
    "SampledLoop": "electric_motor",
    "SoftStop": "capsules",
    "Stop": "base",
    "Torque": "capsules",
    "VelocityLoop": "electric_motor",
    "gear_inputs": "base",
    "given_inputs": "base",
    "mechanisms": "registry",
    "read_urdf": "urdf",
    "slip_names": "base",
    "static_normal_force": "base",
    "static_normal_forces": "base",
    "stops_between": "base",
    "stops_of": "base",
}

INSIDE = {
    "LINKS": "base",
    "LinearOrRotary": "base",
    "LoopMemory": "electric_motor",
    "PREFIX": "base",
    "WHOLE": "base",
    "as_rotary": "base",
    "canonical_path": "base",
    "checked_contacts": "base",
    "coordinate_of": "robots",
    "cycle_of": "base",
    "cycle_or_none": "base",
    "driven_by_motor": "electric_motor",
    "driving_inertia": "electric_motor",
    "given_names": "base",
    "has_macros": "urdf",
    "has_one_slip": "base",
    "input_field": "base",
    "input_names": "base",
    "joint_places": "rigid_bodies",
    "load_stated": "base",
    "motor_of": "electric_motor",
    "motors_of": "electric_motor",
    "normal_of": "base",
    "of_contact": "base",
    "only_contact": "base",
    "quantity_at": "base",
    "refuse_sampling": "electric_motor",
    "repeats": "base",
    "slip_among": "base",
    "slip_of": "base",
    "slipping": "base",
    "slips_by_angle": "base",
    "told_fields": "base",
    "urdf_joints": "urdf",
    "within_limit": "electric_motor",
    "without_given": "base",
}
"""Names that other subpackages use, and that are not part of the public interface."""

NAMESPACES = ("contact_inputs", "drives")
"""Public modules, which are attributes without an import of their own."""

__all__ = sorted([*HOMES, *NAMESPACES])  # noqa: PLE0605  # read off the tables above

__getattr__, __dir__ = attach(__name__, HOMES, NAMESPACES, inside=INSIDE)
