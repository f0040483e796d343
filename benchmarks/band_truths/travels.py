"""Travels of rigs with known friction: laws inside the vocabulary, laws outside, and wrong rigs.

Rigs and laws of the vocabulary are those of `benchmarks.travel_truth`: a block that leaves its
spring, one that stays fastened, an axis that is pushed, and a capsule. Of `OUTSIDE`, two are laws
that are not compared, and one gives the judge a stiffness or an inertia that is 5 % wrong. Of
`SCATTERED`, every run scatters by 3 %, and three repeats of each setting show it.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.band_truths.rig import VISCOUS, Array, Points, Rig
from benchmarks.travel_truth import STEPS, TRUTHS, TravelRig, draw, readings, unseen
from stickslip import Measurement, fit
from stickslip.friction import law_type
from stickslip.quantities import parameters, vary

SETS = ("free", "attached", "axis", "free", "attached", "axis", "capsule")
SCATTERED = "scattered"
OUTSIDE = ("saturating", "falling power", "wrong rig")
POWERS = ("power-viscous", "falling power", "saturating")
WRONG, SCATTER = 1.05, 0.03
SATURATING: Any = law_type("saturating-viscous")
FALLING: Any = law_type("stribeck-power")


def set_of(number: int) -> str:
    """Return of which set a rig is, by its number."""
    return SETS[(number // len((*TRUTHS, SCATTERED, *OUTSIDE))) % len(SETS)]


def drawn(number: int, seed: int) -> Rig:
    """Return a rig by number and seed: its measurement, and the truth at other settings."""
    random = np.random.default_rng([seed, number])
    truths = (*TRUTHS, SCATTERED, *OUTSIDE)
    truth = truths[number % len(truths)]
    set_ = set_of(number)
    plain = truth if truth in TRUTHS else "stribeck" if truth == "falling power" else (
        "coulomb-viscous")  # fmt: skip
    rig = draw(random, set_, plain)
    rig = replace(rig, law=_changed(rig, truth))
    measurement = readings(rig, random)
    mechanism, error = rig.mechanism, rig.error
    if truth == "wrong rig":
        path = STEPS[rig.kind]
        known = {p: value for p, _, value in parameters(mechanism, "mechanism")}
        mechanism = vary(mechanism, "mechanism", {path: WRONG * known[path]})
    if truth == SCATTERED:
        measurement = _scattered(rig, random)
        error = SCATTER * float(np.mean([rig.travel(x) for x in rig.settings]))
    asked = unseen(rig)
    within = asked <= max(rig.settings)

    def travels(points: Points) -> Array:
        return np.array([rig.travel(x) for x in points.velocity])

    def fitted(points: Points) -> Array:
        law = fit(mechanism, type(rig.law), measurement, t_end=rig.t_end).law
        return np.array([rig.travel(x, law) for x in points.velocity])

    def more(places: Points, number: int) -> Rig:
        own = np.random.default_rng([number, 1])
        again = readings(replace(rig, settings=tuple(places.velocity), repeats=1), own)
        trials = (*measurement.trials, *again.trials)
        return result.with_(measurement=Measurement(trials=trials))

    result = Rig(
        kind="travels",
        truth=f"{truth} ({rig.kind})" if set_ == "capsule" else truth,
        inside=truth not in OUTSIDE,
        measurement=measurement,
        mechanism=mechanism,
        family=None if truth in OUTSIDE else frozenset({rig.law.name}),
        curves=(travels,),
        noise=lambda points: np.full(len(points), error),
        asked=Points(velocity=asked[within]),
        beyond=Points(velocity=asked[~within]),
        parameters={
            path.rpartition(".")[2]: value
            for path, _, value in parameters(rig.law, "friction")
            if not (path.endswith(VISCOUS) and truth in POWERS)  # of another power of the speed
        },
        fitted=None if truth in OUTSIDE else fitted,
        more=None if truth == SCATTERED else more,
        t_end=rig.t_end,
    )
    return result


def _changed(rig: TravelRig, truth: str) -> Any:
    """Return the law of a rig, of another kind where that is asked."""
    known = {path.rpartition(".")[2]: x for path, _, x in parameters(rig.law, "friction")}
    if truth == "saturating":
        speed = known["kinetic_coefficient"] / max(known["viscous_coefficient"], 1e-9)
        return SATURATING(
            kinetic_coefficient=known["kinetic_coefficient"],
            viscous_coefficient=3.0 * known["viscous_coefficient"],
            saturation_velocity=0.3 * speed,
        )
    if truth == "falling power":
        known.pop("break_away_coefficient", None)
        known.pop("fading_exponent", None)
        return FALLING(**known, viscous_exponent=0.5)
    return rig.law


def _scattered(rig: TravelRig, random: np.random.Generator) -> Measurement:
    """Return three readings of each setting, each of a run with friction of its own."""
    trials = []
    for x in rig.settings:
        true = rig.travel(x)
        for _ in range(3):
            trials.append(
                Measurement(
                    travel=true * (1.0 + SCATTER * random.normal()),
                    uncertainty=rig.error,
                    overrides={rig.path: x},
                )
            )
    return Measurement(trials=tuple(trials))
