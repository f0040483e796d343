"""A measured table of friction as a problem of the judgement: readings, curves, laws, findings."""

import copy
import itertools
import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, resting_readings
from stickslip.errors import InputError
from stickslip.identify.bands import MeasuredPoints
from stickslip.identify.fits import (
    check_loads,
    inputs_along,
    last_digit,
    load_along,
    load_of,
    refuse_load,
    uncertainties_of,
)
from stickslip.identify.forces import TRANSMITTED, load_slopes
from stickslip.identify.judgement import DRAWS, ONE_WAY, Candidates, Finding, Problem, stated
from stickslip.identify.laws import FLOWS, POINTS, Composition, compose, own_composition
from stickslip.identify.own_laws import (
    certain_of,
    is_dry,
    is_own,
    is_slope,
    signed_of,
)
from stickslip.identify.posterior import (
    Array,
    Column,
    Draws,
    Family,
    Posterior,
    Structure,
    family_of,
)
from stickslip.identify.problems.records import LOAD
from stickslip.identify.problems.sensor_limits import (
    Limit,
    limits_of,
    without_site,
)
from stickslip.identify.problems.table_model import (
    AT_ENDS,
    BETA,
    BEYOND,
    COARSEST,
    DRIFTS,
    FEW_SPEEDS,
    FOLLOWS,
    JUMP,
    MOST,
    MOST_ROWS,
    NEAR,
    OF_TIME,
    SCALES,
    SIDES,
    Frame,
    Readings,
    Rows,
    TableFit,
    TableModel,
    break_column,
    compared,
    ends_of,
    families_at,
    fitted,
    is_break,
    is_ratio,
    law_column,
    speeds_of,
    structures_of,
)
from stickslip.identify.projection import Rung, Shaped, names_of
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.identify.vocabulary import (
    FLOW_DIRECTIONS,
    GEAR,
    PARTS,
    Grid,
    flow_direction,
    parameters_of,
)
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import vary as with_values
from stickslip.show.formatting import joined, percent, quantity

STEADY = 0.1
"""Range of the logarithm of the speed within which most runs are steps at a speed each."""
FEWEST = 5
"""Readings that a table must have."""
ASKED = 40
"""Speeds of each direction at which the band is stated."""
GAP = 1.05
"""Ratio of neighbouring speeds from which laws are compared half-way between them too."""
MANY = 200
"""Rows from which laws are compared at the rows alone."""
BELOW_NOISE = 0.7
"""Deviation of what no law says over the noise up to which a law is exact."""
REST = 0.8
"""Part of the friction at the next speeds below which a slow reading may be one at rest ..."""
REST_PRIOR = 0.05
"""... and the prior that these are: friction at rest is anything up to the break-away."""
BESIDE_SLOWEST = 5
"""Readings at the next speeds with which slow ones are compared."""
MOST_RESTS = 4
"""Readings that may be at rest, in each direction."""
NOT_BY_LOAD = frozenset({"offset", "adhesion", *FLOWS, *FLOW_DIRECTIONS})
"""Terms that are no levels over the load."""
DIRECTIONS: tuple[tuple[str, ...], ...] = (
    (),
    ("offset",),
    ("offset", "viscous_direction"),
    ("offset", "stribeck_sides"),
    ("offset", "stribeck_sides", "viscous_direction"),
)
"""What of a law may differ by direction; under several loads a level, in place of an offset."""

LIMITED = (
    "{} of {} readings are {}, as at a limit of the sensor, and the others are at too few speeds"
    " for a law of friction: measure again with a sensor of {}, or leave these readings out."
)
"""What is said where too few readings are beside limits."""
EQUAL = (
    "All readings are equal: they are taken to be rounded by up to {}, half a unit of their last"
    " digit, or {} of friction where that is less or unknown. State their uncertainty where it is"
    " finer."
)
"""What is said of a resolution that nobody stated."""


