"""Generated functions of a model, asked by number.

The vector of a run names them at ADDRESS. All read that vector: the numbers of drives and
parameters, and what stands from the place `at` on. They write to the place `to` and after it.

Where one contact rubs, they are the equations of each mode. Where several do, they are parts of
the equations, which no mode enters: forces, mass matrix, loads, and each law once per structure.
"""

from stickslip.kernels.backend import Vector, Wholes, call_model
from stickslip.kernels.state_layout import ADDRESS, CONSTANTS

ANY_RATE = 0.7309
"""A rate [m/s or rad/s] that no threshold is likely to have: it tells what depends on rates."""
FIELD = 0
JACOBIAN = 1
TIME_SLOPE = 2
GUARDS = 3
GUARD_SLOPES = 4
LINEAR = 5
CONTACT = 6
POWER = 7
MARGINS = 8
REST = 9
ENERGY = 10
FIELD_SLOPES = 11
GUARD_PARAMETERS = 12
WALLS_OF = 13
FORCES = 14
MASSES = 15
LOADS = 16
GEOMETRY = 17
FORCE_SLOPES = 18
PART_SLOPES_OF = 19
EFFORTS = 20
LIMITS = 21
TURNING = 22
LOOPS_OF = 23
CONSTANTS_OF = 24
IMPACT = 25
IMPACT_SLOPES = 26
IMPACT_PARAMETERS = 27
WAVES_OF = 28
MARGIN_SLOPES_OF = 29
CALLED: tuple[str, ...] = (
    "field",
    "jacobian",
    "time_slope",
    "guards",
    "guard_slopes",
    "linear",
    "contact",
    "power",
    "margins",
    "rest",
    "energy",
    "field_slopes",
    "guard_parameters",
    "walls",
    "forces",
    "masses",
    "loads",
    "geometry",
    "force_slopes",
    "part_slopes",
    "efforts",
    "limits",
    "turning",
    "loops",
    "constants",
    "impact",
    "impact_slopes",
    "impact_parameters",
    "waves",
    "margin_slopes",
)
"""Names of the generated functions by these numbers."""
LAW = 1000
"""Law k of a model with several contacts has this number and k."""
LAW_MARGINS = 1_000_000
"""The margins of its switches have this number and k."""
LAW_SLOPES_OF = 2_000_000
"""Its slopes have this number and k."""
LAW_MARGIN_SLOPES = 3_000_000
"""The slopes of the margins have this number and k."""


def evaluate(name: int, mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Call one function of the equations in any mode."""
    call_model(w, ADDRESS, name, mode, flags, t, at, to)


def put_constants(w: Vector, whole: Wholes) -> None:
    """Write what the equations need of parameters alone, where there is such a thing."""
    if whole[CONSTANTS] > 0:
        evaluate(CONSTANTS_OF, 0, 0, 0.0, w, 0, whole[CONSTANTS])
