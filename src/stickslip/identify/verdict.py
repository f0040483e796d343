"""The verdict: a law, a band over all candidate laws, and what would narrow it."""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.data import (
    LawEstimates,
    Measurement,
    as_turning,
    levels_at,
    refuse_lack,
    refuse_same,
    tells_load,
)
from stickslip.errors import InputError
from stickslip.friction import PARTS, FrictionLaw, laws
from stickslip.identify.bands import LEVEL, Foreseen, Interval, PredictionBand, RunCertificate
from stickslip.identify.candidates import Candidate, JudgedFit, Verdict, score_scale
from stickslip.identify.fits import (
    Estimate,
    as_level,
    estimates_for,
    inputs_text,
    typical_inputs,
    unit_of,
)
from stickslip.identify.judgement import Finding, Judgement
from stickslip.identify.laws import RIG_QUANTITIES, Composition
from stickslip.identify.posterior import Array, Family, Structure, family_of
from stickslip.identify.wording import (
    unphysical_sentence,
    usual_sentence,
)
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import Quantity, fields_of, parameters, turned
from stickslip.show.formatting import Scale, interval, joined, number, with_unit

if TYPE_CHECKING:
    from stickslip.identify.figures import BandDrawing
    from stickslip.show.display import Drawing, Target

TO_LIMIT = 0.05
"""Lower end over the upper one, counted from where a parameter cannot be, up to which it may be
there: it is .05 of a normal estimate 1.5 deviations above, held to what can be."""


@dataclass(frozen=True, kw_only=True, repr=False)
class LawFit(JudgedFit[FrictionLaw]):
    """A law of the set with its parameters and their intervals."""

    judgement: Judgement
    """The posterior of the force balance, projected on the laws."""
    structure: Structure
    """The terms of the law."""
    largest_speed: float
    """Largest speed that was measured [m/s] or [rad/s]."""
    correlation: Array
    """Correlation of the estimates (p, p)."""
    verdict: "BandVerdict | None" = None
    """What is said of the fit: the verdict of a selection with this law alone; None in one."""
    lacking: tuple[str, ...] = ()
    """What of its structure the law has otherwise, or not at all, in sentences."""

    def law_estimates(self) -> LawEstimates:
        # a law through levels lacks what its structure has
        known = {path for path, _, _ in parameters(self.law, "friction")}
        kept = [k for k, estimate in enumerate(self.estimates) if estimate.path in known]
        return estimates_for(
            self.law,
            [self.estimates[k] for k in kept],
            self.correlation[np.ix_(kept, kept)],
            levels=levels_at(self.mechanism),
            largest_speed=self.largest_speed,
        )

    def predict(self, measurement: Measurement) -> Foreseen:
        """Return readings of another measurement beside their band, as a verdict does.

        Parameters
        ----------
        measurement : Measurement
            What another run gave, as was fitted.

        Returns
        -------
        Foreseen
            Readings (n,), their band, the share in it, the error, and that of Coulomb + viscous
            friction by least squares.

        Raises
        ------
        InputError
            If it lacks what was fitted, has the same readings, or the fit is a verdict's.
        """
        if self.verdict is None:
            raise InputError("this fit is part of a verdict: call predict of the verdict.")
        return self.verdict.predict(measurement)

    def to_dict(self) -> Mapping[str, Any]:
        result = super().to_dict()
        if self.verdict is None:
            return result
        within = self.verdict.closest.distance
        return {**result, "within": within, "correlation": self.correlation.tolist()}

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.identify.figures import plot_band  # loads matplotlib

        rows = self.judgement.problem.asked()
        drawing = drawing_of(
            self.judgement,
            self.measurement,
            self.law.title,
            speeds=rows.velocity,
            band=self.judgement.band(rows),
        )
        return plot_band(drawing, ax)


