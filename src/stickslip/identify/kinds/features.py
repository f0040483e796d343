"""The force of a spring that pulls a block, compared by features of stick-slip.

The rows are frequency, mean and scatter of the force (`stickslip.identify.problems.stick_slip`).
What to measure next is what tells most of what is asked: which law holds, where some are not
distinguished, else the parameters of the law. Draws of each, as many of one as of another, are run
at other settings, with what differs from run to run (`stickslip.identify.propose`).
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.data import Measurement, sentences_of
from stickslip.engine.simulation import simulate
from stickslip.errors import InputError
from stickslip.friction import Coulomb, CoulombViscous, FrictionLaw, Stribeck
from stickslip.identify import THRESHOLDS
from stickslip.identify.bands import Array
from stickslip.identify.candidates import friction_of, in_sentence, specifications
from stickslip.identify.fits import starting_law
from stickslip.identify.kinds.kind import Column, Request, SeveralLaws
from stickslip.identify.kinds.simulated import (
    AnyFit,
    OtherSetting,
    SimulatedCandidate,
    SimulatedKind,
)
from stickslip.identify.problems.limit_cycles import SAMPLES, SETTLING, WATCHED
from stickslip.identify.problems.run_laws import UNKNOWN, laws_to_run, stands_on_top, usual_of
from stickslip.identify.problems.slip_features import (
    COMPARED,
    FEATURES,
    READ,
    features_of,
    towed,
)
from stickslip.identify.problems.stick_slip import (
    DOUBTS,
    MASS,
    SHARES,
    Setting,
    StickSlip,
)
from stickslip.identify.propose import width_after
from stickslip.identify.simulated import ENOUGH
from stickslip.mechanisms import Mechanism, TowedBlock, input_names
from stickslip.quantities import fields_of
from stickslip.quantities import vary as with_values
from stickslip.show.formatting import (
    joined,
    number,
    parameter_words,
    percent,
    quantity,
    signed_percent,
)

USUAL: tuple[type[FrictionLaw], ...] = (Coulomb, CoulombViscous, Stribeck)
"""Laws that are compared where none is named. Features hardly tell bristles, whose stiffness nobody
knows: laws with them are judged where they are named."""
NO_LEVEL = "it has no friction level that these features could determine"
OTHERS = {
    "speed": (0.03, 0.1, 0.3, 0.5, 2.0, 3.0, 10.0),
    "stiffness": (0.3, 3.0),
    "load": (0.5, 2.0),
}
"""Settings that are looked at as the next, over those of the first record."""
UNITS = {"speed": "m/s", "stiffness": "N/m", "load": "N"}


def _error_column(name: str) -> Column[SimulatedCandidate]:
    """Return the column of what a law leaves of a feature."""

    def error(one: SimulatedCandidate) -> float | None:
        return float(one.fit.details["errors"][name]) if one.fit else None

    def text(one: SimulatedCandidate) -> str | None:
        value = error(one)
        return None if value is None else signed_percent(round(value, 4))

    return Column(
        key=f"{name}_error", title=name.rpartition("_")[2], page=name.replace("_", "\n"),
        phone="label", label=name.replace("_", " "), value=error, text=text,
    )  # fmt: skip


class FeatureKind(SimulatedKind):
    """Limit cycles of a towed block, fitted to frequency, mean and standard deviation."""

    routes = (FEATURES,)
    measured = "the force of a spring"
    content = "spring force"
    settings = frozenset({"seed"})
    these = "these features"
    drawn = ("spring force over load", "1")
    own_columns = tuple(map(_error_column, COMPARED))

    def residual_text(self, error: float, request: Any) -> str:
        return f"residual of the features {number(error, 2)}"

    def known_inputs(self, mechanism: Mechanism, measurement: Measurement) -> Collection[str]:
        return input_names(mechanism)

    # what is measured
    def laws(self, laws: SeveralLaws | None) -> Mapping[str, Any]:
        return {
            specification.name: specification.law
            for specification in specifications(USUAL if laws is None else laws)
        }

    def refused(self, law: FrictionLaw | type[FrictionLaw]) -> str:
        known = fields_of(law if isinstance(law, type) else type(law))
        levels = [known[name].scale in ("level", "force") for name in usual_of(law)]
        return "" if any(levels) else NO_LEVEL

    def problem(
        self, request: Request, laws: Mapping[str, Any], vary: str | Sequence[str] | None
    ) -> StickSlip:
        towed(request.mechanism)
        block, result, doubts = laws_to_run(
            request.mechanism, laws, request.measurement, vary, request.fixed,
            start=_start, doubts=DOUBTS,
        )  # fmt: skip
        block = replace(towed(block), load=block.steady_load)
        return StickSlip(block, settings_of(block, request.measurement), result, doubts)

    def errors(self, fit: AnyFit, measurement: Measurement) -> Mapping[str, float]:
        block = replace(fit.problem.mechanism, load=towed(fit.mechanism).steady_load)
        if measurement.overrides:
            block = with_values(block, "mechanism", measurement.overrides)
        observed = features_of(measurement, mechanism=block).compared
        mode = fit.problem.cycles(fit.name, fit.family.mode[None], [block])[0, 0]
        return dict(zip(COMPARED, (mode / observed - 1.0).tolist(), strict=True))

    def foreseen(self, fit: AnyFit, setting: TowedBlock) -> Array:
        return draws_of(fit, [towed(setting)], 2 * int(ENOUGH))[:, 0]

    # seven texts
    def called(self, fit: AnyFit) -> str:
        return friction_of(fit.law.title)

    def fault(self, fit: AnyFit) -> str:
        errors = fit.details["errors"]
        missed = [f"{name.replace('_', ' ')} by {signed_percent(errors[name])}"
                  for name in fit.details["missed"]]  # fmt: skip
        return f"misses {joined(missed)}" if missed else ""

    def about(self, fit: AnyFit) -> str:
        features, records = fit.problem.first.features, len(fit.problem.settings)
        off = [f"{name.replace('_', ' ')} {signed_percent(x)}"
               for name, x in fit.details["errors"].items()]  # fmt: skip
        text = f"Its limit cycle is off by {joined(off)}"
        if fit.rms < THRESHOLDS.negligible:
            size = percent(THRESHOLDS.negligible)
            text = f"Its limit cycle has frequency, mean and scatter to {size}"
        of = f" (first of {records} records)" * (records > 1)
        seen = (
            f"Measured{of}: {features.regime} at {quantity(features.frequency, 'Hz')}, mean"
            f" {number(features.mean)} and standard deviation"
            f" {number(features.standard_deviation)} of the load."
        )
        said = [f"{text}.", seen, *sentences_of(features.findings, "slips")]
        if _frees_mass(fit):
            said.append(f"The effective mass is {fit.estimate(MASS).plus_minus}.")
        return " ".join(said)

    def untold(self, fit: AnyFit) -> Iterator[str]:
        features, doubts = fit.problem.first.features, fit.problem.doubts
        yield from sentences_of(features.findings, "scatter", "drift")
        stated = [parameter_words(path) for path in doubts if fit.family.is_prior(path)]
        if stated:
            yield f"The {joined(stated)}: the features determine no more than was stated."
        if _frees_mass(fit):
            yield (
                "Why the effective mass differs: a spring stiffer than stated, or a rocking body,"
                " has the same effect."
            )
        elif features.too_fast:
            yield from sentences_of(features.findings, "frequency")
        if len(fit.problem.settings) == 1:
            yield "How much friction differs from run to run: there is one record."
        if features.regime == "stick-slip":
            yield (
                "A limit cycle repeats exactly: the scatter of an irregular record increases its"
                " standard deviation and appears as larger slips."
            )
        yield (
            "An offset of the force sensor adds to the level at rest and in motion alike: the force"
            " does not reverse."
        )

    def advice(
        self, fit: AnyFit, others: Sequence[AnyFit], advised: Sequence[Any]
    ) -> Iterator[str]:
        features, free = fit.problem.first.features, _frees_mass(fit)
        if features.too_fast and not free:
            yield (
                "Fit the mass as well: vary=['friction.*', 'mechanism.mass'], or --vary"
                " 'friction.*,mass'. The nominal mass cannot oscillate as fast as measured."
            )
        for item in advised[:1]:
            titles = {each.name: in_sentence(each.law.title) for each in (fit, *others)}
            said = [f"{titles[name]} predicts {motion(x)}" for name, x in item.predicted.items()]
            yield (
                f"Pull again at a {item.name} of {quantity(item.value, UNITS[item.name])}, and give"
                f" both records as trials: {item.expectation(others)}. There {'; '.join(said)}."
            )
        if free:
            yield (
                "Weigh the moving parts and load the spring with a known weight: the effective mass"
                " implies that the mass or the stiffness is not as stated, or that the body is not"
                " rigid."
            )
        if features.drifts:
            yield "Repeat the pull after further passes, until the mean no longer drifts."

    # further numbers and figures
    def details(self, fit: AnyFit) -> Mapping[str, Any]:
        problem, errors = fit.problem, fit.problem.errors(fit.family, fit.name)
        first = problem.modes(fit.family, fit.name)[problem.settings.index(problem.first)]
        # laws of friction are right to some per cent, and scatter is a difference of levels
        limits = THRESHOLDS.material * SHARES
        return {
            "observed": problem.first.features.to_dict(),
            "predicted": dict(zip(COMPARED, first.tolist(), strict=True)),
            "errors": errors,
            "missed": [name for (name, error), limit in zip(errors.items(), limits, strict=True)
                       if not abs(error) <= limit],
        }  # fmt: skip

    def advised(self, fits: Sequence[AnyFit]) -> Sequence[OtherSetting]:
        """Return what the closest law and its rivals predict elsewhere, the most telling first."""
        problem = fits[0].problem
        first = problem.first
        values, blocks = [], []
        for name, factors in OTHERS.items():
            for factor in factors:
                value = factor * float(getattr(first.block, name))
                block: TowedBlock = with_values(
                    first.block, "mechanism", {f"mechanism.{name}": value}
                )
                if all(block != setting.block for setting in problem.settings):
                    values.append((name, value))
                    blocks.append(block)
        every = [draws_of(fit, blocks, int(ENOUGH)) for fit in fits]
        shares = [fit.posterior.shares[fit.name] for fit in fits]
        chosen = np.linspace(0, len(fits[0].family.points) - 1, int(ENOUGH)).astype(np.intp)
        points = fits[0].family.points[chosen, : len(problem.laws[fits[0].name].free)]
        result = []
        for k, (name, value) in enumerate(values):
            rows = [features[:, k] for features in every]
            works = [np.isfinite(row).all(axis=1) for row in rows]
            if not min(float(np.mean(row[:, 0] > 0.0)) for row in rows) > 0.8:  # NaN is no cycle
                continue  # a record of steady sliding has no features
            predicted = {
                fit.name: dict(zip(COMPARED, np.median(row[ok], axis=0).tolist(), strict=True))
                for fit, row, ok in zip(fits, rows, works, strict=True)
            }
            least = READ * first.features.compared
            seen = [np.log(np.maximum(row[ok], least)) for row, ok in zip(rows, works, strict=True)]
            width = width_after(points[works[0]], seen, shares)
            result.append(OtherSetting(name, value, predicted, width))
        return tuple(sorted(result, key=lambda item: item.expected_width))

    def pieces(
        self, fit: AnyFit, others: Sequence[AnyFit]
    ) -> Sequence[tuple[str, Array, Array, Mapping[str, Array]]]:
        if len(fit.problem.settings) > 1:
            return ()  # the limit cycle is that of the block as it is stated
        return [cycles_of(fit)]


def _frees_mass(fit: AnyFit) -> bool:
    """Return whether the mass is looked for, not only known to what is stated of it."""
    return bool(fit.problem.doubts.get(MASS, 0.0) >= UNKNOWN)


def settings_of(block: TowedBlock, measurement: Measurement) -> list[Setting]:
    """Return the records with the block as it was set."""
    result = []
    for record in measurement.records():
        own = towed(with_values(block, "mechanism", record.overrides))
        features = features_of(record, mechanism=own)
        if not features.mean > 0.0:
            raise InputError(
                f"the mean spring force over the load is {number(features.mean)} and must be above"
                " 0: count force and speed positive in the direction of the pull, with a gain such"
                ' as gain={"spring_force": -1}, or correct the offset of the force.'
            )
        result.append(Setting(block=own, features=features))
    if all(item.slides for item in result):
        features = result[0].features
        raise InputError(
            "the force is that of steady sliding: its standard deviation is"
            f" {percent(features.standard_deviation / features.mean)} of its mean, so there is"
            f" no stick-slip to compare. Its mean is friction at {quantity(block.speed, 'm/s')}:"
            " pull at several speeds, and give velocity and friction as a table."
        )
    return result


def _start(block: TowedBlock, law: FrictionLaw | type[FrictionLaw]) -> FrictionLaw:
    """Return a law with a static level and, of a type, bristles stiffer than the spring."""
    load = block.steady_load
    start = starting_law(law, float(load)) if isinstance(law, type) else law
    changes: dict[str, float] = {}
    stiffness = 30.0 * block.stiffness / load  # softer bristles would swing instead of the spring
    damping = math.sqrt(stiffness * block.mass / load)
    sizes = {"stiffness": stiffness, "damping": damping, "slope": 0.0}
    known = fields_of(type(start))
    for name, item in known.items():
        base, size = item.at_least, sizes.get(item.scale)
        if base is not None and not stands_on_top(known, item):
            if getattr(start, name) is None:
                changes[f"friction.{name}"] = 1.2 * getattr(start, base)
        elif isinstance(law, type) and size is not None and item.allows(size):
            changes[f"friction.{name}"] = size
    return with_values(start, "friction", changes) if changes else start


def draws_of(fit: AnyFit, blocks: Sequence[TowedBlock], count: int) -> Array:
    """Return draws of the features (k, b, 3) of another run at settings; NaN of failed runs."""
    which = np.linspace(0, len(fit.family.points) - 1, count).astype(np.intp)
    return np.asarray(fit.problem.foreseen(fit.name, fit.family, blocks, which))


def motion(predicted: Mapping[str, float]) -> str:
    """Return a predicted limit cycle in words."""
    if not predicted["frequency"] > 0.0:
        return "steady sliding"
    spread = number(predicted["standard_deviation"])
    return f"{quantity(predicted['frequency'], 'Hz')} and a standard deviation of {spread}"


# The figure.


def limit_cycle(fit: AnyFit, t: Array) -> Array:
    """Return the force of the spring in the fitted limit cycle (n,) [N] at times [s] from 0 on."""
    features, block = fit.problem.first.features, towed(fit.mechanism)
    times = SETTLING / features.frequency + np.asarray(t, dtype=float)
    start = {"x": -features.mean * block.steady_load / block.stiffness}
    run = simulate(block, fit.law, t_end=float(times.max()), y0=start).at(times)
    force = block.stiffness * (block.speed * times - np.asarray(run["x"]))
    return np.asarray(force + block.damping * (block.speed - np.asarray(run["v"])))


def cycles_of(fit: AnyFit) -> tuple[str, Array, Array, Mapping[str, Array]]:
    """Return some cycles about the middle of a record: times, and forces (n,) over the load.

    These are measured, and those of the fitted limit cycle, shifted to lie nearest.
    """
    record, load = fit.measurement.records()[0], fit.problem.settings[0].block.steady_load
    time, force = np.asarray(record.time), np.asarray(record.values("spring_force")) / load
    period = 1.0 / fit.problem.first.features.frequency
    kept = np.abs(time - 0.5 * (time[0] + time[-1])) <= 0.5 * WATCHED * period
    t, measured = time[kept] - time[kept][0], force[kept]
    fine = np.linspace(0.0, float(t[-1]) + period, 40 * (WATCHED + 1) + 1)
    cycle = limit_cycle(fit, fine) / towed(fit.mechanism).steady_load
    shifts = np.linspace(0.0, period, SAMPLES, endpoint=False)
    shifted = [np.interp(t + s, fine, cycle) for s in shifts]
    best = min(shifted, key=lambda y: float(np.sum((y - measured) ** 2)))
    return "some cycles, in their nearest phase", t, measured, {fit.law.title: best}
