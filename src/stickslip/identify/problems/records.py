r"""Records of one coordinate in time: the force balance along the measured motion.

1. **Balance.** What drives the coordinate, :math:`F`, and all other known forces of the mechanism,
   :math:`F_k(x, v)` (gravity, springs, dampers), move an inertia against friction,

   .. math:: F + F_k(x, v) - J \ddot x = \sum_j c_j\, X_j(x, v, z, t).

   Both sides pass the same filter :math:`B` without phase, so that it biases nothing that is linear
   in the coefficients: the response is :math:`y = B[F + F_k]` less :math:`J B[\ddot x]` where the
   inertia is known, and a column is :math:`B[X_j]`. Velocities that enter :math:`X_j` in other ways
   than linearly have a band twice as wide. Where friction was measured, :math:`y` is its own
   :math:`B[F]`; where nothing drives the motion (decays, coast-downs), :math:`F = 0`.
2. **Band.** Noise :math:`\sigma` of the position, sampled every :math:`h`, has accelerations
   of variance :math:`2 h \sigma^2 (2\pi)^4 f^5 / 5` up to :math:`f`. The band :math:`f_c` is that
   at which they cost 1 % of the force, within bounds of the mean frequency of the motion: no time
   scale is one in seconds. Rows are kept six for each :math:`1/f_c`, none at rest.
3. **Memory.** A bristle of length :math:`r` follows the way: with :math:`u = 1 - s z` for the
   direction :math:`s`, :math:`du/d|x| = -u^n / r`. The exponent :math:`n` is 0 for an elastic
   bristle that yields at once, 1 for Dahl's. Without memory :math:`z` is the direction of motion.
   The length of each exponent that alone explains most goes into the vocabulary.
4. **Terms** are functions of signals (`Signals`), whether along a record (`Along`), or in steady
   motion at asked velocities (`Steady`), where bristles are stretched and nothing accelerates.
5. **Blocks** are stretches of all records, and each record where there are several. Rows within
   :math:`3/f_c` of a block are not learned from while it is left out.
6. **Twins** are the same records in a band of .6 and 1.5 times the width: the bias of the balance
   becomes spread. The covariance counts single stretches (`SPREAD`), as another record differs by
   as much; where there are several records it is theirs that counts.
   A new reading is a draw of the laws and of what they leave of a record predicted from the others,
   or of a quarter of a single one from its other three, at rows of like speed.
7. **Free motions** (decays, coast-downs) are integrated once more, as the noise of accelerations
   hides a small friction, and what it takes in all the time of a record is large. Where the motion
   comes back, it is the energy that friction takes,

   .. math:: \int F_k\, dx - \tfrac12 J v^2 = E_0 + \sum_j c_j \int X_j\, dx ,

   where it goes on in one direction the momentum, or :math:`J x` where places were measured: as
   recorded, in means over the samples of a row, up to both ends.
   :math:`E_0` (and the speed at the start) is projected out of both sides by record. Noise is then
   nearly white, that of the energy grows as its root. Energy hardly tells what friction is at low
   speeds: there the curve bends by its prior, and friction never drives.

Source of the parallel filter: M. Gautier, "Dynamic identification of robots with power model",
1997; of the bristle: P. R. Dahl, "A solid friction model", 1968.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.laws import (
    FLOWS,
    POINTS,
    RATIOS,
    TITLES,
    Composition,
    bounds_of,
    compose,
)
from stickslip.identify.problem import (
    ASKED,
    BENDING,
    MEMORY,
    STRETCHES,
    Array,
    Column,
    Mask,
    Points,
    Problem,
    Shape,
    Structure,
    Term,
)
from stickslip.identify.problems.features import features_along, features_in_steady_motion
from stickslip.identify.problems.record_checks import refuse_wrong_signs
from stickslip.identify.problems.record_frame import (
    APART,
    SLOW,
    alike,
    balanced_band,
    band_for,
    before_rest,
    by_best_sensor,
    frame_of,
    free_form,
)
from stickslip.identify.problems.record_signals import Along, Frame, Record, Steady
from stickslip.identify.problems.record_terms import DEAD_ZONE, EXPONENTS, GRID, screened, terms_of
from stickslip.identify.regression import BlockRegression
from stickslip.identify.thresholds import THRESHOLDS

WHITE = 0.65
"""Width of the noise of the work of a swing over its band, if it were white (study: decays)."""
FREE_SPREAD = 3.0
"""What a free motion counts of the covariance of its stretches, instead of `SPREAD` (study:
decays)."""
SPREAD = 20.0
"""Another record differs as single stretches do: covariance of their mean times their number."""
LATE = frozenset({"latency", "backlash", "flexible"})
"""Terms of a load that does not follow at once ..."""
LOW_TWIN = 0.2
"""... and the band, over the usual one, in which it does nearly (study: faults)."""
TWINS = (0.6, 1.5)
"""Bands of the same record, over the usual one, whose differences count as uncertainty."""
SOFT = 0.5
"""Rows far out lose weight softly: they hold the slow motion that tells a Stribeck step."""
LIKELY = 3.0
"""Records that the usual spread of records is worth, where it is estimated."""
QUARTERS = 4
"""Parts of a record that are as far apart as records are (halves: .91 in the 80 % band)."""
CLEAN = 20.0
"""Force over its noise from which parameters have the full price."""
FREE_BENDING = (0.12, 0.4)
"""Bendings of the curve of a free motion, over its friction: its prior (study: decays)."""
DRAWN = 600
"""Points of a figure, about."""
PATHS = (
    "offset", "drift", "viscous_drift", "offset_drift", "spring", "bow", "ripple", "mechanism",
    "lag", "inertia_error", "force_gain", "position_scale", "hose", "inertia", "gear_direction",
    "adhesion",
)  # fmt: skip
"""Terms of the rig and faults whose coefficient is their size; of two, their root mean square."""
UNLIKE = ("stribeck_direction", "curve")
"""Terms that no law of `stickslip.friction` has in steady sliding ..."""
UNSEEN = ("place", "level_ripple", "gear_direction")
"""... those that do not show there ..."""
LEVELS = {"level": "level", "second": "level", "adhesion": "level"}
"""... and those that are a part of the level there, or of another term."""
DEALS = 199
"""Times that stretches are dealt to records at random."""
HOLD = "hold"
"""Term of when forces act that may hold between samples, or go straight."""
HOLD_DOUBT = 0.5
"""Its standard deviation, over half a sample: a force that goes straight is two from one held."""
DELAYS = ("delay", "latency")
"""Those whose size is the product of both."""
SHAPED = ("clip", "dead_zone", "backlash", "flexible")
"""Those whose shape is their size."""


class RecordsProblem(Problem):
    """Records of one coordinate, as the judge sees them."""

    softness = SOFT
    curved = frozenset(
        {"level", "viscous", "stribeck", "drag", "power", "saturating", "viscous_direction",
         "stribeck_direction"}
    )  # fmt: skip

    def __init__(
        self,
        records: Sequence[Record],
        *,
        like: "RecordsProblem | None" = None,
        band: float = 1.0,
        normal: float = 1.0,
        inertia_path: str = "mechanism.inertia",
        load_slopes: Mapping[str, tuple[float, float]] | None = None,
        offset: str = "offset",
        widest: float = math.inf,
        without: Collection[str] = (),
    ) -> None:
        self._made_of = (
            records, like, band, normal, inertia_path, load_slopes, offset, widest, without
        )  # fmt: skip
        self.records: list[Record] = (
            by_best_sensor(records) if like is None else alike(records, like.records[0])
        )
        self.free: str = free_form(self.records) if like is None else like.free
        if self.free:
            self.curve_share = THRESHOLDS.free_curve_share
            self.records = [before_rest(one) for one in self.records]
        first = self.records[0]
        self.finds_inertia = first.inertia is None and not first.friction
        base = min(band_for(self.records), widest) if like is None else like.frame.band
        frame = None if like is None else like.frame
        self.rows = Along(self.records, frame, band * base, free=self.free)
        self.frame: Frame = frame_of(self.rows, base) if like is None else like.frame
        self.rows._frame = self.frame
        self._widths: dict[Column, int] = {}
        self.normal: float = normal if like is None else like.normal
        self.inertia_path: str = inertia_path if like is None else like.inertia_path
        self.load_slopes: Mapping[str, tuple[float, float]] = (
            dict(load_slopes or {}) if like is None else like.load_slopes
        )
        self.offset: str = offset if like is None else like.offset
        known = 0.0 if first.inertia is None else first.inertia
        self.response = (
            self.rows.lost if self.free else self.rows.force - known * self.rows.acceleration
        )
        self.stretches, self.blocks, self.excluded = _blocks(self.rows)
        filt = self.rows.filters[0]
        # the noise of what is integrated is white up to here, that of forces is not
        width = WHITE * self.rows.band if self.free == "work" else 0.0
        self.worth = min(2.0 * width * filt.every * filt.step, 1.0)
        if self.free == "momentum":
            self.worth = min(filt.every / self.rows.records[0].rarer, 1.0)
        doubts = {path: one.doubt for path, one in first.unknown.items() if one.doubt}
        if first.hold_doubt and not self.free:
            doubts[HOLD] = first.hold_doubt
        sought = frozenset(first.unknown.keys() - doubts.keys()) | {
            *(["inertia"] if self.finds_inertia else []),
            *(["offset"] if self.offset.startswith("mechanism.") else []),
        }
        self.always = sought | doubts.keys()
        if like is None and not (self.free or first.friction):
            refuse_wrong_signs(self.rows, self.response, self.stretches, inertia=self.finds_inertia)
        if like is None:
            found = screened(self.rows, self.response, finds_inertia=self.finds_inertia)
            self.terms = terms_of(
                self.rows,
                *found,
                finds_inertia=self.finds_inertia,
                always=sought,
                constant=bool(self.offset),
            )
            self.terms = {name: one for name, one in self.terms.items() if name not in without}
            self.terms |= {path: _doubtful(path, doubt) for path, doubt in doubts.items()}
            self.references = _references(self, found[0][:2])
        else:
            self.terms, self.references = like.terms, like.references
        self.usual = [
            tuple(sorted(self.always.union(names)))
            for names in (
                ("level",), ("level", "offset"), ("level", "viscous"), ("viscous",),
                ("level", "offset", "viscous"), ("level", "stribeck", "viscous"),
                ("level", "offset", "stribeck", "viscous"), ("drag", "level"),
                ("drag", "level", "viscous"), ("drag", "viscous"), ("drag",), ("level", "power"),
                ("adhesion", "level"), ("adhesion", "level", "viscous"),
                ("hose", "level", "offset", "viscous"),
                ("adhesion", "level", "stribeck", "viscous"), ("adhesion", "level", "power"),
            )
        ]  # fmt: skip
        self.instead = {"offset": TITLES["level_direction"]} if self.offset else {}
        if "clip" in self.terms and "dead_zone" not in self.terms:
            self.instead["level"] = DEAD_ZONE
        self.remembering: set[tuple[frozenset[str], bool]] = set()
        self.memory: str = "dahl"
        """Which law a memory is said to be: its damping is in no balance."""
        self.between: float = _between(self) if like is None else like.between
        self.spread = _spread(self) if like is None else like.spread

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes it again in another process: its terms are functions."""
        own = {"only": self.only, "remembering": self.remembering, "memory": self.memory}
        return _made, self._made_of, own

    def allowed(self, structure: Structure) -> bool:
        """Return whether terms may stand together, and a law is one that is compared."""
        if not super().allowed(structure):
            return False
        memories = {self._memory(column) for column in structure if self._memory(column)}
        if self.memory == "lugre" and any(one[0] and one[1] != EXPONENTS[1] for one in memories):
            return False
        if not self.remembering or not self.is_law(structure):
            return True
        names = frozenset(name for name, _ in structure if self.terms[name].role == "law")
        return (names, MEMORY in self.family(structure)) in self.remembering

    def price(self, size: float) -> float:
        """Return the share of the error that a parameter must save: 6 %, less where noise is large.

        Where noise is small beside the force everything is significant, and what counts is whether
        it is material; where it is large a parameter must only be significant.
        """
        if self.free:
            return 0.0
        filt = self.rows.filters[0]
        independent = 2.0 * self.rows.band * filt.every * filt.step * self.rows.count
        material = THRESHOLDS.material * min(size / CLEAN, 1.0)
        return float(min(max(THRESHOLDS.price / independent, material), THRESHOLDS.material))

    def features(self, rows: Any) -> Mapping[str, Array]:
        """Return what rows may be told apart by; the work of free motions has none."""
        if self.free:
            return {}
        steady = isinstance(rows, Steady)
        return features_in_steady_motion(rows) if steady else features_along(rows)

    def scales(self, fitted: Array) -> Sequence[Array]:
        """Return the speed, with which noise grows or falls, or the root of the energy."""
        if self.free:
            return [np.sqrt(self.rows.energy)] if self.free == "work" else []
        # what is badly known about a turn stands out at low speeds
        speed = np.maximum(np.abs(self.rows.seen(self.rows.velocity)), self.frame.low)
        return [speed, 1.0 / speed]

    def parts(self) -> Sequence[Mask]:
        """Return the records, or the quarters of a single one."""
        if len(self.records) > 1:
            each = [self.rows.record == k for k in range(len(self.records))]
            return [rows for rows in each if np.any(rows)]
        quarter = np.arange(self.rows.count) * QUARTERS // self.rows.count
        return [quarter == k for k in range(QUARTERS)]

    def beside(self, rows: Any) -> Array:
        """Return what readings in steady motion show beside the response, at measured rows (n,).

        These are single samples: they have what the filter takes off the force.
        """
        if self.free or not isinstance(rows, Steady):
            return np.zeros(self.rows.count)
        along: Along = self.rows
        both = zip(along.records, along.filters, strict=True)
        samples = along.rows_of([one.force[:: filt.every] for one, filt in both])
        return np.asarray(samples - (along.force - along.mechanism))

    def physical(self, structure: Structure, coefficients: Array) -> Mask:
        """Return which friction (d,) takes energy at all speeds of a free motion."""
        if not self.free:
            return super().physical(structure, coefficients)
        at, force = 0, np.zeros((len(coefficients), len(self._moved.velocity)))
        found = np.ones(len(coefficients), dtype=bool)
        for name, shape in structure:
            size, term = self.width(name, shape), self.terms[name]
            own = coefficients[:, at : at + size]
            if term.nonnegative:
                found &= np.all(own >= 0.0, axis=1)
            if term.role in ("law", "curve"):
                x = np.reshape(term.columns(self._moved, shape), (force.shape[1], -1))
                force += own @ x.T
            at += size
        found &= np.all(force * np.sign(self._moved.velocity) >= 0.0, axis=1)
        return found

    def noise_floor(self, structure: Structure, coefficients: Array) -> float:
        """Return what white noise of the recorded force and positions is after the filter."""
        if self.free:
            return 0.0
        inertia = self.records[0].inertia or 0.0
        at = 0
        for name, shape in structure:
            inertia += float(coefficients[at]) if name == "inertia" else 0.0
            at += self.width(name, shape)
        return float(self.rows.white(inertia))

    @cached_property
    def _moved(self) -> Steady:
        return self.asked()

    @cached_property
    def _twins(self) -> list["RecordsProblem"]:
        bands = (*TWINS, LOW_TWIN) if LATE & self.terms.keys() else TWINS
        return [RecordsProblem(self.records, like=self, band=one) for one in bands]

    def serves(self, structure: Structure) -> bool:
        """Return whether it is a twin for a structure: the low one is where a load lags behind."""
        low = self.rows.band < 0.5 * (LOW_TWIN + TWINS[0]) * self.frame.band
        return not low or bool(LATE & {name for name, _ in structure})

    @property
    def twins(self) -> Sequence[Problem]:
        """The same records in other bands."""
        return (
            self._twins
            if not self.free and abs(self.rows.band / self.frame.band - 1.0) < 1e-9
            else ()
        )

    def of(self, records: Sequence[Record]) -> "RecordsProblem":
        """Return other records of the same rig, in the same band and terms."""
        return RecordsProblem(records, like=self)

    def at(
        self,
        velocity: Any,
        load: Any = None,
        inputs: Mapping[str, Any] | None = None,
    ) -> Steady:
        """Return rows of steady motion at velocities (n,) [m/s] and the mean of time."""
        over = 1.0 if load is None else np.asarray(load, dtype=float) / self.normal
        v = np.atleast_1d(np.asarray(velocity, dtype=float))
        return Steady(frame=self.frame, velocity=v, over=over, inputs=inputs or {})

    def speeds(self, rows: Any) -> Array:
        """Return the speeds of rows (n,), of swings the largest: noise of their energy grows so."""
        if self.free == "work" and isinstance(rows, Along):
            return np.asarray(np.maximum(rows.swing, 1e-3 * self.frame.low))
        speed = np.abs(rows.seen(rows.velocity))
        return np.asarray(np.maximum(speed, 1e-3 * self.frame.low))

    def speeds_of_curve(self) -> Array:
        """Return rising speeds (n,) through which a curve is drawn as a law."""
        return np.geomspace(self.frame.low, self.frame.top, POINTS)

    def points(self, structure: Structure, coefficients: Array) -> Points:
        """Return the response less what a structure says of the rig, thinned out."""
        rows: Along = self.shown
        inertia = self.records[0].inertia or 0.0
        at, friction = 0, rows.force - inertia * rows.acceleration
        for name, shape in structure:
            size = self.width(name, shape)
            if self.terms[name].role in ("rig", "fault"):
                x = np.reshape(self.terms[name].columns(rows, shape), (rows.count, -1))
                friction -= x @ coefficients[at : at + size]
            at += size
        few = np.arange(0, rows.count, max(rows.count // DRAWN, 1))
        velocity = rows.seen(rows.velocity)
        load = np.ones(len(few))
        return Points(
            velocity=velocity[few],
            friction=friction[few],
            load=load,
            rows=None if self.free else few,
        )

    @cached_property
    def shown(self) -> Along:
        """Rows at which friction itself is shown: of a free motion those of its force balance."""
        if not self.free:
            rows: Along = self.rows
            return rows
        band = balanced_band(self.records, self.records[0].inertia or 1.0)
        return Along(self.records, self.frame, band)

    def asked(self) -> Steady:
        """Return the rows over which the band is stated: each direction as it was moved in."""
        v, grids = self.rows.seen(self.rows.velocity), []
        for side in (-1.0, 1.0):
            moved = side * v[side * v > self.frame.low]
            if len(moved) > SLOW * len(v):
                top = min(float(moved.max()), self.frame.top)
                # a motion passes all speeds up to its largest
                grids.append(side * np.geomspace(self.frame.low, top, ASKED))
        return self.at(np.sort(np.concatenate(grids)))

    def composition(
        self, structure: Structure, coefficients: Array, *, offset: bool = False
    ) -> Composition:
        """Return the law that a structure with coefficients (d, p) is, at the usual load."""
        rig = dict[str, Array]()
        memory: Shape = (0.0, 0.0)
        terms: dict[str, tuple[Shape, Array]] = {}
        names = {name for name, _ in structure}
        doubts = {path for path, one in self.records[0].unknown.items() if one.doubt}
        parts = {**LEVELS, "offset": "level_direction"} if offset else LEVELS
        at = 0
        for name, shape in structure:
            size = self.width(name, shape)
            own, at = coefficients[:, at : at + size], at + size
            rig |= self._of_rig(name, shape, own)
            entries = shape[self.terms[name].shared :]
            if name == "level":
                memory = shape[:2] if shape[0] else memory
                rig |= {"load_exponent": np.full(len(own), entries[0])} if entries else {}
            part = parts.get(name, name if self.terms[name].role == "law" else "")
            if part and name not in (*UNLIKE, *UNSEEN):
                shown = () if part in parts.values() else entries
                terms[part] = shown, own + terms.get(part, ((), 0.0))[1]
        normal = self._normals(rig, len(coefficients))
        # what is stated is no estimate
        rig = {path: x for path, x in rig.items() if path not in doubts}
        for name, (entries, own) in terms.items():
            if name not in FLOWS and "viscous" not in name:
                terms[name] = entries, own / normal[:, None]
        values = {}
        if memory[0]:
            level = terms.get("level", ((), np.zeros((len(coefficients), 1))))[1][:, 0]
            values = {"bristle_stiffness": level / memory[0]}
            if self.memory == "lugre":
                values |= {"bristle_damping": np.zeros(len(coefficients))}
            else:
                # bristles that yield at once have the least that laws have
                least, _ = bounds_of("dahl(level)", "yield_exponent")
                exponent = max(memory[1], least)
                values |= {"yield_exponent": np.full(len(coefficients), exponent)}
        found = compose(
            terms,
            self.frame.inputs,
            len(coefficients),
            memory=self.memory if memory[0] else "",
            memory_values=values,
            memory_fixed=("yield_exponent", "bristle_damping"),
        )
        text, instead = found.text, found.instead
        lacks = tuple(name for name in (*UNSEEN, "second") if name in names)
        if lacks:  # titles are those of the terms
            text, instead = "", text or instead
        if names & {*UNLIKE}:
            text = instead = ""
        return replace(found, rig=rig, text=text, instead=instead, load=normal, lacks=lacks)

    def _of_rig(self, name: str, shape: Shape, own: Array) -> dict[str, Array]:
        """Return the property of rig or record (d,) that a term is, by path; none of others."""
        unknown = self.records[0].unknown
        if name in DELAYS:
            return {name: shape[0] * own[:, 0]}
        if name in SHAPED:
            return {name: np.full(len(own), shape[0])}
        if name in unknown:
            return {name: unknown[name].given + own[:, 0]}
        if name in PATHS:
            path = {"inertia": self.inertia_path, "offset": self.offset}.get(name, name)
            size = own[:, 0] if own.shape[1] == 1 else np.linalg.norm(own, axis=1)
            if name in RATIOS:  # known forces stand on the side of the response
                size = 1.0 - size if name == "mechanism" else 1.0 + size
            return {path: size + self.records[0].constant if name == "offset" else size}
        return {}

    def _normals(self, rig: Mapping[str, Array], count: int) -> Array:
        """Return the normal forces (d,) of draws, which parameters that were found may change."""
        found = np.full(count, self.normal)
        for path, (slope, given) in self.load_slopes.items():
            found = found + slope * (rig.get(path, given) - given)
        return np.asarray(np.maximum(found, 1e-9 * self.normal))

    @cached_property
    def _rest(self) -> Steady:
        return self.at(self.frame.low)

    def width(self, name: str, shape: Shape) -> int:
        """Return the number of coefficients of a term."""
        if (name, shape) not in self._widths:
            one = np.reshape(self.terms[name].columns(self._rest, shape), (1, -1))
            self._widths[name, shape] = one.shape[1]
        return self._widths[name, shape]


def _doubtful(path: str, doubt: float) -> Term:
    """Return the term of a parameter of the mechanism whose uncertainty is stated."""
    return Term(
        name=path,
        role="rig",
        columns=lambda r, _: r.half_sample if path == HOLD else r.taken(path),
        doubt=doubt,
        cost=0,
        title="hold of the force" if path == HOLD else path.rpartition(".")[2].replace("_", " "),
    )


def _made(
    records: Sequence[Record],
    like: RecordsProblem | None,
    band: float,
    normal: float,
    inertia_path: str,
    load_slopes: Mapping[str, tuple[float, float]] | None,
    offset: str,
    widest: float,
    without: Collection[str],
) -> RecordsProblem:
    return RecordsProblem(
        records, like=like, band=band, normal=normal, inertia_path=inertia_path,
        load_slopes=load_slopes, offset=offset, widest=widest, without=without,
    )  # fmt: skip


def unseen_length(regression: BlockRegression, named: Structure) -> float:
    """Return the longest bristle that a law without one may have and predict as well [m].

    0 where the shortest shows. A bristle against which the odds are less than `Thresholds.odds`, by
    the evidence of records, is not told from none.
    """
    problem = regression.problem
    assert isinstance(problem, RecordsProblem)
    shared = [name for name, _ in named if problem.terms[name].shared]
    if not shared or problem.free or MEMORY in problem.family(named):
        return 0.0
    frame, longest = problem.frame, 0.0
    regression.losses([named])
    least = float(np.log(np.mean(regression.losses_of[named])))
    shortest = min(max(frame.noise, 1e-9 * frame.span), frame.span / 8.0)
    for length in np.geomspace(shortest, frame.span / 4.0, GRID).tolist():
        memory = (length, 1.0)
        structure = tuple(
            (name, (*memory, *shape[2:]) if name in shared else shape) for name, shape in named
        )
        regression.add(structure)
        regression.losses([structure])
        loss = float(np.mean(regression.losses_of[structure]))
        if not 0.5 * (math.log(loss) - least) * len(problem.blocks) < math.log(THRESHOLDS.odds):
            break
        longest = length
    return longest


def _blocks(rows: Along) -> tuple[NDArray[np.intp], list[Mask], list[Mask]]:
    """Return the number of the stretch of each row, blocks, and rows that are near each."""
    count, at = rows.count, np.arange(rows.count)
    parts = max(min(STRETCHES, count), 1)
    stretch = np.minimum(at * parts // max(count, 1), parts - 1)
    per = rows.filters[0].every * rows.filters[0].step * rows.band
    gap = math.ceil(APART / per)
    blocks = [stretch == k for k in range(parts)]
    near = []
    for block in blocks:
        own = np.flatnonzero(block)
        close = (at >= own[0] - gap) & (at <= own[-1] + gap)
        near.append(block | (close & np.isin(rows.record, np.unique(rows.record[block]))))
    for k in range(len(rows.records)):
        if len(rows.records) > 1 and np.any(rows.record == k):
            blocks.append(rows.record == k)
            near.append(rows.record == k)
    return stretch, blocks, near


def _references(problem: RecordsProblem, memories: Sequence[Shape]) -> list[Structure]:
    if problem.free:
        return _free_references(problem, memories)
    base = _sought(problem)
    constant: list[Column] = [("offset", ())] if problem.offset else []
    # the curve is over speed and times the load: it has neither what inputs change nor, where the
    # load does, what this does not change
    changing = [
        name for name in problem.terms if name in ("gear", "adhesion") or name.startswith("level*")
    ]
    return [
        tuple(
            sorted(
                [
                    *base,
                    ("curve", (*memory, side, bend)),
                    *constant,
                    *((name, memory) for name in changing),
                    *([("viscous", ())] if "adhesion" in changing else []),
                ]
            )
        )
        for memory in memories
        for side in (0.0, 1.0)
        for bend in BENDING
    ]


def _sought(problem: RecordsProblem) -> list[Column]:
    """Return the columns of what is looked for beside friction; what is doubtful stays as given."""
    names = problem.always - {"offset"}
    return [(name, ()) for name in names if not problem.terms[name].doubt]


def _free_references(problem: RecordsProblem, memories: Sequence[Shape]) -> list[Structure]:
    """Return laws with curves beside them that bend by a part of the friction.

    Work hardly tells friction at low speeds from friction at others: there the prior does.
    """
    terms, rows = problem.terms, problem.rows
    x = np.reshape(terms["curve"].columns(rows, (*memories[0], 0.0, 0.0)), (rows.count, -1))
    size = np.sqrt(np.mean(x * x, axis=0)) + 1e-300
    left = problem.response - x @ (
        np.linalg.lstsq(x / size, problem.response, rcond=1e-9)[0] / size
    )
    noise = float(np.std(left)) / (float(np.std(problem.response)) + 1e-300)
    beside = [(), (("offset", ()),)] if problem.free == "work" else [()]
    always = _sought(problem)
    return [
        tuple(
            sorted(
                [
                    ("curve", (*memory, 0.0, (noise / bending) ** 2)),
                    ("level", memory),
                    ("viscous", ()),
                    *always,
                    *other,
                ]
            )
        )
        for memory in memories
        for other in beside
        for bending in FREE_BENDING
    ]


def by_curve(problem: RecordsProblem) -> tuple[Array, Array]:
    """Return the columns (n, p) of the measured curve, of size 1, and what they leave (n,)."""
    rows = problem.rows
    left, found = math.inf, (np.zeros((0, 0)), np.zeros(0))
    for structure in problem.references:
        x = np.hstack([np.reshape(problem.terms[name].columns(rows, shape), (rows.count, -1))
                       for name, shape in structure])  # fmt: skip
        x = x / (np.sqrt(np.mean(x * x, axis=0)) + 1e-300)
        gram = x.T @ x + 1e-6 * len(x) * np.eye(x.shape[1])
        e = problem.response - x @ np.linalg.solve(gram, x.T @ problem.response)
        if np.median(np.abs(e)) < left:
            left, found = float(np.median(np.abs(e))), (x, e)
    return found


def with_hold(
    make: Callable[[Sequence[Record]], RecordsProblem],
    each: Sequence[Sequence[Record]],
    hold: str | None,
) -> list[RecordsProblem]:
    """Return the problems of coordinates whose forces are commands, which run as said.

    Where nothing is said, the forces of all coordinates, which one program samples, go straight
    where the measured curves leave less of them half a sample earlier, by two standard errors over
    stretches, and hold elsewhere. When they act stays doubtful, less so the nearer what the choice
    is seen to gain is to what is material.
    """

    def made(*, straight: bool, doubt: float = 0.0) -> list[RecordsProblem]:
        return [
            make([replace(one, held=one.held and not straight, hold_doubt=doubt) for one in own])
            for own in each
        ]

    problems = made(straight=hold == "first")
    open_ = [one for one in problems if not one.free and any(own.held for own in one.records)]
    if hold is not None or not open_:
        return problems
    # what is left counts over its mean: joints differ in size and unit
    left = [_left_by_hold(one) for one in open_]
    held, straight = np.concatenate([one / (np.mean(one) + 1e-300) for one in left]).T
    more, material = held - straight, THRESHOLDS.material * max(np.mean(held), np.mean(straight))
    errors = float(np.mean(more)) / (float(np.std(more)) / math.sqrt(len(more)) + 1e-300)
    interpolated = errors > THRESHOLDS.errors
    # what the choice gains counts in so far as it is seen, between half of the errors and all
    seen = (errors if interpolated else -errors) / (0.5 * THRESHOLDS.errors) - 1.0
    gain = min(max(seen, 0.0), 1.0) * abs(float(np.mean(more)))
    doubt = HOLD_DOUBT * max(1.0 - gain / (float(material) + 1e-300), 0.0)
    return made(straight=interpolated, doubt=doubt) if interpolated or doubt else problems


def _left_by_hold(problem: RecordsProblem) -> Array:
    """Return what the measured curve leaves of forces that hold, or go straight, by stretch."""
    rows = problem.rows
    late = [
        f(one.force) - f(one.force, late=0.5 * f.step * one.held)
        for one, f in zip(rows.records, rows.filters, strict=True)
    ]
    x, held = by_curve(problem)
    y = problem.response + rows.rows_of(late)
    gram = x.T @ x + 1e-6 * len(x) * np.eye(x.shape[1])
    straight = y - x @ np.linalg.solve(gram, x.T @ y)
    stretches = [problem.stretches == k for k in np.unique(problem.stretches)]
    return np.array([[np.abs(e[k]).mean() for e in (held, straight)] for k in stretches])


def _of_stretches(problem: RecordsProblem) -> tuple[Array, NDArray[np.intp]]:
    """Return products of what stretches do to the fit (k, k), and the record of each (k,)."""
    x, left = by_curve(problem)
    inverse = np.linalg.pinv(x.T @ x + 1e-6 * len(x) * np.eye(x.shape[1]), hermitian=True)
    e = np.clip(left, *np.quantile(left, (0.01, 0.99)))
    parts = problem.stretches * len(problem.records) + problem.rows.record
    parts, of = np.unique(parts, return_inverse=True)
    scores = np.zeros((len(parts), x.shape[1]))
    np.add.at(scores, of, x * e[:, None])
    moved = x @ inverse @ scores.T
    return moved.T @ moved, parts % len(problem.records)


def _by_records(products: Array, records: NDArray[np.intp]) -> float:
    """Return the size of what records do to the fit, by the products of their stretches."""
    same = records[:, None] == records
    return float(np.sum(products[same]))


def _between(problem: RecordsProblem) -> float:
    """Return the variance of the fit by what records differ, over that by what stretches do.

    Each is the variance of sums of the scores of the measured curve; a fit to records that share a
    law leaves both the same. Without a second record it is 1.
    """
    count = len(problem.records)
    if count < 2:
        return 1.0
    products, records = _of_stretches(problem)
    k = len(records)
    by_stretch = float(np.trace(products)) * k / (k - 1)
    return _by_records(products, records) * count / (count - 1) / (by_stretch + 1e-300)


def chance_of_records(problem: RecordsProblem) -> float:
    """Return how often stretches dealt to records at random differ as those of the records do."""
    products, records = _of_stretches(problem)
    rng, measured = np.random.default_rng(7), _by_records(products, records)
    dealt = (_by_records(products, rng.permutation(records)) for _ in range(DEALS))
    return (1.0 + sum(one >= measured for one in dealt)) / (1.0 + DEALS)


def _spread(problem: RecordsProblem) -> float:
    """Return how far another record differs, over the covariance of the mean of stretches.

    Of R records alike, another differs by R times the variance of their mean. One record tells
    nothing of it; few are weighed with the usual `SPREAD`.
    """
    count, usual = len(problem.records), FREE_SPREAD if problem.free else SPREAD
    found = (1.0 + count) * max(problem.between, 1.0 / count)
    share = (count - 1.0) / (count - 1.0 + LIKELY)
    return float(usual ** (1.0 - share) * found**share)