@dataclass(frozen=True, kw_only=True, repr=False)
class LawCandidate(Candidate[LawFit]):
    """A family of structures, as the table of a verdict shows it."""

    structure: Structure
    """The best structure of the family."""
    share: float
    """Probability of the family."""
    left: float
    """Root mean square of what the law leaves [N]."""
    count: int
    """Number of parameters."""
    distance: float
    """Share of friction within which the law stays at 95 % of the places."""
    worst: float
    """Largest share of friction by which it is off ..."""
    worst_at: float
    """... and the velocity there [m/s] or [rad/s]."""

    @property
    def family(self) -> Family:
        """Names of its terms."""
        return family_of(self.structure)

    @property
    def law(self) -> FrictionLaw | None:
        """The fitted law."""
        return self.fit.law if self.fit else None

    @property
    def parameters(self) -> int:
        return self.count

    @property
    def score(self) -> float | None:
        return self.left

    def to_row(self) -> Mapping[str, Any]:
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.count,
            "leaves": self.left,
            "share": self.share,
            "within": self.distance,
            "worst": self.worst,
            "worst_at": self.worst_at,
            "outcome": self.outcome,
        }


@dataclass(frozen=True, kw_only=True, repr=False)
class BandVerdict(Verdict[LawCandidate]):
    """Which law to use, and what friction is over all candidate laws."""

    judgement: Judgement
    """What the verdict is read from."""
    speeds: Array
    """Velocities (n,) over which the verdict states the band [m/s] or [rad/s]."""
    friction: PredictionBand
    """Band of the friction there [N] or [N m]."""
    other_specimen: PredictionBand | None = None
    """Band of friction of another run or specimen there, where several were measured."""
    route_name: str
    """Route that made it."""
    second: Measurement | None = None
    """The second measurement, which no fit has seen; None without one."""
    foreseen: Foreseen | None = field(default=None, repr=False)
    """Readings of the second measurement beside what was foreseen of them."""
    foreseer: Callable[[Measurement], Foreseen] = field(repr=False)
    """Foresees readings of another measurement."""
    shrinks: float = 1.0
    """Expected width of the band after what is proposed, over today's."""
    halves: int | None = None
    """Number of such readings, or stretches, expected to halve the band; None if too many."""
    places: tuple[float, ...] = ()
    """Velocities that are proposed [m/s] or [rad/s]."""
    conditions: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    """Loads [N] and inputs of the contact [SI] at these, by name, where several were measured."""
    certificate: RunCertificate | None = None
    """How closely a run of law and mechanism follows the measured motion; None without a motion
    that a known force drives, such as of a table."""

    @property
    def route(self) -> str:
        return self.route_name

    @property
    def score_unit(self) -> str:
        return self.measurement.unit("friction")

    @property
    def inside(self) -> float:
        """Share of the readings of the second measurement in their band; NaN without one."""
        return math.nan if self.foreseen is None else self.foreseen.inside

    def predict(self, measurement: Measurement) -> Foreseen:
        """Return readings of another measurement of the same mechanism beside their 95 % band.

        Parameters
        ----------
        measurement : Measurement
            What another run gave: a table, records, or a free motion, as was judged.

        Returns
        -------
        Foreseen
            Readings (n,), their band, the share in it, the error, and that of Coulomb + viscous
            friction by least squares.

        Raises
        ------
        InputError
            If it lacks what was judged, or has the same readings.

        Examples
        --------
        >>> from stickslip import Axis, Measurement, select
        >>> v = np.linspace(0.1, 1.0, 10)
        >>> noise = 0.01 * np.random.default_rng(1).normal(size=(2, 10))
        >>> first, other = (Measurement(velocity=v, friction=2.0 + 0.5 * v + x) for x in noise)
        >>> found = select(Axis(inertia=1.0), None, first).predict(other)
        >>> found.inside, bool(found.error < 0.02)
        (1.0, True)
        """
        given = as_turning(measurement, self.mechanism.units)
        refuse_lack(self.measurement, given, which="the other measurement")
        refuse_same(self.measurement, given)
        return self.foreseer(given)

    @property
    def scale(self) -> Scale:
        """Multiple of the unit in which what laws leave is shown."""
        return score_scale([candidate.left for candidate in self.candidates], self.score_unit)

    @property
    def law(self) -> FrictionLaw:
        """The named law; through measured levels where it is none of `stickslip.friction`."""
        fit = self.candidates[0].fit
        assert fit is not None
        return fit.law

    @property
    def family(self) -> Family:
        """Names of the terms of the named law."""
        return self.judgement.family

    @property
    def set(self) -> tuple[Family, ...]:
        """Families that cannot be distinguished, the named one first."""
        return self.judgement.families

    @property
    def parameters(self) -> tuple[Interval, ...]:
        """Intervals of the parameters: under the named law, and over the laws of the set."""
        return self.judgement.intervals

    @property
    def ladder(self) -> tuple["LawCandidate", ...]:
        """Laws by their number of parameters, each with how far it is from what friction is."""
        return tuple(
            sorted(self.candidates, key=lambda candidate: (candidate.count, candidate.distance))
        )

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What may stand beside the law, with its probability."""
        return self.judgement.findings

    @property
    def outliers(self) -> Mapping[int, float]:
        """Readings of a table that are far from the others, with how many deviations."""
        return self.judgement.outliers

    @property
    def explained(self) -> bool:
        """Whether a law describes what was measured."""
        return self.judgement.is_explained

    def band(
        self,
        velocity: Array | Sequence[float] | float,
        load: Array | float | None = None,
        inputs: Mapping[str, Array | float] | None = None,
        *,
        level: float = 0.95,
        all_along: bool = False,
    ) -> PredictionBand:
        """Return what friction is at velocities, over all candidate laws.

        Parameters
        ----------
        velocity : array_like (n,)
            Slip velocities [m/s] or [rad/s].
        load : array_like (n,), optional
            Normal force [N]; the mean of the measurement if not given.
        inputs : mapping of str to array_like (n,), optional
            Temperature and other inputs of the contact; their means if not given.
        level : float
            Probability with which friction at each velocity lies in the band.
        all_along : bool
            Whether that is the probability that it lies in the band at all of them together.

        Returns
        -------
        PredictionBand
            Limits and median (n,) [N] or [N m].

        Examples
        --------
        >>> from stickslip import Axis, Measurement, select
        >>> v = np.linspace(0.1, 1.0, 10)
        >>> noise = 0.01 * np.random.default_rng(1).normal(size=10)
        >>> table = Measurement(velocity=v, friction=2.0 + 0.5 * v + noise)
        >>> band = select(Axis(inertia=1.0), None, table).band([0.5])
        >>> bool(band.low[0] < 2.25 < band.high[0])
        True
        """
        rows = self._asked(velocity, load, inputs, level)
        return self.judgement.band(rows, level, all_along=all_along)

    def readings(
        self,
        velocity: Array | Sequence[float] | float,
        load: Array | float | None = None,
        inputs: Mapping[str, Array | float] | None = None,
        *,
        level: float = 0.95,
    ) -> PredictionBand:
        """Return the band of new readings: friction and the noise of a reading.

        Of records it is the force in steady motion of another run.

        Parameters
        ----------
        velocity : array_like (n,)
            Slip velocities [m/s] or [rad/s].
        load : array_like (n,), optional
            Normal force [N]; the mean of the measurement if not given.
        inputs : mapping of str to array_like (n,), optional
            Temperature and other inputs of the contact; their means if not given.
        level : float
            Probability with which a reading at each velocity lies in the band.

        Returns
        -------
        PredictionBand
            Limits and median (n,) [N] or [N m].
        """
        rows = self._asked(velocity, load, inputs, level)
        return self.judgement.reading_band(rows, level)

    def _asked(
        self,
        velocity: Array | Sequence[float] | float,
        load: Array | float | None,
        inputs: Mapping[str, Array | float] | None,
        level: float,
    ) -> Any:
        """Return rows at what was asked for, with a probability, if they can be."""
        try:
            v = np.atleast_1d(np.asarray(velocity, dtype=float))
        except (TypeError, ValueError):
            raise InputError(f"velocity must be numbers, got {velocity!r}.") from None
        if v.ndim != 1 or not v.size or not np.all(np.isfinite(v)) or np.any(v == 0.0):
            raise InputError(
                "velocity must be one or more finite velocities other than 0 [m/s] or [rad/s], got"
                f" {velocity!r}: friction at rest is what acts, up to the break-away."
            )
        if not 0.0 < level < 1.0:
            raise InputError(f"level must be a probability between 0 and 1, got {level!r}.")
        for name, value in {"load": load, **(inputs or {})}.items():
            if value is not None and np.shape(value) not in ((), (1,), v.shape):
                raise InputError(
                    f"{name} must be a number, or one for each of {v.size} velocities, got"
                    f" {np.size(value)}."
                )
        if load is not None and not np.all(np.asarray(load) > 0.0):
            raise InputError(f"load must be above 0 N, got {load!r}.")
        return self.judgement.problem.at(v, load, inputs)

    def sample(self, count: int = 20, *, seed: int = 0) -> list[FrictionLaw]:
        """Return laws drawn over the set with their covariances, for ensembles of runs.

        Parameters
        ----------
        count : int
            Number of laws.
        seed : int
            Seed of the draws.

        Returns
        -------
        list of FrictionLaw
            Laws by their shares. A draw that is no law of `stickslip.friction`, such as the
            measured curve or a static level below the kinetic one, is the law through its levels:
            left out, it would bias the ensemble.

        Examples
        --------
        >>> from stickslip import Axis, Measurement, select
        >>> v = np.linspace(0.1, 1.0, 10)
        >>> noise = 0.01 * np.random.default_rng(1).normal(size=10)
        >>> table = Measurement(velocity=v, friction=2.0 + 0.5 * v + noise)
        >>> len(select(Axis(inertia=1.0), None, table).sample(5))
        5
        """
        return self.judgement.sampled(count, seed)

    def _notes(self) -> Sequence[str]:
        return [str(self.certificate)] if self.certificate else []

    def _details(self) -> Mapping[str, Any]:
        return {
            "explained": self.explained,
            "set": [list(item) for item in self.set],
            "curve_share": None,
            "units": {kind: self.measurement.unit(kind) for kind in ("velocity", "friction")},
            "band": {"velocity": self.speeds.tolist(), **self.friction.to_dict(), "level": LEVEL},
            "other_specimen": self.other_specimen and self.other_specimen.to_dict(),
            "parameters": [item.to_dict() for item in self.parameters],
            **self.judgement.details(),
            "outliers": {str(row + 1): z for row, z in self.outliers.items()},
            "measure_at": {
                "velocity": list(self.places),
                **{name: list(values) for name, values in self.conditions.items()},
                "band_shrinks_to": self.shrinks,
            },
            "certificate": self.certificate and self.certificate.to_dict(),
            "inside_second": None if self.foreseen is None else self.inside,
            "error_second": None if self.foreseen is None else self.foreseen.error,
        }

    @staticmethod
    def schema() -> Mapping[str, Any]:
        """Return the JSON schema of `to_dict`, and of ``verdict.json`` with its heading.

        Returns
        -------
        mapping
            JSON schema of draft 2020-12.

        Examples
        --------
        >>> from stickslip.identify import BandVerdict
        >>> BandVerdict.schema()["properties"]["units"]["oneOf"][0]["required"]
        ['velocity', 'friction']
        """
        text = files("stickslip.identify").joinpath("verdict.schema.json").read_text("utf-8")
        result: Mapping[str, Any] = json.loads(text)
        return result

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.identify.figures import plot_band  # loads matplotlib

        return plot_band(self.drawing(), ax)

    def drawing(self) -> "BandDrawing":
        """Return what the figure of the verdict shows."""
        return drawing_of(
            self.judgement,
            self.measurement,
            self.closest.title,
            speeds=self.speeds,
            band=self.friction,
            other=self.other_specimen,
            places=self.places,
        )


def drawing_of(
    judgement: Judgement,
    measurement: Measurement,
    title: str,
    *,
    speeds: Array,
    band: PredictionBand,
    other: PredictionBand | None = None,
    places: Sequence[float] = (),
) -> "BandDrawing":
    """Return what a figure shows of a judged measurement."""
    from stickslip.identify.figures import BandDrawing, loads_apart  # load matplotlib

    problem, points = judgement.problem, judgement.measured()

    def at(load: float | None) -> Array:
        return judgement.acting(problem.at(speeds, load))

    if problem.over is not None:
        return _over_input(judgement, measurement, title, *problem.over)
    loads = [item for item in loads_apart(points.load) if item]
    by_load = {load: (judgement.band(problem.at(speeds, load)), at(load)) for load in loads}
    return BandDrawing(
        **vars(points),
        speeds=speeds,
        band=band,
        law=at(None),
        other=other,
        by_load=by_load,
        title=title,
        places=tuple(places),
        units=(measurement.unit("velocity"), measurement.unit("friction")),
    )


def _over_input(
    judgement: Judgement, measurement: Measurement, title: str, over: str, own: Any
) -> "BandDrawing":
    """Return what a figure shows of readings at one speed, over the load or an input.

    What else changes is as usual there: the law moves readings, also of the other direction.
    """
    from stickslip.identify.figures import BandDrawing  # loads matplotlib

    problem, points = judgement.problem, judgement.measured()
    speed = float(own.velocity[0])

    def at(x: Array) -> Any:
        v = np.full(len(x), speed)
        return problem.at(v, x) if over == "load" else problem.at(v, None, {over: x})

    x = own.load if over == "load" else own.inputs[over]
    spaced = np.geomspace if over == "load" else np.linspace
    grid = spaced(x.min(), x.max(), len(problem.asked().velocity))
    moved = points.friction - judgement.acting(own) + judgement.acting(at(x))
    unit = "N" if over == "load" else CONTACT_INPUTS[over].unit if over in CONTACT_INPUTS else ""
    return BandDrawing(
        **vars(replace(points, velocity=x, friction=moved, load=np.ones(len(x)))),
        speeds=grid,
        band=judgement.band(at(grid)),
        law=judgement.acting(at(grid)),
        title=title,
        places=(),
        units=(unit, measurement.unit("friction")),
        names=(over, "friction"),
    )


def at_usual_inputs(fit: LawFit) -> Iterator[str]:
    """Yield what levels and slopes are at usual inputs: in the law they stand at inputs of 0."""
    usual = typical_inputs(fit.law, fit.mechanism, fit.measurement)
    if not usual:  # a table stands at the means of inputs
        return
    names = [estimate.path.rpartition(".")[2] for estimate in fit.estimates]
    for part, name in (("level", "kinetic_coefficient"), ("viscous", "viscous_coefficient")):
        sizes = {of: x for of, x in usual.items() if f"{part}_{of}_slope" in names}
        if not sizes or name not in names:
            continue
        places = [names.index(item) for item in (name, *(f"{part}_{of}_slope" for of in sizes))]
        own = [fit.estimates[k] for k in places]
        if not all(item.bounded for item in own):
            continue
        drawn = fit.judgement.named_values
        draws = np.broadcast_arrays(*(drawn.get(item.path, item.value) for item in own))
        every = np.column_stack([[item.value for item in own], draws])
        levels = every[0] * np.prod(1.0 + every[1:].T * [*sizes.values()], axis=1)
        low, high = np.quantile(levels[1:], (0.025, 0.975)).tolist()
        at = inputs_text(sizes, turning=fit.measurement.turning)
        yield usual_sentence(own[0], float(levels[0]), low, high, at)


def told_apart(
    candidates: Sequence[LawCandidate], titles: Mapping[str, str]
) -> tuple[LawCandidate, ...]:
    """Return candidates with titles of their own: those of one name with what they alone have."""
    result = []
    for candidate in candidates:
        alike = [set(other.family) for other in candidates if other.title == candidate.title]
        shared = set.intersection(*alike)
        own = [titles[name] for name in candidate.family if name not in shared and name in titles]
        result.append(
            replace(candidate, title=f"{candidate.title} ({joined(own)})") if own else candidate
        )
    return tuple(result)


def unphysical_of(
    composed: Composition,
    mechanism: Mechanism,
    intervals: Sequence[Interval],
    *,
    turning: bool,
    sure: bool = False,
) -> list[str]:
    """Return what to say of parameters of a mechanism that came out where they cannot be.

    If that is `sure`, no value of the interval can be.
    """
    known = {
        path: replace(q, unit=turned(q.unit, turning))
        for path, q, _ in parameters(mechanism, "mechanism")
    }
    ends = {item.path: (item.low, item.high) for item in intervals}
    return [
        unphysical_sentence(known[path], x, impossible=impossible)
        for path, value in composed.rig.items()
        for x in [float(value[0])]
        if path in known and not known[path].allows(x)
        for impossible in [not _holds_possible(known[path], *ends.get(path, (x, x)))]
        if impossible or not sure
    ]


def _holds_possible(known: Quantity, low: float, high: float) -> bool:
    """Whether an interval holds values that a quantity may have."""
    least = known.low if known.above is None else max(known.low, known.above)
    return high > least and low < known.high


def _usual_quantity(name: str) -> Quantity:
    """Return a parameter of a law that is no composition as usual laws and parts have it."""
    for own in (fields_of(kind) for kind in laws().values()):
        if name in own:
            return own[name]
    of_parts = (parameter for part in PARTS.values() for parameter in part.parameters)
    return next(
        (of_part.quantity for of_part in of_parts if of_part.name == name), Quantity(name, "1")
    )


def importance(estimate: Estimate) -> int:
    """Return where an estimate stands: levels, inertia, slopes, speeds, shapes, the other rig."""
    if not estimate.path.startswith("friction."):
        return 1 if estimate.path in ("mechanism.inertia", "mechanism.mass") else 5
    scale = estimate.quantity.scale.rstrip("+-")
    return {"level": 0, "slope": 2, "drag": 2, "speed": 3}.get(scale, 4)


def estimates_of(
    judgement: Judgement,
    law: FrictionLaw,
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    any_law: bool,
) -> tuple[Estimate, ...]:
    """Return the parameters of the named law, with intervals if it holds or over all laws."""
    known = {path: q for path, q, _ in parameters(law, "friction")}
    known |= {path: q for path, q, _ in parameters(mechanism, "mechanism")}
    per_load = levels_at(mechanism) == "per load" or tells_load(measurement)

    def estimate(one: Interval) -> Estimate:
        """Return an estimate with symbol and unit, within the range of the quantity."""
        name = one.path.rpartition(".")[2]
        own = known.get(one.path) or RIG_QUANTITIES.get(name) or _usual_quantity(name)
        unit = unit_of(one.path, own, per_load=per_load, turning=measurement.turning)
        own = as_level(replace(own, unit=unit))
        low, high = (one.low_any, one.high_any) if any_law else (one.low, one.high)
        lowest = own.low if own.above is None else max(own.low, own.above)
        # what is no law has values that laws lack
        least = lowest if lowest <= one.value and math.isfinite(low) else -math.inf
        ends = math.isfinite(low) + math.isfinite(high)
        reason = (
            "no reading distinguishes it from the others",
            "the speeds measured do not bound it",
            "",
        )[ends]
        of_rig, ends_known = one.path.startswith("mechanism."), math.isfinite(high - low)
        if of_rig and ends_known and not _holds_possible(own, low, high):
            reason = f"it lies where it cannot be, {interval(low, high)}"
            low, high, least = -math.inf, math.inf, -math.inf
        elif of_rig and ends_known and low <= lowest + TO_LIMIT * (high - lowest):
            reason = f"not identified: it may be as small as {with_unit(number(lowest), unit)}"
            low = least = -math.inf
        if high <= least:
            bound = with_unit(number(least), unit)
            low, high, reason = -math.inf, math.inf, f"it reached its lower bound, {bound}"
            least = low
        return Estimate(
            path=one.path,
            quantity=own,
            value=max(one.value, lowest) if of_rig else one.value,
            low=max(low, least),
            high=max(high, least),
            interval="95 %",
            reason=reason,
        )

    return tuple(map(estimate, judgement.intervals))