@dataclass(eq=False)
class TableProblem(Problem):
    """A table of friction with its posterior."""

    table: Readings
    fit: TableFit
    turning: bool = False
    rests: Array = field(default_factory=lambda: np.zeros(0))
    """Velocities of the readings that are taken to be at rest (k,)."""
    families: Sequence[Family] | None = None
    load_error: float = 0.0
    """Standard uncertainty of the normal force that was stated, over that."""
    limits: Sequence[Finding] = ()
    """Limits of the sensor, beyond which friction at some readings is."""
    unlimited: "NDArray[np.bool_] | None" = None
    """Which readings of the fit are none of these (n,), and are those of the table."""
    posterior: Posterior = field(init=False)

    def __post_init__(self) -> None:
        self.posterior = self.fit.posterior
        self.size = self.fit.model.frame.size
        self.load = self.fit.model.frame.load
        self.restricted = self.families is not None
        self.runs = self.fit.model.frame.runs

    @property
    def model(self) -> TableModel:
        """Readings with weights."""
        return self.fit.model

    @property
    def _of_table(self) -> "NDArray[np.bool_] | slice":
        return slice(None) if self.unlimited is None else self.unlimited

    @property
    def weights(self) -> Array:
        """Weights of the readings of the table (n,)."""
        return self.model.weights[self._of_table]

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        measurement: Measurement,
        families: Sequence[Family] | None = None,
    ) -> "TableProblem":
        """Return the problem of a measured table; readings at rest are left out.

        Examples
        --------
        >>> from stickslip import Axis
        >>> v = np.linspace(0.1, 1.0, 10)
        >>> table = Measurement(velocity=v, friction=2.0 + v)
        >>> len(TableProblem.of(Axis(inertia=1.0), table).table.friction)
        10
        """
        table = readings_of(mechanism, measurement)
        # what is asked for need not hold: the truth is any law
        usual = families_at(table.rows)
        known = [*dict.fromkeys([*usual, *map(parts_of, families or ())])]
        turning = measurement.turning
        fit, rests = fitted(table, known), table.at_rest
        beside, reached = cls._limits(table, fit, known, turning)
        limits = list(reached.values())
        free = at_none(table, reached)
        if limits:
            if not _moves(table.rows.where(free)):
                raise limited(table, [*reached], turning)
            if not np.array_equal(beside.table.rows.order, table.rows.order[free]):
                beside = cls(table.where(free), fitted(table.where(free), known))
            fit, table = censored(table, [*reached], known, beside), table.where(free)
        # cells of many readings are means, of which none is one at rest
        slow = slow_rows(table) if table.total == len(table.friction) else np.zeros(0, dtype=int)
        if len(slow) and not limits:
            moving = table.where(~np.isin(np.arange(len(table.friction)), slow))
            if _moves(moving.rows):
                other = fitted(moving, known)
                span = 2.0 * np.median(np.abs(moving.friction))
                # if one is at rest, so are slower ones
                if other.evidence + math.log(REST_PRIOR / span ** len(slow)) > fit.evidence:
                    rests = np.append(rests, table.rows.velocity[slow])
                    table, fit = moving, other
        unsure = load_error_of(mechanism, measurement)
        return cls(
            table, compared(fit, known), turning=turning, rests=rests, families=families,
            load_error=unsure, limits=limits, unlimited=free if limits else None,
        )  # fmt: skip

    @classmethod
    def _limits(
        cls, table: Readings, fit: TableFit, known: Sequence[Family], turning: bool
    ) -> "tuple[TableProblem, dict[Limit, Finding]]":
        """Return limits that the sensor of a table with a fit has, and the readings at none.

        Readings at one limit would tell that friction does not go beyond another.
        """
        possible = [*limits_of(table)]
        rest, result = table.where(at_none(table, possible)), dict[Limit, Finding]()
        count = len(rest.friction)
        if 0 < count < FEW_SPEEDS and 2 * count < len(table.friction) and not fit.model.step:
            raise limited(table, possible, turning)
        if not possible or count < FEW_SPEEDS:
            return cls(table, fit), result
        beside = cls(rest, fitted(rest, known), turning=turning)
        for limit in possible:
            others = [x for x in possible if x is not limit]
            every = fitted(table.where(at_none(table, others)), known) if others else fit
            finding = beside.limited(limit, table, every)
            if finding.asserted:
                result[limit] = finding
        return beside, result

    def limited(self, limit: Limit, table: Readings, fit: TableFit) -> Finding:
        """Return the limit of a sensor beside which these readings of a table are the others."""
        rows, unit = table.rows.where(limit.rows), "N m" if self.turning else "N"
        draws = self.posterior.draws(DRAWS, seed=2)
        likely = limit.probability(
            fit.posterior.evidence, self.posterior.evidence, self.readings(rows, draws),
            self.size, self.model.sigma(self.posterior.best), last_digit(table.friction),
        )  # fmt: skip
        count, end = len(limit.rows), quantity(limit.end, unit, 3)
        sentence = (
            f"{count} readings are {quantity(limit.value, unit, 3)}, the largest that is shown, as"
            " by a sensor at its limit: friction there is taken to be that or more."
            if limit.value
            else f"{count} readings are 0, and no other is below {end}, as by a sensor with a"
            " threshold: friction there is taken to be anything below it."
        )
        title = "limit of the sensor" if limit.value else "threshold of the sensor"
        return stated(limit.term, title, likely, np.full(1, limit.end / self.size), sentence)

    def with_laws(self, own: Sequence[Structure], families: Sequence[Family]) -> "TableProblem":
        before, model = self.posterior, copy.copy(self.model)
        model.signed, model.certain = model.signed | signed_of(own), certain_of(own)
        priors = np.append(self.fit.priors, np.full(len(own), np.max(self.fit.priors)))
        posterior = Posterior(
            model, [*before.structures, *own], priors, begin=before.nodes, most=MOST
        )
        fit = replace(self.fit, model=model, posterior=posterior)
        return replace(self, fit=fit, families=(*families, *map(family_of, own)))

    # ---- rows -------------------------------------------------------------------------------

    def at(self, velocity: Any, load: Any = None, inputs: Mapping[str, Any] | None = None) -> Rows:
        """Return rows at velocities (n,); load and inputs are the usual ones if not given."""
        frame = self.model.frame
        v = np.atleast_1d(np.asarray(velocity, dtype=float))
        ones, given = np.ones(len(v)), inputs or {}
        return Rows(
            velocity=v,
            load=ones * (frame.load if load is None else load),
            inputs=sized(
                {name: ones * given.get(name, mean) for name, mean in frame.means.items()}
            ),
            run=np.full(len(v), -1),
            order=np.full(len(v), np.nan),
        )

    def asked(self) -> Rows:
        """Return the rows over which the band is stated: each measured direction, at mean load."""
        v = self.table.rows.velocity
        if speeds_of(self.table.rows) == 1:  # which may be set to some per cent
            v = np.sign(v) * float(np.median(np.abs(v)))
        most = max(len(np.unique(item)) for item in (v[v < 0.0], v[v > 0.0]))
        grids = [
            np.sign(item[0]) * np.geomspace(np.abs(item).min(), np.abs(item).max(), ASKED)
            for item in (v[v < 0.0], v[v > 0.0])
            if len(np.unique(item)) >= min(FEW_SPEEDS, most)
        ]
        return self.at(np.sort(np.concatenate(grids)))

    def offered(self) -> Rows:
        """Return the rows at which more may be read: those asked, and at ends of load and inputs.

        Friction is wanted there too, so these are the rows whose band readings are to narrow.
        """
        usual, known = self.asked(), self.table.rows
        every = {LOAD: known.load} if self.model.frame.loaded else {}
        every |= known.inputs
        rows = [usual]
        for name, x in every.items():
            for end in (float(x.min()), float(x.max())):
                v = usual.velocity[::3]
                rows.append(self.at(v, end) if name == LOAD else self.at(v, None, {name: end}))
        return self.at(
            np.concatenate([item.velocity for item in rows]),
            np.concatenate([item.load for item in rows]),
            {name: np.concatenate([item.inputs[name] for item in rows]) for name in usual.inputs},
        )

    def like(self, rows: Rows) -> Rows:
        """Return rows of another table as this one sees them: of a new run, at any time."""
        result = self.at(rows.velocity, rows.load, rows.inputs)
        return replace(result, run=np.full(len(rows.velocity), -2))

    def usual(self, rows: Rows) -> Array:
        plain: Structure = (("level", ()), ("offset", ()), ("viscous", ()))
        own = self.design(plain, self.at(self.table.rows.velocity, self.table.rows.load))
        c = np.linalg.lstsq(own, self.table.friction, rcond=None)[0]
        return np.asarray(self.design(plain, rows) @ c)

    def places(self) -> Rows:
        """Return the rows as measured, and half-way between neighbours of a direction and load.

        Cells of many runs are joined: a law has no runs.
        """
        rows = self.table.rows
        if len(rows.velocity) > MOST_ROWS:
            rows = replace(rows, run=np.zeros_like(rows.run))
            rows = replace(self.table, rows=rows).condensed().rows
        own = self.at(rows.velocity, rows.load, rows.inputs)
        if len(rows.velocity) >= MANY:
            return own
        marks: list[Any] = [rows.direction, np.round(np.log(rows.load), 2)]
        marks += [np.round(x, 6) for x in rows.inputs.values()]
        group = np.unique(np.column_stack(marks), axis=0, return_inverse=True)[1].ravel()
        low, high = list[int](), list[int]()
        for k in range(int(group.max()) + 1):
            at = np.flatnonzero(group == k)
            at = at[np.argsort(rows.speed[at], kind="stable")]
            apart = rows.speed[at[1:]] > GAP * rows.speed[at[:-1]]
            low += at[:-1][apart].tolist()
            high += at[1:][apart].tolist()
        a, b = np.array(low, dtype=np.intp), np.array(high, dtype=np.intp)

        def with_middles(x: Array, ratio: bool) -> Array:
            middle = np.sqrt(x[a] * x[b]) if ratio else 0.5 * (x[a] + x[b])
            return np.concatenate([x, middle])

        speed = with_middles(rows.speed, ratio=True)
        direction = np.concatenate([rows.direction, rows.direction[b]])
        return self.at(
            direction * speed,
            with_middles(rows.load, ratio=True),
            {name: with_middles(x, ratio=False) for name, x in rows.inputs.items()},
        )

    def scale(self, rows: Rows) -> Array:
        """Return how friction grows with the load at rows (n,)."""
        return self.model.frame.grown(rows)

    # ---- laws -------------------------------------------------------------------------------

    def columns(self, column: tuple[str, Any], rows: Rows) -> list[Array]:
        """Return the columns of a term: parts of laws, and what differs."""
        name, shape = column
        frame = self.model.frame
        if name == "offset":
            return [np.ones(len(rows.velocity))]
        if name == "level_direction":
            return [np.asarray(rows.load / frame.load)]
        if name in FLOW_DIRECTIONS:
            return [rows.speed ** (shape[0] if shape else 1.0)]
        if name == "stribeck_sides":
            surplus = law_column(("stribeck", shape), rows, frame)
            return [surplus, rows.direction * surplus]
        if "*" in name:
            part, _, of = name.partition("*")
            return [law_column((part, ()), rows, frame) * (rows.inputs[of] - frame.means[of])]
        return [law_column(column, rows, frame)]

    @cached_property
    def grid(self) -> Grid:  # type: ignore[override]
        """Shapes of laws for the speeds that were measured."""
        frame = self.model.frame
        return Grid(slowest=frame.slowest, fastest=frame.fastest, fine=2.0 if frame.loaded else 3.0)

    def candidates(self) -> list[Candidates]:
        """Return the families on which curves are projected, with their structures."""
        known = families_at(self.table.rows)
        if self.families is not None:
            known = [*dict.fromkeys(map(parts_of, self.families))]
        every, _ = structures_of(self.model.frame, self.grid, [item for item in known if item])
        laws: dict[Family, dict[Structure, None]] = {}
        met = [
            structure
            for structure in self.posterior.structures
            if structure and not any(map(is_break, family_of(structure)))
        ]
        for entry in [*every, *met]:
            laws.setdefault(family_of(entry), {})[entry] = None
        result = []
        for family, structures in laws.items():
            for beside in self._besides(family):
                whole = [self._beside(structure, beside) for structure in structures]
                names = family_of(whole[0])
                if not self._is_compared(names):
                    continue
                count = self._count(structures) + len(beside) + ("stribeck_sides" in beside)
                result.append(Candidates(family=names, structures=whole, parameters=count))
        return result

    def _is_compared(self, family: Family) -> bool:
        """Return whether a family is one that is asked for; an offset may stand beside any."""
        if self.families is None:
            return True
        return {*family} - {"offset"} in [{*item} - {"offset"} for item in self.families]

    def _count(self, structures: Sequence[Structure] | Mapping[Structure, None]) -> int:
        """Return the number of parameters of a family of laws."""
        first = next(iter(structures))
        names = tuple("stribeck" if name == "hersey" else name for name, _ in first)
        own = sum(is_slope(name) and name.place >= 0 for name in names)
        powers = any(
            len(shape) > len(PARTS[name].shapes) and shape[-1] != 1.0
            for structure in structures
            for name, shape in structure
            if name in PARTS
        )
        own += sum(name in ("adhesion", GEAR) for name in names)
        return parameters_of(names) + int(powers) + own

    def _besides(self, family: Family) -> list[tuple[str, ...]]:
        """Return what may stand beside the parts of a law: directions, effects of inputs."""
        frame = self.model.frame
        sides: list[tuple[str, ...]] = [()]
        if frame.both:
            other = {"viscous_direction": flow_direction(family)}
            other |= {"offset": "level_direction"} if frame.loaded else {}
            sides = [
                tuple(other.get(x, x) for x in item)
                for item in DIRECTIONS
                if ("stribeck_sides" not in item or "stribeck" in family)
                and ("viscous_direction" not in item or {"viscous", "power"} & {*family})
            ]
        own = next((name.own for name in family if is_slope(name)), None)
        if own is not None and own.holds_constant(self.places()):
            sides = [()]
        by_input = [
            [
                tuple(f"{part}*{name}" for part in parts)
                for parts in ((), ("level",), ("viscous",), ("level", "viscous"))
                if {*parts} <= {*family}
            ]
            for name in frame.means
            if name != TRANSMITTED
        ]
        every = itertools.product(sides, *by_input)
        return [tuple(itertools.chain(*item)) for item in every]

    @staticmethod
    def _beside(structure: Structure, beside: Sequence[str]) -> Structure:
        """Return a law with what stands beside it, in the order of names."""
        shapes = dict(structure)
        own = {"stribeck_sides": shapes.get("stribeck", ())}
        own["power_direction"] = shapes.get("power", ())[:1]
        kept = [
            item for item in structure if "stribeck_sides" not in beside or item[0] != "stribeck"
        ]
        more = [(name, own.get(name, ())) for name in beside]
        return tuple(sorted([*kept, *more], key=lambda item: item[0]))

    def exact(self) -> float:
        """Return the probability that what no law says is below the noise."""
        model, nodes = self.model, self.posterior.nodes
        small = [model.unexplained(x) <= BELOW_NOISE * model.sigma(x) for x in nodes]
        laws = [not any(map(is_break, family_of(item))) for item in self.posterior.structures]
        return float(self.posterior.weights[np.outer(small, laws)].sum())

    def composition(
        self,
        structure: Shaped,
        coefficients: Array,
        draws: Sequence[Draws] | None = None,
        *,
        offset: bool = False,
    ) -> Composition:
        """Return the law that a structure with coefficients (k, p) is, over the mean load."""
        load, at = self.model.frame.load, 0
        if draws is not None and self.load_error:
            z = np.random.default_rng(23).normal(size=(len(coefficients), 1))
            coefficients = self._under_other_loads(structure, coefficients, z)
        if is_own(structure):
            result = own_composition(structure, coefficients)
            names = [name for name, _ in structure]
            beside = {x: coefficients[:, names.index(x)] for x in ("offset",) if x in names}
            return replace(result, rig=beside, load=load, inputs=dict(self.model.frame.means))
        terms: dict[str, tuple[Any, Array]] = {}
        rig: dict[str, Array] = {}
        for name, shape in structure:
            size = 2 if name == "stribeck_sides" else 1
            own, at = coefficients[:, at : at + size], at + size
            part = PARTS.get(name)
            entries = len(part.shapes) if part else len(shape)
            if part is not None and len(shape) > entries and np.any(shape[entries] != 1.0):
                rig["load_exponent"] = np.broadcast_to(shape[entries], len(own)).astype(float)
            flows = name in (*FLOWS, *FLOW_DIRECTIONS) or name.startswith("viscous")
            if name == "offset":
                rig[name] = own[:, 0]
                if offset:
                    differs = own / load + terms.get("level_direction", ((), 0.0))[1]
                    terms["level_direction"] = (), differs
            elif name == "level_direction":
                terms[name] = (), own / load + terms.get(name, ((), 0.0))[1]
            elif name == "adhesion":
                rig[name] = own[:, 0]
            elif name == "hersey":  # the law at the mean load
                terms["stribeck"] = shape, own / load
            else:
                terms[name] = shape[:entries], own if flows else own / load
        if "adhesion" in rig:  # part of the level at the mean load
            shape, own = terms["level"]
            terms["level"] = shape, own + rig["adhesion"][:, None] / load
        result = compose(terms, self.model.frame.means, len(coefficients))
        return replace(result, rig=rig, load=load)

    def _under_other_loads(self, structure: Shaped, coefficients: Array, z: Array) -> Array:
        """Return coefficients (k, p) over loads that are off by deviations (k, 1)."""
        names = names_of(structure)
        dry = [is_dry(x) if is_slope(x) else x not in NOT_BY_LOAD for x in names]
        over = np.maximum(1.0 + self.load_error * z, 0.1)
        return np.asarray(np.where(dry, coefficients / over, coefficients))

    # ---- weights ----------------------------------------------------------------------------

    def _family(self, structure: Structure, node: tuple[int, ...]) -> Family:
        """Return the family of a structure at a node: with what differs by direction or inputs."""
        frame, names = self.model.frame, {name for name, _ in structure}
        if frame.both:
            for item in SIDES[node[4]]:
                if item == "sides" and "stribeck" in names:
                    names = (names - {"stribeck"}) | {"stribeck_sides"}
                elif item == "viscous_direction" and names & {"viscous", "power"}:
                    names = names | {flow_direction(names)}
                elif item == "offset":
                    names = names | {"level_direction" if frame.loaded else "offset"}
        for name, own in zip(frame.means, node[len(SCALES) :], strict=True):
            parts = (("level", own % 2), ("viscous", own // 2))
            if name == TRANSMITTED:
                names |= {GEAR} if own % 2 and "level" in names else set()
                continue
            names |= {f"{part}*{name}" for part, used in parts if used and part in names}
        return tuple(sorted(names))

    @cached_property
    def _families(self) -> list[list[Family]]:
        """Families of nodes and structures (k, s)."""
        of, result = dict[tuple[int, ...], list[Family]](), list[list[Family]]()
        for node in self.posterior.nodes:
            if (mark := (node[4], *node[len(SCALES) :])) not in of:
                of[mark] = [self._family(item, node) for item in self.posterior.structures]
            result.append(of[mark])
        return result

    def masses(self, tolerance: float) -> tuple[dict[Family, float], dict[Family, float]]:
        """Return the probability of each family, and that with little that no law says."""
        every, adequate = defaultdict[Family, float](float), defaultdict[Family, float](float)
        weights, nodes = self.posterior.weights, self.posterior.nodes
        small = [self.model.unexplained(node) <= tolerance * self.size for node in nodes]
        for k, s in np.argwhere(weights > 1e-7).tolist():
            every[self._families[k][s]] += float(weights[k, s])
            adequate[self._families[k][s]] += float(weights[k, s]) * small[k]
        return every, adequate

    def holds(self, family: Family) -> "NDArray[np.bool_]":
        """Return the nodes and structures (k, s) at which a family holds."""
        return np.array([[item == family for item in row] for row in self._families], dtype=bool)

    def nothing(self) -> "NDArray[np.bool_]":
        """Return the nodes and structures (k, s) at which there is no friction."""
        none = np.array([not structure for structure in self.posterior.structures])
        still = np.array([not self.model.unexplained(node) for node in self.posterior.nodes])
        return np.asarray(still[:, None] & none)

    # ---- curves -----------------------------------------------------------------------------

    def _law(self, rows: Rows, draws: Sequence[Draws]) -> Array:
        """Return the laws of draws at rows (k, n)."""
        usual = [item for draw in draws for item in draw.structure if not is_break(item[0])]
        place = {item: k for k, item in enumerate(dict.fromkeys(usual))}
        x = [law_column(item, rows, self.model.frame) for item in place]
        ends = np.cumsum([0, *(draw.random.shape[1] for draw in draws)])
        c, breaks = np.zeros((ends[-1], len(x))), np.zeros((ends[-1], len(rows.velocity)))
        for first, last, draw in zip(ends, ends[1:], draws, strict=False):
            for column, own in zip(draw.structure, draw.law, strict=True):
                if column in place:
                    c[first:last, place[column]] = own
                else:
                    breaks[first:last] += own[:, None] * self._breaks(rows, column, len(own))
        return np.asarray(c @ np.reshape(x, (len(x), -1)) + breaks) if x else breaks

    def _breaks(self, rows: Rows, column: Column, count: int) -> Array:
        """Return columns (k, n) of a jump or kink anywhere in its gap, at evenly many places."""
        name, (low, high) = column
        share = (np.arange(count)[:, None] + 0.5) / count
        places = low * (high / low) ** share if is_ratio(name) else low + (high - low) * share
        return break_column(name, places, rows, self.model.frame)

    def steady(self, rows: Rows, draws: Sequence[Draws]) -> Array:
        """Return drawn curves alone (k, n): midway unless stated, in the mean of the runs."""
        result, random = self._law(rows, draws), np.hstack([draw.random for draw in draws])
        by_speed = self._by_speed(draws)
        for at, own in ((~by_speed, rows), (by_speed, self.model.sorted_in(rows))):
            if at.any():
                x, group = self.model.random(own)
                result[at] += random[:, at].T @ (x * (group != "run")).T
        return result

    def _by_speed(self, draws: Sequence[Draws]) -> "NDArray[np.bool_]":
        """Return in which draws (k,) the course over a sorted order is one over the speed."""
        courses = of_each(draws, lambda x: x.node[5] * self.model.is_by_speed) > 0.0
        of_time = np.diff(np.floor(OF_TIME * np.cumsum(courses) + 0.5), prepend=0.0) > 0.0
        return np.asarray(courses & ~of_time)

    def friction(self, rows: Rows, draws: Sequence[Draws], *, new: bool = False) -> Array:
        """Return what friction is in draws (k, n): early, midway or late, in any or a new run."""
        rng = np.random.default_rng(7)
        curves = self._law(rows, draws)
        random = np.hstack([draw.random for draw in draws])
        when = rng.integers(3, size=len(curves))
        stated, by_speed = np.isfinite(rows.order), self._by_speed(draws)
        when = np.where(by_speed, 3, 0 if stated.all() else when)
        moments = [replace(rows, order=np.where(stated, rows.order, x)) for x in (0.0, 0.5, 1.0)]
        for k, own in enumerate([*moments, self.model.sorted_in(rows)]):
            at = when == k
            if at.any():
                x, group = self.model.random(own)
                curves[at] += random[:, at].T @ x.T
        if self.model.frame.runs > 1 and not np.all(rows.run >= 0):
            count = len(curves)
            effects = random[group == "run"].reshape(2, self.model.frame.runs, count)
            which = rng.integers(self.model.frame.runs, size=count)
            # one of the runs that were measured, or another one: draws have a deviation each
            each = of_each(draws, lambda x: self.model.run_deviations(x.node)).T
            other = each * rng.normal(size=(2, count))
            is_new = new or np.all(rows.run == -2)
            effect = other if is_new else effects[:, which, np.arange(count)]
            curves += effect.T @ self.model.run_parts(rows).T
        if np.all(rows.run == -2):  # at another time friction is off by as much as it drifts
            deviations = of_each(draws, lambda x: DRIFTS[x.node[5]]) * ~by_speed
            off = deviations * rng.normal(size=len(curves))
            curves += np.outer(off, self.model.reference(rows) * rows.direction)
        curves += self._at_ends(rows, draws)
        return np.asarray(curves + self._beyond(rows, draws, curves, rng))

    def _at_ends(self, rows: Rows, draws: Sequence[Draws]) -> Array:
        """Return what makes draws pass through readings alone at an end that are far away (k, n).

        They may be friction as well as outliers: half of the draws take them so, of which half go
        on to the next reading with the logarithm of the speed, and half jump.
        """
        count, rng = sum(draw.random.shape[1] for draw in draws), np.random.default_rng(5)
        result, own = np.zeros((count, len(rows.velocity))), self.table.rows
        for row in self._far_ends:
            same = own.direction == own.direction[row]
            others = np.log(own.speed[same & (np.abs(np.log(own.speed / own.speed[row])) > NEAR)])
            log = math.log(own.speed[row])
            near = float(others[np.argmin(np.abs(others - log))])
            share = np.clip((np.log(rows.speed) - near) / (log - near), 0.0, 1.0)
            share = share * (rows.direction == own.direction[row])
            at = self._row(row)
            off = self.table.friction[row] - self.steady(at, draws)
            noise = [self.model.sigma(x.node) * self.model.growth(at, x.node)[0] for x in draws]
            each = np.repeat(noise, [x.random.shape[1] for x in draws])
            off = off + rng.normal(size=(count, 1)) * each[:, None]
            jumps = off[2::4]
            places = (np.arange(len(jumps))[:, None] + 0.5) / max(len(jumps), 1)
            result[::4] += off[::4] * share
            result[2::4] += jumps * (share > places)
        return result

    def _row(self, row: int) -> Rows:
        """Return a row that was measured, midway and in the mean of the runs."""
        own = self.table.rows.where(np.array([row]))
        return self.at(own.velocity, own.load, own.inputs)

    @cached_property
    def _far_ends(self) -> list[int]:
        """Readings alone at an end that are far from the others, and may be friction."""
        rows, result = self.table.rows, list[int]()
        suspects = np.flatnonzero(ends_of(rows) & (self.weights < 1.0)).tolist()
        draws = self.posterior.draws(DRAWS, seed=3) if suspects else []
        for row in suspects:
            alike = (rows.direction == rows.direction[row]) & (
                np.abs(np.log(rows.speed / rows.speed[row])) < NEAR
            )
            usual = float(np.median(self.steady(self._row(row), draws)))
            off = float(self.table.friction[row]) - usual
            if np.sum(alike) == 1 and abs(off) <= AT_ENDS * abs(usual):
                result.append(row)
        return result

    def _beyond(
        self, rows: Rows, draws: Sequence[Draws], curves: Array, rng: np.random.Generator
    ) -> Array:
        """Return what friction may do beyond the measured speeds (k, n)."""
        frame, logs = self.model.frame, np.log(rows.speed)
        far = (
            np.maximum(math.log(frame.slowest) - logs, 0.0),
            np.maximum(logs - math.log(frame.fastest), 0.0),
        )
        tau = of_each(draws, lambda x: self.model.unexplained(x.node))
        result = np.zeros_like(curves)
        for own in far:
            e = rng.normal(size=(2, len(curves)))
            side = np.where(rows.velocity > 0.0, e[0][:, None], (0.9 * e[0] + 0.44 * e[1])[:, None])
            side = side if frame.both else e[0][:, None]
            size = BEYOND[0] * np.abs(curves) + BEYOND[1] * tau[:, None] * frame.grown(rows)
            result += rows.direction * side * size * own
        return result

    def _noise(self, rows: Rows, draws: Sequence[Draws]) -> Array:
        """Return noise of new readings in draws (k, n)."""
        rng = np.random.default_rng(11)
        model, n = self.model, len(rows.velocity)
        result = []
        for draw in draws:
            shape = (draw.random.shape[1], n)
            noise = rng.standard_t(6.0, size=shape) * math.sqrt(4.0 / 6.0)
            sigma = model.sigma(draw.node)
            own = sigma * model.growth(rows, draw.node) * noise
            own += sigma * BETA[draw.node[3]] * model.repeats * rng.normal(size=shape)
            own += float(np.median(self.table.stated)) * rng.normal(size=shape)
            result.append(own + model.step * (rng.random(shape) - 0.5))
        return np.vstack(result)

    def readings(self, rows: Rows, draws: Sequence[Draws]) -> Array:
        """Return new readings in draws (k, n)."""
        return self.friction(rows, draws) + self._noise(rows, draws)

    def points(self, rung: Rung) -> MeasuredPoints:
        """Return the readings."""
        rows = self.table.rows
        return MeasuredPoints(
            velocity=rows.velocity,
            friction=self.table.friction,
            load=rows.load,
            weights=self.weights,
        )

    # ---- what stands beside the law ---------------------------------------------------------

    def untold(self) -> list[str]:
        """Return sentences on inputs that cannot be distinguished from runs, and on the cure."""
        frame, rows, result = self.model.frame, self.table.rows, list[str]()
        if "offset" not in self.model.groups and not frame.loaded:
            result.append(f"{ONE_WAY} Measure in the other direction, too.")
        if self.model.step and self.model.is_equal and not np.median(self.table.stated):
            half = quantity(0.5 * self.model.step, "N m" if self.turning else "N", 2)
            result.append(EQUAL.format(half, percent(0.5 * COARSEST)))
        if copies := self.table.copies:
            result.append(
                "Readings at the same setting are all equal, as copies or rounded readings are, and"
                f" say little of the noise: {copies} are left out."
            )
        if not 1 < frame.runs < len(rows.run):
            return result
        of_runs = (rows.run[:, None] == np.arange(frame.runs)).astype(float)
        for name in frame.means:
            x = rows.inputs[name]
            within = x - of_runs @ np.linalg.lstsq(of_runs, x, rcond=None)[0]
            if 1.0 - np.var(within) / np.var(x) > FOLLOWS:
                result.append(
                    f"An effect of the {name} can be distinguished from differences between the"
                    f" {frame.runs} runs only if these are small: it hardly changes within a run."
                    f" Change the {name} within a run, or repeat a run at the same {name}."
                )
        return result

    def findings(self, draws: Sequence[Draws]) -> list[Finding]:
        """Return drifts, differences between runs, and breaks over the load or an input."""
        frame = self.model.frame
        result = [self._drift(draws), *self.limits]
        result += [self._break(x, draws) for x in (*["load"] * frame.loaded, *frame.means)]
        if self.model.frame.runs > 1:
            result.append(self._differences(draws))
        return [item for item in result if item.probability > 0.5]

    @property
    def over(self) -> tuple[str, Rows] | None:
        rows = self.table.rows
        names = [LOAD] * self.model.frame.loaded + [*rows.inputs]
        if not names or speeds_of(rows) > 1:
            return None
        return names[0], self.at(rows.velocity, rows.load, rows.inputs)

    @property
    def _middle_speed(self) -> float:
        """Median of the velocities of a direction [m/s]."""
        rows = self.table.rows
        middle = float(np.exp(np.median(np.log(rows.speed))))
        return middle if (rows.velocity > 0.0).any() else -middle

    def _drift(self, draws: Sequence[Draws]) -> Finding:
        """Return what friction changes by from the first reading to the last."""
        frame, at = self.model.frame, self.at(self._middle_speed)
        times = [replace(at, order=np.full(1, time)) for time in (0.0, 1.0)]
        ends = [np.abs(self.steady(x, draws)[:, 0]) for x in times]
        change = (ends[1] - ends[0]) / np.maximum(np.abs(np.median(ends[0])), 1e-3 * frame.size)
        unit = "N m" if self.turning else "N"
        first, last = (quantity(float(np.median(end)), unit, 3) for end in ends)
        likely = 1.0 - float(self.posterior.scale("drift")[0])
        verb = "falls" if np.median(change) < 0.0 else "rises"
        return stated(
            "drift",
            "drift in the order of measuring",
            likely * (OF_TIME if self.model.is_by_speed else 1.0),
            change,
            f"Friction {verb} over the readings, from {first} at the first to {last} at the last.",
        )

    def _break(self, over: str, draws: Sequence[Draws]) -> Finding:
        """Return the jump of friction over the load or an input: a kink has no certain place."""
        frame, rows, name = self.model.frame, self.table.rows, f"{JUMP} {over}"
        shares = zip(self.posterior.structures, self.posterior.shares.tolist(), strict=True)
        likely = min(sum(share for law, share in shares if name in family_of(law)), 1.0)
        title = f"break of friction over the {over}"
        if likely < 0.5:
            return stated("break", title, likely, np.zeros(1), "")
        ends, sizes = list[tuple[float, ...]](), list[Array]()
        largest = float((rows.load if over == "load" else rows.inputs[over]).max())
        last = {over: largest}
        at = self.at(self._middle_speed, last.get("load"), last)
        for draw in draws:
            for (term, gap), coefficient in zip(draw.structure, draw.law, strict=True):
                if term == name:  # what it adds at the largest value, over friction there
                    added = coefficient * law_column((name, gap), at, frame)[0] * at.direction[0]
                    total = np.abs(self.steady(at, [draw])[:, 0])
                    sizes.append(added / np.maximum(total, 1e-3 * frame.size))
                    ends += [gap] * len(added)
        low, high = np.quantile(np.array(ends), (0.025, 0.975), axis=0)
        change = np.concatenate(sizes)
        unit = CONTACT_INPUTS[over].unit if over in CONTACT_INPUTS else "N" * (over == "load")
        sign, more = (-1.0, "less") if np.median(change) < 0.0 else (1.0, "more")
        middle, *span = map(percent, np.quantile(sign * change, (0.5, 0.025, 0.975)).tolist())
        sentence = (
            f"Friction over the {over} breaks between {quantity(low[0], unit, 3)} and"
            f" {quantity(high[1], unit, 3)}: at {quantity(largest, unit, 3)} it is {more}, by"
            f" {middle} of friction there ({span[0]} to {span[1]}), than readings below the break"
            " suggest."
        )
        return stated("break", title, likely, change, sentence)

    def _differences(self, draws: Sequence[Draws]) -> Finding:
        """Return by how much friction differs from run to run."""
        model, count = self.model, self.model.frame.runs
        at = replace(self.at(np.full(count, self._middle_speed)), run=np.arange(count))
        x = model.random(at)[0] * (model.groups == "run")
        effects = x @ np.hstack([draw.random for draw in draws]) / model.reference(at)[:, None]
        apart = np.std(effects, axis=0, ddof=1)
        shares = map(percent, np.quantile(apart, (0.5, 0.025, 0.975)).tolist())
        said = "The {} runs differ by {} of friction (standard deviation, 95 % {} to {})."
        sentence = said.format(count, *shares)
        likely = 1.0 - float(self.posterior.scale("run")[0])
        return stated("run", "differences between runs", likely, apart, sentence)

    def curve_rows(self) -> Rows:
        """Return rows through which a curve is drawn as a law."""
        frame = self.model.frame
        side = 1.0 if (self.table.rows.velocity > 0.0).any() else -1.0
        return self.at(
            side * np.geomspace(frame.slowest, max(frame.fastest, 1.001 * frame.slowest), POINTS)
        )

    def errors(self, rows: Rows) -> tuple[Array, Array]:
        """Return the deviation of a reading of another run (n,), and what readings share (n, n).

        Readings at one row are a block, whose error they share, as all share that of the run: a
        covariance.
        """
        count = len(rows.velocity)
        noise, shared = np.zeros(count), np.zeros((count, count))
        along = self.model.run_parts(rows) * (self.model.frame.runs > 1)
        for node, p in zip(self.posterior.nodes, self.posterior.weights.sum(axis=1), strict=True):
            if p > 1e-3:
                sigma = self.model.sigma(node)
                noise += p * (sigma * self.model.growth(rows, node)) ** 2
                block = (BETA[node[3]] * self.model.repeats * sigma) ** 2
                run = along * self.model.run_deviations(node)
                shared += p * (block * np.eye(count) + run @ run.T)
        return np.sqrt(noise + float(np.median(self.table.stated)) ** 2), shared

    def scatter(self, rung: Rung) -> float:
        """Return the standard deviation of the readings about a law [N], outliers as they count."""
        rows = self.table.rows
        at = self.at(rows.velocity, rows.load, rows.inputs)
        left = self.table.friction - self.design(rung.structure, at) @ rung.coefficients
        squares = left**2 * self.table.count + self.table.within
        return math.sqrt(
            float(np.sum(self.weights * squares)) / float(np.sum(self.weights * self.table.count))
        )

    @property
    def outliers(self) -> dict[int, float]:
        """Readings that are far from the others, with how many deviations."""
        if np.any(self.table.count > 1.0):
            return {}
        far, places = self.fit.far[self._of_table], np.rint(self.table.rows.order * self.table.last)
        return {int(places[k]): float(far[k]) for k in np.flatnonzero(far > THRESHOLDS.outlying)}


def at_none(table: Readings, limits: Iterable[Limit]) -> "NDArray[np.bool_]":
    """Return which readings of a table are at none of some limits (n,)."""
    reached = [row for limit in limits for row in limit.rows.tolist()]
    return ~np.isin(np.arange(len(table.friction)), reached)


def limited(table: Readings, limits: Sequence[Limit], turning: bool) -> InputError:
    """Return why a table with too few readings beside limits has no law."""
    free, unit = at_none(table, limits), "N m" if turning else "N"
    values = joined([quantity(limit.value, unit, 3) for limit in limits])
    cures = ["a larger range" if limit.value else "a lower threshold" for limit in limits]
    cure = joined([*dict.fromkeys(cures)])
    return InputError(LIMITED.format(np.sum(~free), len(free), values, cure))


def censored(
    table: Readings, limits: Sequence[Limit], families: Sequence[Family], problem: TableProblem
) -> TableFit:
    """Return the fit of readings of which some are at limits, by the problem of the others."""
    known = replace(table, friction=table.friction.copy(), stated=table.stated.copy())
    for again in (False, True):
        for limit in limits:
            rows = table.rows.where(limit.rows)
            curves = problem.friction(rows, problem.posterior.draws(DRAWS, seed=2))
            middle, variance = np.mean(curves, axis=0), np.var(curves, axis=0)
            noise = problem.errors(rows)[0]
            if again:  # without what is taken of it already
                middle, variance = without_site(
                    middle, variance, known.friction[limit.rows],
                    known.stated[limit.rows] ** 2 + noise**2,
                )  # fmt: skip
            value, error = limit.site(middle, variance, noise, rows.direction)
            known.friction[limit.rows], known.stated[limit.rows] = value, error
        problem = TableProblem(table, fitted(known, families))
    return problem.fit


def of_each(draws: Sequence[Draws], value: Callable[[Draws], Array | float]) -> Array:
    """Return a value of the node of each draw (k,), or several (k, m)."""
    numbers = [draw.random.shape[1] for draw in draws]
    return np.repeat([value(draw) for draw in draws], numbers, axis=0)


def known_terms(table: Readings) -> list[str]:
    """Return the names of the terms that a table can tell."""
    frame = Frame.of(table)
    result = [*PARTS]
    if frame.loaded:
        result.append("adhesion")
    if frame.both:
        level = "level_direction" if frame.loaded else "offset"
        result += [level, "viscous_direction", "stribeck_sides"]
    inputs = [name for name in frame.means if name != TRANSMITTED]
    result += [GEAR] * (TRANSMITTED in frame.means)
    return result + [f"{part}*{name}" for name in inputs for part in ("level", "viscous")]


def sized(inputs: Mapping[str, Array]) -> dict[str, Array]:
    """Return inputs (n,), of what a gear transmits the size: it loads the gear both ways.

    Examples
    --------
    >>> sized({"transmitted": np.array([-2.0]), "pressure": np.array([-1.0])})
    {'transmitted': array([2.]), 'pressure': array([-1.])}
    """
    return {name: np.abs(x) if name == TRANSMITTED else x for name, x in inputs.items()}


def parts_of(family: Family) -> Family:
    """Return the parts of a law among the terms of a family.

    Examples
    --------
    >>> parts_of(("level", "offset", "stribeck_sides", "viscous"))
    ('level', 'stribeck', 'viscous')
    """
    names = ("stribeck" if name in ("hersey", "stribeck_sides") else name for name in family)
    return tuple(sorted({name for name in names if name in PARTS or name == GEAR}))


def readings_of(mechanism: Mechanism, measurement: Measurement) -> Readings:
    """Return the readings of a measured table that slide."""
    check_loads(measurement)
    records = measurement.records()
    tables = [_table(mechanism, record) for record in records]
    parts, frictions, stated = list[Rows](), list[Array](), list[Array]()
    rests = list[Array]()
    begun, total = 0, sum(len(friction) for _, friction in tables)
    for k, ((table, friction), record) in enumerate(zip(tables, records, strict=True)):
        v, count = table.velocity, len(friction)
        # sweeps under other loads or temperatures differ by these
        same = not any(varies(x) for x in (table.load, *table.inputs.values()))
        run = sweeps_of(v) if len(tables) == 1 and same else np.full(count, k)
        order = np.arange(begun, begun + count) / max(total - 1, 1)
        parts.append(replace(table, run=run, order=order).where(v != 0.0))
        frictions.append(friction[v != 0.0])
        rests.append(np.asarray(record.values("velocity"), dtype=float)[v == 0.0])
        own_errors = record.uncertainty.get("friction", 0.0)
        stated.append(np.broadcast_to(np.asarray(own_errors, dtype=float), (count,))[v != 0.0])
        begun += count
    rows = with_runs(joined_rows(parts))
    if len(rows.velocity) < FEWEST:
        raise InputError(
            f"a table of friction needs at least {FEWEST} readings that slide, and this has"
            f" {len(rows.velocity)}: measure friction at more speeds."
        )
    if not _moves(rows):
        raise InputError(
            f"a table of friction needs at least {FEW_SPEEDS} speeds, or loads or values of an"
            f" input, in one direction, and this has {_most(rows)}: measure friction at more."
        )
    result = Readings.of(rows, np.concatenate(frictions), np.concatenate(stated))
    return replace(result, last=total - 1, at_rest=np.concatenate(rests))


def _refuse_others(record: Measurement) -> None:
    """Refuse a record that is not one of friction."""
    label = f"record {record.name!r}" if record.name else "the record"
    known = record.quantities()
    had = f"{label} has only {joined(known)}"
    if "friction" not in known:
        raise InputError(f"a force map needs friction (F) [N], and {had}.")
    if record.kind != "friction-map":
        raise InputError(
            f"a force map needs arrays, and {had} as single numbers: give friction and velocity"
            " as arrays, with time [s] if the law has a memory."
        )
    if not {"velocity", "position"} & set(known):
        raise InputError(
            f"a force map needs velocity (v) [m/s] or position (x) [m] beside friction, and {had}."
            + " Friction under a load point is fitted by rate-and-state laws: leave out the route,"
            " or give route='rate-state'." * ("pull" in known)
        )


def _table(mechanism: Mechanism, record: Measurement) -> tuple[Rows, Array]:
    """Return the rows of a table, 0 where they rest, with their friction (n,)."""
    _refuse_others(record)
    own = with_values(mechanism, "mechanism", record.overrides)
    friction = np.asarray(record.values("friction"), dtype=float)
    velocity = np.asarray(record.values("velocity"), dtype=float)
    load = load_along(own, record, len(friction))
    velocity = np.where(resting_readings(velocity, friction / load), 0.0, velocity)
    force = record.values("force") if isinstance(record.force, np.ndarray) else math.nan
    number = np.arange(len(friction), dtype=float)
    inputs = inputs_along(own, record, number, velocity=velocity, force=np.asarray(force))
    rows = Rows(
        velocity=velocity,
        load=load,
        inputs=sized(inputs),
        run=np.zeros(len(number), dtype=np.intp),
        order=number,
    )
    return rows, friction


def load_error_of(mechanism: Mechanism, measurement: Measurement) -> float:
    """Return the stated standard uncertainty of the normal force in the mean of records, over it.

    What was set anew for each record averages out.
    """
    parts, count = uncertainties_of(mechanism, measurement), len(measurement.records())
    refuse_load({path for part in parts for item in part for path in item}, measurement)
    total = 0.0
    for places, each in ((0, 1.0 / count), (1, 1.0)):
        for path in dict.fromkeys(item for part in parts for item in part[places]):
            doubt = max(part[places].get(path, 0.0) for part in parts)
            slope, _ = load_slopes(mechanism, (), {path: doubt}).get(path, (0.0, 0.0))
            total += each * (slope * doubt) ** 2
    return math.sqrt(total) / load_of(mechanism) if total else 0.0


def with_runs(rows: Rows) -> Rows:
    """Return rows of which runs are runs: steps at a speed each are repeats, and no runs."""
    spread = [np.ptp(np.log(rows.speed[rows.run == k])) for k in np.unique(rows.run)]
    return rows if np.median(spread) > STEADY else replace(rows, run=np.zeros_like(rows.run))


def _moves(rows: Rows) -> bool:
    """Return whether there are several speeds, loads or values of an input in a direction."""
    return _most(rows) >= FEW_SPEEDS and len(rows.velocity) >= FEWEST


def _most(rows: Rows) -> int:
    """Return the largest number of speeds, loads or values of an input in a direction."""
    every = (rows.velocity, rows.load, *rows.inputs.values())
    return max(len(np.unique(x[rows.direction == way])) for way in (-1.0, 1.0) for x in every)


def varies(x: Array) -> bool:
    """Return whether values (n,) differ by more than rounding.

    Examples
    --------
    >>> varies(np.array([3e6, np.nextafter(3e6, 4e6)])), varies(np.array([293.0, 294.0]))
    (False, True)
    """
    return bool(np.ptp(x) > THRESHOLDS.rounding * np.max(np.abs(x)))


def joined_rows(parts: Sequence[Rows]) -> Rows:
    """Return the rows of several tables; only inputs that all have are kept."""
    names = set.intersection(*(set(part.inputs) for part in parts))
    return Rows(
        velocity=np.concatenate([part.velocity for part in parts]),
        load=np.concatenate([part.load for part in parts]),
        inputs={
            name: x
            for name in sorted(names)
            if varies(x := np.concatenate([part.inputs[name] for part in parts]))
        },
        run=np.concatenate([part.run for part in parts]),
        order=np.concatenate([part.order for part in parts]),
    )


def sweeps_of(velocity: Array) -> "NDArray[np.intp]":
    """Return the number of the sweep of each row (n,), if each meets all speeds once.

    Examples
    --------
    >>> sweeps_of(np.array([0.1, 0.2, 0.3, 0.1, 0.2, 0.3])).tolist()
    [0, 0, 0, 1, 1, 1]
    >>> sweeps_of(np.array([0.1, 0.1, 0.2, 0.2, 0.3, 0.3])).tolist()
    [0, 0, 0, 0, 0, 0]
    """
    known, count = np.unique(velocity), len(velocity)
    sweeps = np.arange(count) // len(known)
    parts = [velocity[sweeps == k] for k in range(int(sweeps[-1]) + 1)]
    alike = all(np.array_equal(np.sort(part), known) for part in parts)
    return sweeps if alike and len(parts) > 1 and len(known) > 2 else np.zeros(count, dtype=int)


def slow_rows(table: Readings) -> "NDArray[np.intp]":
    """Return the slowest rows of each direction whose friction is below that at the next speeds.

    Speeds of a body at rest are noise, so that of several numbers of such rows that is taken after
    which the speed rises most.
    """
    rows, result = table.rows, list[int]()
    for way in (-1.0, 1.0):
        at = np.flatnonzero(rows.direction == way)
        at = at[np.argsort(rows.speed[at], kind="stable")]
        size, rises = np.abs(table.friction[at]), np.diff(np.log(rows.speed[at]))
        below = [
            count
            for count in range(1, 1 + min(MOST_RESTS, len(at) - BESIDE_SLOWEST))
            if np.all(size[:count] < REST * np.median(size[count : count + BESIDE_SLOWEST]))
        ]
        result += at[: max(below, key=lambda count: rises[count - 1], default=0)].tolist()
    return np.array(sorted(result), dtype=np.intp)
