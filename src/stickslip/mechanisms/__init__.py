"""Mechanisms: equations of motion without friction, each one a file."""

from stickslip.lazy import attach

MECHANISM_MODULES = {
    "SpringBlock": "spring_block",
    "TowedBlock": "towed_block",
    "Axis": "axis",
    "TwoMassAxis": "two_mass_axis",
    "Pendulum": "pendulum",
    "PendulumCart": "pendulum_cart",
    "Capsule": "capsule",
    "BlockChain": "block_chain",
    "ClutchTrain": "clutch_train",
    "DiscBrake": "disc_brake",
    "TwoFeet": "two_feet",
    "TwoLinkArm": "two_link_arm",
    "SerialArm": "serial_arm",
    "Robot": "robot",
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
    "LOOPS": "electric_motor",
    "Lining": "lining",
    "Link": "serial_arm",
    "MECHANISMS": "registry",
    "MOTORS": "actuators",
    "MatrixMechanism": "matrix_mechanism",
    "Mechanism": "base",
    "Motor": "actuators",
    "MotorLoop": "electric_motor",
    "PositionLoop": "electric_motor",
    "Prescribed": "actuators",
    "RobotDescription": "urdf",
    "RobotJoint": "robot",
    "Rotor": "clutch_train",
    "Stop": "base",
    "Torque": "actuators",
    "VelocityLoop": "electric_motor",
    "gear_inputs": "base",
    "given_inputs": "told_inputs",
    "mechanisms": "registry",
    "read_urdf": "urdf",
    "slip_names": "contacts",
    "static_normal_force": "contacts",
    "static_normal_forces": "contacts",
    "stops_between": "base",
    "stops_of": "base",
}

INSIDE = {
    "LINKS": "base",
    "LinearOrRotary": "base",
    "Mechanism": "base",
    "WHOLE": "drive_period",
    "as_rotary": "base",
    "checked_contacts": "contacts",
    "coordinate_of": "robot",
    "cycle_of": "drive_period",
    "cycle_or_none": "drive_period",
    "driving_inertia": "electric_motor",
    "given_names": "told_inputs",
    "has_macros": "urdf",
    "has_one_slip": "contacts",
    "input_field": "told_inputs",
    "input_names": "told_inputs",
    "joint_places": "rigid_bodies",
    "motor_of": "electric_motor",
    "normal_of": "contacts",
    "of_contact": "told_inputs",
    "only_contact": "contacts",
    "repeats": "drive_period",
    "slip_among": "contacts",
    "slip_of": "contacts",
    "slipping": "contacts",
    "slips_by_angle": "contacts",
    "stops_of": "base",
    "told_fields": "told_inputs",
    "urdf_joints": "urdf",
    "without_given": "told_inputs",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES | INSIDE)
