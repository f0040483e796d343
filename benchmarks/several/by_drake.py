"""The blocks in Drake's MultibodyPlant: balls on the ground, for joints have no dry friction."""

import functools
import logging

import numpy as np

from benchmarks.measuring import Missing
from benchmarks.peers import Engine
from benchmarks.several.problem import COUPLING, GROUND, Case, G, Run, levels, speeds

RADIUS, APART, SETTLE = 0.1, 1.0, 0.5
"""Radius of a ball and distance between two [m]; time to sink in, not measured [s]."""
COEFFICIENT = 1.0
"""Of the ground; that of a pair is 2 a b / (a + b)."""


def material(mu: float) -> object:
    from pydrake.geometry import AddContactMaterial, ProximityProperties
    from pydrake.multibody.plant import CoulombFriction

    properties = ProximityProperties()
    AddContactMaterial(friction=CoulombFriction(mu, mu), properties=properties)
    return properties


def add_blocks(plant: object, n: int) -> list[object]:
    """Add ground, blocks and springs; return the joints along the ground."""
    from pydrake.geometry import HalfSpace, Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.tree import (
        LinearSpringDamper,
        PrismaticJoint,
        PrismaticSpring,
        SpatialInertia,
        UnitInertia,
    )

    world = plant.world_body()
    ground = HalfSpace.MakePose([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    plant.RegisterCollisionGeometry(world, ground, HalfSpace(), "ground", material(COEFFICIENT))
    joints, bodies = [], []
    for i, level in enumerate(levels(n)):
        pair = level / G
        own = pair * COEFFICIENT / (2.0 * COEFFICIENT - pair)
        nothing = SpatialInertia(0.0, [0.0, 0.0, 0.0], UnitInertia(0.0, 0.0, 0.0))
        carrier = plant.AddRigidBody(f"carrier {i}", nothing)
        block = plant.AddRigidBody(f"block {i}", SpatialInertia.SolidSphereWithMass(1.0, RADIUS))
        along = plant.AddJoint(
            PrismaticJoint(
                f"x{i}", plant.AddFrame(fixed(world, [APART * i, 0.0, RADIUS], f"at {i}")),
                carrier.body_frame(), [1.0, 0.0, 0.0],
            )
        )  # fmt: skip
        plant.AddJoint(
            PrismaticJoint(f"z{i}", carrier.body_frame(), block.body_frame(), [0.0, 0.0, 1.0])
        )
        plant.RegisterCollisionGeometry(
            block, RigidTransform(), Sphere(RADIUS), f"ball {i}", material(own)
        )
        plant.AddForceElement(PrismaticSpring(along, 0.0, GROUND))
        if i:
            here = [0.0, 0.0, 0.0]
            plant.AddForceElement(
                LinearSpringDamper(bodies[-1], here, block, here, APART, COUPLING, 0.0)
            )
        joints.append(along)
        bodies.append(block)
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -G])
    plant.Finalize()
    return joints


def fixed(world: object, place: list[float], name: str) -> object:
    from pydrake.math import RigidTransform
    from pydrake.multibody.tree import FixedOffsetFrame

    return FixedOffsetFrame(name, world.body_frame(), RigidTransform(place))


def build(settings: dict[str, object], case: Case) -> Run:
    from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    logging.getLogger("drake").setLevel(logging.ERROR)  # TAMSI is deprecated, and says so
    builder, n = DiagramBuilder(), len(case.mechanism.coordinates)
    plant, _ = AddMultibodyPlant(MultibodyPlantConfig(**settings), builder)
    joints = add_blocks(plant, n)
    simulator = Simulator(builder.Build())
    own = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    simulator.AdvanceTo(SETTLE)
    for joint, speed in zip(joints, speeds(n), strict=True):
        joint.set_translation(own, 0.0)
        joint.set_translation_rate(own, float(speed))
    settled = simulator.get_context().Clone()

    def run() -> np.ndarray:
        simulator.reset_context(settled.Clone())
        simulator.Initialize()
        simulator.AdvanceTo(SETTLE + case.t_end)
        now = plant.GetMyContextFromRoot(simulator.get_context())
        return np.array([joint.get_translation(now) for joint in joints])

    return run


def engines(name: str, case: Case) -> tuple[Engine | Missing, ...]:
    if name != "chain":
        return (Missing(solver="Drake", word="cannot", reason="its joints have no dry friction"),)
    kinds = {"SAP": {}, "TAMSI": {"stiction_tolerance": 1e-8}}
    return tuple(
        Engine(
            name=f"Drake, balls on the ground, {label}, 1 ms",
            build=functools.partial(
                build,
                {"discrete_contact_approximation": label.lower(), "time_step": 1e-3, **more},
                case,
            ),
        )
        for label, more in kinds.items()
    )
