"""The block in Drake's MultibodyPlant: as a hydroelastic box, and on four spheres as feet."""

import functools
import logging

from benchmarks.block.problem import HEIGHT, MU_K, MU_S, SETTLE, SIDE, G, M, Places, Run, pushes
from benchmarks.peers import BOTH, ONE, Engine, StallError

FOOT = 0.01
"""Radius of a foot [m]."""


def material(stiffness: float | None = None, rigid: bool = False) -> object:
    """Return friction, and what a hydroelastic contact needs."""
    from pydrake.geometry import (
        AddCompliantHydroelasticProperties,
        AddContactMaterial,
        AddRigidHydroelasticProperties,
        ProximityProperties,
    )
    from pydrake.multibody.plant import CoulombFriction

    properties = ProximityProperties()
    AddContactMaterial(friction=CoulombFriction(MU_S, MU_K), properties=properties)
    if stiffness is not None:
        AddCompliantHydroelasticProperties(HEIGHT, stiffness, properties)
    elif rigid:
        AddRigidHydroelasticProperties(HEIGHT, properties)
    return properties


def add_block(plant: object, box: bool) -> object:
    """Add ground and block, and return the block."""
    from pydrake.geometry import Box, HalfSpace, Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.tree import SpatialInertia

    ground = HalfSpace.MakePose([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    world = plant.world_body()
    plant.RegisterCollisionGeometry(world, ground, HalfSpace(), "ground", material(rigid=box))
    size = (SIDE, SIDE, HEIGHT)
    block = plant.AddRigidBody("block", SpatialInertia.SolidBoxWithMass(M, *size))
    shapes = [(Box(*size), (0.0, 0.0, 0.0))]
    if not box:
        x, z = SIDE / 2 - FOOT, FOOT - HEIGHT / 2
        shapes = [(Sphere(FOOT), (i * x, j * x, z)) for i in (-1, 1) for j in (-1, 1)]
    for i, (shape, place) in enumerate(shapes):
        plant.RegisterCollisionGeometry(
            block, RigidTransform(place), shape, f"shape {i}", material(1e7 if box else None)
        )
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -G])
    plant.Finalize()
    return block


def add_simulator(
    settings: dict[str, object], box: bool, accuracy: float | None
) -> tuple[object, object, object]:
    """Return simulator, plant and block."""
    from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    # TAMSI is deprecated, and says so each time
    logging.getLogger("drake").setLevel(logging.ERROR)
    builder = DiagramBuilder()
    try:
        plant, _ = AddMultibodyPlant(MultibodyPlantConfig(**settings), builder)
    except RuntimeError as refused:
        raise StallError(str(refused)) from refused
    block = add_block(plant, box)
    simulator = Simulator(builder.Build())
    if accuracy is not None:
        simulator.get_mutable_integrator().set_target_accuracy(accuracy)
    return simulator, plant, block


def build(
    settings: dict[str, object], box: bool, accuracy: float | None, hold: float, seconds: float
) -> Run:
    from pydrake.math import RigidTransform
    from pydrake.multibody.math import SpatialForce
    from pydrake.multibody.plant import ExternallyAppliedSpatialForce

    simulator, plant, block = add_simulator(settings, box, accuracy)
    push = ExternallyAppliedSpatialForce()
    push.body_index = block.index()

    def own_context() -> object:
        return plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())

    def advance(force: float, end: float) -> float:
        push.F_Bq_W = SpatialForce([0.0, 0.0, 0.0], [force, 0.0, 0.0])
        plant.get_applied_spatial_force_input_port().FixValue(own_context(), [push])
        simulator.AdvanceTo(end)
        return float(plant.EvalBodyPoseInWorld(own_context(), block).translation()[0])

    plant.SetFreeBodyPose(own_context(), block, RigidTransform([0.0, 0.0, HEIGHT / 2]))
    origin = advance(0.0, SETTLE)
    settled = simulator.get_context().Clone()

    def run() -> Places:
        simulator.reset_context(settled.Clone())
        simulator.Initialize()
        places = [advance(force, SETTLE + end) for force, _, end in pushes(hold, seconds)]
        return Places(before=places[-2] - origin, after=places[-1] - origin)

    return run


def engines() -> tuple[Engine, ...]:
    sap = {"discrete_contact_approximation": "sap"}
    tamsi = {"discrete_contact_approximation": "tamsi", "stiction_tolerance": 1e-8}
    smooth = {"time_step": 0.0, "stiction_tolerance": 1e-3}
    settings = (
        ("Drake, hydroelastic box, defaults (1 ms)", {}, True, None),
        ("Drake, feet, SAP, 1 ms", {**sap, "time_step": 1e-3}, False, None),
        ("Drake, feet, SAP, 0.1 ms", {**sap, "time_step": 1e-4}, False, None),
        ("Drake, feet, TAMSI, 1 ms, 1e-8 m/s", {**tamsi, "time_step": 1e-3}, False, None),
        ("Drake, feet, continuous, 1e-3 m/s", smooth, False, 1e-6),
    )
    return tuple(
        Engine(
            name=name,
            levels=BOTH if accuracy else ONE,
            build=functools.partial(build, setting, box, accuracy),
        )
        for name, setting, box, accuracy in settings
    )
