"""Records of one coordinate as a problem of the judgement: curves, readings, laws, findings."""

import copy
import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.bands import MeasuredPoints
from stickslip.identify.forces import TRANSMITTED
from stickslip.identify.judgement import ONE_WAY, Candidates, Finding, Problem, stated
from stickslip.identify.laws import (
    CHANGING,
    DIRECTIONS,
    FLOWS,
    POINTS,
    Composition,
    bounds_of,
    compose,
    own_composition,
    term_title,
)
from stickslip.identify.own_laws import Slips, is_own, is_slope
from stickslip.identify.posterior import (
    Array,
    Column,
    Draws,
    Family,
    Structure,
    family_of,
)
from stickslip.identify.problems.record_columns import (
    FORCE,
    LEVELS,
    LUGRE,
    RESOLVED,
    Balance,
    Memory,
    law_column,
)
from stickslip.identify.problems.record_curves import (
    OtherRows,
    SteadyRows,
    beyond,
    of_another_run,
    readings,
    resolved_speeds,
    slips_of,
    steady_column,
    steady_curves,
)
from stickslip.identify.problems.record_model import SCALES, RecordModel, laws_of
from stickslip.identify.problems.record_rows import MIDDLE, SHORT
from stickslip.identify.problems.record_signals import Record
from stickslip.identify.projection import LOADS, MARGIN, TOLERANCE, Rung, Shaped
from stickslip.identify.vocabulary import (
    DRY,
    FLOW_DIRECTIONS,
    GEAR,
    PARTS,
    STEP,
    Grid,
    flow_direction,
    parameters_of,
)
from stickslip.identify.wording import share_text
from stickslip.show.formatting import joined, percent, quantity

PLACES, ASKED = 25, 40
"""Speeds of each direction at which laws are compared, and at which the band is stated."""
DRAWN = 400
"""Rows that a figure shows."""
FARTHER = 0.75
"""Distance from turns, over that of the farthest row, from which rows are apart from these."""
LOAD = "load"
"""Name of the load beside those of inputs."""
MEMORIES = ("dahl", "lugre")
"""Laws with bristles."""
SEEN, SURE, ROWS = 0.05, 20.0, 7
"""Root mean square of what bristles lack of being stretched, odds against none, and rows in which
they lack as much, from which presliding is named: fewer rows may be those of one turn."""
DAMPED = 0.03
"""Damping of bristles over the critical one of the inertia on them, from which they have one."""
VARIES = 0.1
"""Range of the length of bristles, over that at one speed, from which it follows the level."""
FINDINGS: Mapping[str, str] = {
    "drift": "drift over the record",
    "place": "level that changes with the place",
    "force": "force that changes with the place or in time",
    "run": "differences between runs",
}
"""What may stand beside a law, as scales of the posterior."""
GIVEN: Mapping[str, str] = {
    "inertia": "inertia larger or smaller than given",
    "mechanism": "known forces larger or smaller than given",
    "body": "rigid body heavier or lighter than given",
}
"""What may be given wrong."""
MISTAKEN = 1.0
"""Size of what is given wrong from which it is a mistake: its prior is that of the last two sizes,
of five careful experimenters in hundred."""
NEGLIGIBLE = 0.01
"""Size over friction below which what stands beside a law is negligible."""


@dataclass(eq=False)
class RecordProblem(Problem):
    """Records of one coordinate with their posterior.

    Parameters
    ----------
    records : sequence of Record
        What was measured.
    normal : float
        Normal force at which levels are stated [N].
    inertia_path : str
        Path of the inertia, if it is looked for.
    load_slopes : mapping of str to pair of float
        By how much parameters change the normal force, and their values.
    offset : str
        Path of the constant force; empty if it is known.
    families : sequence of Family, optional
        Families of laws that are compared.
    turning : bool
        Whether the coordinate is an angle.
    highest : float
        Largest cutoff [Hz].
    timed : bool
        Whether it is known how forces run between samples.
    """

    records: Sequence[Record]
    normal: float = 1.0
    inertia_path: str = ""
    load_slopes: Mapping[str, tuple[float, float]] | None = None
    offset: str = "offset"
    families: Sequence[Family] | None = None
    turning: bool = False
    highest: float = math.inf
    timed: bool = False

    def __post_init__(self) -> None:
        known = None
        if self.families is not None:
            known = [*dict.fromkeys(map(parts_of, self.families))]
        self.model = RecordModel(
            self.records, families=known, highest=self.highest, timed=self.timed
        )
        self.posterior = self.model.posterior()
        self.size = self.model.size
        self.load = self.normal
        self.runs = self.model.balance.runs
        self.restricted = known is not None
        if self.offset.startswith("mechanism."):
            self.looked_for = frozenset({"offset"})

    def with_laws(self, own: Sequence[Structure], families: Sequence[Family]) -> "RecordProblem":
        result = copy.copy(self)
        of_draws = (
            "changing",
            "beside",
            "_is_load_told",
            "of_load",
            "grid",
            "_left",
            "_usual",
            "_middle",
            "_noisier",
        )
        for name in ("families_of_structures", *of_draws):
            result.__dict__.pop(name, None)
        result.families, result.restricted = (*families, *map(family_of, own)), True
        result.model = self.model.with_laws(own)
        result.posterior = result.model.posterior()
        return result

    def slips(self, rows: SteadyRows) -> Slips:
        return slips_of(self.model.balance, rows)

    # ---- rows -------------------------------------------------------------------------------

    def at(
        self, velocity: Any, load: Any = None, inputs: Mapping[str, Any] | None = None
    ) -> SteadyRows:
        """Return rows of steady sliding at velocities (n,); the rest is usual if not given."""
        frame = self.model.frame
        v = np.atleast_1d(np.asarray(velocity, dtype=float))
        ones, given = np.ones(len(v)), inputs or {}
        usual = frame.load if frame.load != 1.0 else self.normal
        ratio = ones * (1.0 if load is None else np.asarray(load, dtype=float) / usual)
        through = given.get(TRANSMITTED, sum(frame.transmitted[1:2])) if frame.transmitted else 0.0
        return SteadyRows(
            velocity=v,
            load=usual * ratio,
            ratio=ratio,
            transmitted=np.abs(through) / ratio,
            inputs={
                name: ones * (given.get(name, mean) - mean) / size
                for name, (mean, size) in frame.inputs.items()
            },
        )

    def asked(self) -> SteadyRows:
        """Return the speeds over which the band is stated: those resolved in each direction."""
        return self.at(resolved_speeds(self.model, ASKED))

    def places(self) -> SteadyRows:
        """Return the speeds at which curves are projected."""
        return self._places

    @cached_property
    def _places(self) -> SteadyRows:
        v, frame = resolved_speeds(self.model, PLACES), self.model.frame
        changing = {item.partition("*")[2] for item in self.changing}
        points: list[dict[str, float]] = [{}]
        if frame.transmitted:
            points = [{TRANSMITTED: x} for x in frame.transmitted]
        for name in changing:
            mean, size = frame.inputs[name]
            points = [{**point, name: mean + k * size} for point in points for k in (-1.0, 1.0)]
        if self._is_load_told:
            points = [{**point, LOAD: x} for point in points for x in self._loads]
        each = {name: np.repeat([x[name] for x in points], len(v)) for name in points[0]}
        return self.at(np.tile(v, len(points)), each.pop(LOAD, None), each)

    @cached_property
    def _loads(self) -> Array:
        """Loads from a tenth to nine tenths of the records (5,) [N]: two tell no power."""
        loads = [piece.record.load for piece in self.model.balance.pieces]
        every = np.concatenate([x for x in loads if x is not None])
        return np.asarray(np.quantile(every, np.linspace(0.1, 0.9, 5)))

    @cached_property
    def _is_load_told(self) -> bool:
        """Whether levels are told not to be in proportion to the load."""
        if self.model.frame.load == 1.0 or self.families is not None:
            return False
        own = [
            np.diff(self.model.split(draw.node, draw.random)["load"][::-1], axis=0)[0]
            for draw in self._usual
        ]
        slope = np.concatenate(own) / self.size
        low, high = np.quantile(slope, (0.025, 0.975))
        return bool(not low <= 0.0 <= high and abs(np.median(slope)) > TOLERANCE)

    @cached_property
    def of_load(self) -> float:
        """Power of the load that levels follow; 0 where a part is one that no load changes.

        The latter is taken where it clearly leaves less of the curves at several loads.
        """
        law = self.posterior.law_at(self.posterior.best) if self._is_load_told else ()
        if not any(name in DRY for name, _ in law):
            return 1.0
        rows = self._places
        size = np.mean(np.abs(y := np.mean(self.steady(rows, self._usual), axis=0))) * rows.ratio
        powers = np.round(np.arange(LOADS[0], LOADS[1] + 0.5 * STEP, STEP), 6).tolist()
        laws = {a: with_power(law, a) for a in powers}
        if "level" in dict(law):
            laws[0.0] = (*law, ("adhesion", ()))
        left = dict[float, float]()
        for power, item in laws.items():
            x = self.design((*item, *[("offset", ())] * ("offset" in self.beside)), rows)
            c = np.linalg.lstsq(x / size[:, None], y / size, rcond=None)[0]
            left[power] = float(np.linalg.norm((y - x @ c) / size))
        best = min((a for a in left if a), key=lambda a: left[a])
        return 0.0 if left.get(0.0, math.inf) * MARGIN < left[best] else best

    def like(self, records: Sequence[Record]) -> OtherRows:
        """Return the rows of other records, which are another run."""
        return OtherRows(balance=Balance(records, like=self.model.balance))

    def usual(self, rows: OtherRows) -> Array:
        own = self.model.balance
        c = np.linalg.lstsq(own.plain(), own.rows(MIDDLE).response, rcond=None)[0]
        return np.asarray(rows.balance.plain() @ c)

    def at_rest(self, records: Sequence[Record]) -> OtherRows:
        """Return the rows of other records at rest, where friction is up to its level."""
        return OtherRows(balance=Balance(records, like=self.model.balance, rests=True))

    def curve_rows(self) -> SteadyRows:
        """Return rows through which a curve is drawn as a law."""
        v = self.asked().velocity
        side = 1.0 if (v > 0.0).any() else -1.0
        moved = side * v[side * v > 0.0]
        return self.at(side * np.geomspace(moved.min(), moved.max(), POINTS))

    @property
    def run_sizes(self) -> tuple[Sequence[float], Sequence[float]]:
        """By how much runs differ, over friction, with the probabilities: those of a few are known.

        What other runs than the one that was made differ has its prior.
        """
        if self.runs > 1:
            return SCALES["run"][0], self.posterior.scale("run").tolist()
        return SCALES["run of a joint" if self.model.balance.pieces[0].record.joint else "run"]

    # ---- laws -------------------------------------------------------------------------------

    def columns(self, column: tuple[str, Any], rows: SteadyRows) -> list[Array]:
        """Return the columns of a term of a law at rows (n,), or (k, n) for shapes of k draws."""
        name, shape = column
        if name in DRY and len(shape) > len(PARTS[name].shapes):
            of_load = rows.ratio ** (shape[-1] - 1.0)
            return [x * of_load for x in self.columns((name, shape[:-1]), rows)]
        side = np.sign(rows.velocity)
        state, speed = side * rows.ratio, np.abs(rows.velocity)
        if name == "offset":
            return [np.ones(len(speed))]
        if name == "adhesion":
            return [side]
        if name in FLOW_DIRECTIONS:
            return [speed ** (shape[0] if shape else 1.0)]
        if name == "stribeck_sides":
            surplus = law_column(("stribeck", shape), rows.velocity, state)
            return [surplus, side * surplus]
        if "*" in name:
            part, _, of = name.partition("*")
            size = self.model.frame.inputs[of][1]
            return [law_column((part, ()), rows.velocity, state) * rows.inputs[of] * size]
        return [steady_column(self.model.balance, column, rows)]

    @cached_property
    def changing(self) -> tuple[str, ...]:
        """Terms by which friction changes with an input of the contact, beside every law."""
        asked = {name for family in self.families or () for name in family if "*" in name}
        if asked or self.families is not None:
            return tuple(sorted(asked))
        draws = self._usual
        # which of the parts changes is told less well than how friction does
        changes = {of: self._change_with(of, draws) for of in self.model.frame.inputs}
        sure = [
            of
            for of, x in changes.items()
            if not np.quantile(x, 0.025) <= 0.0 <= np.quantile(x, 0.975)
            and abs(float(np.median(x))) > TOLERANCE
        ]
        return tuple(f"{part}*{of}" for of in sure for part in CHANGING)

    @cached_property
    def beside(self) -> tuple[str, ...]:
        """What stands beside every law: what draws say of the directions."""
        frame = self.model.frame
        if len(frame.sides) < 2:
            return ()
        draws = self._usual
        v = resolved_speeds(self.model, PLACES)
        top = min(v.max(), -v.min())
        low = min(max(v[v > 0.0].min(), -v[v < 0.0].max()), 0.5 * top)
        u = np.geomspace(low, top, PLACES)
        both = [steady_curves(self.model, draws, self.at(side * u)) for side in (1.0, -1.0)]
        odd = 0.5 * (both[0] + both[1])
        x = np.column_stack([np.ones_like(u), u / top])
        b = odd @ np.linalg.pinv(x).T / self.size
        result = []
        for name, c in zip(("offset", "viscous_direction"), b.T, strict=True):
            low_, high = np.quantile(c, (0.025, 0.975))
            if not low_ <= 0.0 <= high and abs(float(np.median(c))) > 0.5 * TOLERANCE:
                result.append(name)
        if self.families is not None and not any("viscous_direction" in x for x in self.families):
            result = [name for name in result if name != "viscous_direction"]
        if self.looked_for or result == ["viscous_direction"]:
            result = list(dict.fromkeys(["offset", *result]))
        return tuple(result)

    def _with_beside(self, structure: Structure) -> Structure:
        """Return a law with what stands beside it, in the order of names."""
        shapes = dict(structure)
        more: list[Column] = [(item, ()) for item in self.beside if item == "offset"]
        if self._is_held(structure):
            more = []
        if "viscous_direction" in self.beside and {"viscous", "power"} & shapes.keys():
            more.append((flow_direction(shapes), shapes.get("power", ())))
        more += [(item, ()) for item in self.changing if item.partition("*")[0] in shapes]
        more += [("adhesion", ())] * (not self.of_load and "level" in shapes)
        own = with_power(structure, self.of_load) if self.of_load % 1.0 else structure
        return tuple(sorted([*own, *more], key=lambda item: item[0]))

    def _is_held(self, structure: Structure) -> bool:
        """Return whether a law that is no sum of parts holds a constant offset."""
        own = next((name.own for name, _ in structure if is_slope(name)), None)
        return own is not None and own.holds_constant(self.slips(self._places))

    @cached_property
    def grid(self) -> Grid:  # type: ignore[override]
        """Shapes of laws that the places tell apart."""
        speed = np.abs(self._places.velocity)
        slowest = max(float(speed.min()), self.model.frame.shaped)
        return Grid(slowest=slowest, fastest=float(speed.max()), fine=2.0)

    def candidates(self) -> list[Candidates]:
        """Return the families on which curves are projected, with their structures."""
        known = self.model.families
        laws: dict[Family, list[Structure]] = {}
        grid = (law for law, _ in laws_of(self.grid, [item for item in known if item]))
        for entry in itertools.chain(grid, filter(None, self.posterior.structures)):
            if is_own(entry):
                laws[family_of(entry)] = [entry]
            else:
                laws.setdefault(family_of(entry), []).append(entry)
        if self.families is not None:
            named = {parts_of(item) or item for item in self.families}
            laws = {family: some for family, some in laws.items() if family in named}
        result = []
        for family, structures in laws.items():
            if self.presliding is not None and "tanh" in family:
                continue  # bristles are what smooths the level
            own = candidates_of(family, [*map(self._with_beside, structures)])
            more = bool(self.of_load % 1.0) and any(name in DRY for name in family)
            result.append(replace(own, parameters=own.parameters + more))
        return result

    def title(self, term: str) -> str:
        """Return what a term is called in a sentence."""
        return FINDINGS.get(term) or term_title(term)

    # ---- weights ----------------------------------------------------------------------------

    def is_small(self, tolerance: float) -> "NDArray[np.bool_]":
        """Return at which nodes what no law says is small (k,)."""
        return np.array([self.model.at(n, "common") <= tolerance for n in self.posterior.nodes])

    @cached_property
    def families_of_structures(self) -> list[Family]:
        """The family of each structure, with what stands beside it."""
        return [
            tuple(name for name, _ in self._with_beside(structure)) if structure else ()
            for structure in self.posterior.structures
        ]

    def is_alone(self, draw: Draws) -> bool:
        return self.model.at(draw.node, "common") == 0.0

    # ---- curves -----------------------------------------------------------------------------

    def steady(self, rows: SteadyRows, draws: Sequence[Draws]) -> Array:
        """Return drawn curves alone (k, n): in the mean over the records."""
        return steady_curves(self.model, draws, rows)

    def friction(self, rows: SteadyRows, draws: Sequence[Draws], *, new: bool = False) -> Array:
        """Return what friction is in draws (k, n): in the records, or in another run."""
        curves = steady_curves(self.model, draws, rows) + beyond(self.model, draws, rows)
        return curves + of_another_run(self.model, draws, rows) if new else curves

    def readings(self, rows: SteadyRows | OtherRows, draws: Sequence[Draws]) -> Array:
        """Return new readings in draws (k, n)."""
        if isinstance(rows, OtherRows):
            return readings(self.model, draws, rows)
        curves = self.friction(rows, draws, new=True)
        rng, single = (
            np.random.default_rng(11),
            [piece.beside for piece in self.model.balance.pieces],
        )
        return curves + np.hypot(self.noise(rows), max(single)) * rng.normal(size=curves.shape)

    def noise(self, rows: SteadyRows) -> Array:
        """Return the standard deviation of a reading at rows (n,)."""
        noise = self.model.noises[MIDDLE]
        speed = np.abs(rows.velocity)
        of = np.clip(np.searchsorted(noise.edges, speed) - 1, 0, len(noise.edges) - 2)
        return np.asarray(noise.deviations[of] * self._noisier)

    @cached_property
    def _noisier(self) -> float:
        """Noise over what the last round left."""
        return float(self.posterior.scale("noise") @ SCALES["noise"][0])

    # ---- what leaves ------------------------------------------------------------------------

    @cached_property
    def presliding(self) -> Memory | None:
        """The bristle that the records show, or None."""
        if self.families is not None and not any(
            {*family} & {*MEMORIES} for family in self.families
        ):
            return None
        shares = self.posterior.scale("bristle")
        memory = self.model.memories[int(np.argmax(shares))]
        lengths = np.array([item.length for item in self.model.memories])
        none = float(shares[lengths == 0.0].sum())
        if none * SURE > 1.0 - none or memory.length < SHORT * self.model.frame.noise:
            return None
        part = self.model.part(memory)
        seen = math.sqrt(float(np.mean(part**2))) > SEEN
        return memory if seen and np.sum(part > SEEN) > ROWS else None

    @property
    def memory(self) -> str:
        """Law of the bristles in the notation; empty without."""
        if self.presliding is None:
            return ""
        named = {name for family in self.families or () for name in family if name in MEMORIES}
        if len(named) == 1:
            return named.pop()
        return "lugre" if self.presliding.exponent == LUGRE and self._is_lugre else "dahl"

    @cached_property
    def _is_lugre(self) -> bool:
        """Whether the length of bristles follows a level that varies, or they have a damping."""
        memory = self.presliding
        assert memory is not None
        if memory.ratio is not None and float(np.ptp(memory.ratio)) > VARIES:
            return True
        length, damping = self._drawn_bristles(memory, self._usual)
        critical = 2.0 * math.sqrt(self.size * self.model.inertia / memory.length)
        return float(np.mean(damping / length > DAMPED * critical)) > SURE / (1.0 + SURE)

    def composition(
        self,
        structure: Shaped,
        coefficients: Array,
        draws: Sequence[Draws] | None = None,
        *,
        offset: bool = False,
    ) -> Composition:
        """Return the law that a structure with coefficients (k, p) is, at the usual load."""
        at, count = 0, len(coefficients)
        normal = self._normals(draws)
        if is_own(structure):
            return self._own_composition(structure, coefficients, normal, offset=offset)
        terms: dict[str, tuple[Any, Array]] = {}
        rig: dict[str, Array] = {}
        for name, shape in structure:
            size = 2 if name == "stribeck_sides" else 1
            own, at = coefficients[:, at : at + size], at + size
            if name == "offset" and offset:
                terms["level_direction"] = (), own / normal
                rig[name] = own[:, 0]
            elif name == "offset":
                rig[self.offset or name] = own[:, 0] + self.records[0].constant
            elif name == "adhesion":
                rig[name] = own[:, 0]
            else:
                flows = name in (*FLOWS, *FLOW_DIRECTIONS) or name.startswith("viscous")
                entries = len(PARTS[name].shapes) if name in DRY else len(shape)
                for power in shape[entries:]:
                    rig["load_exponent"] = np.broadcast_to(np.ravel(power), count) * 1.0
                terms[name] = shape[:entries], own if flows else own / normal
        if "adhesion" in rig:  # part of the level at the usual load
            shape, own = terms["level"]
            terms["level"] = shape, own + rig["adhesion"][:, None] / normal
        # bristles stand around no directions
        memory = "" if {*DIRECTIONS} & terms.keys() else self.memory
        values = self._bristles(terms, normal, draws) if memory else {}
        if memory == "dahl" and self.presliding is not None:
            least, _ = bounds_of("dahl(level)", "yield_exponent")
            values.pop("bristle_damping")
            exponent = max(abs(self.presliding.exponent), least)
            values["yield_exponent"] = np.full(count, exponent)
        result = compose(
            terms, self.usual_inputs, count, memory=memory, memory_values=values,
            memory_fixed=("yield_exponent",),
        )  # fmt: skip
        if "power_direction" in terms:  # no law of stickslip.friction has it
            result = replace(result, text="", instead="")
        return replace(result, rig=rig, load=normal[:, 0])

    def _own_composition(
        self, structure: Shaped, coefficients: Array, normal: Array, *, offset: bool
    ) -> Composition:
        """Return a law that is no sum of parts."""
        rig = {
            "offset" if offset else self.offset or "offset": coefficients[:, k]
            + (0.0 if offset else self.records[0].constant)
            for k, (name, _) in enumerate(structure)
            if name == "offset"
        }
        result = own_composition(structure, coefficients)
        return replace(result, rig=rig, load=normal[:, 0], inputs=self.usual_inputs)

    @property
    def usual_inputs(self) -> dict[str, float]:
        """Inputs of the contact as they are usually, by name."""
        frame = self.model.frame
        usual = {name: float(np.mean(x)) for name, x in self.records[0].inputs.items()}
        usual |= {name: mean for name, (mean, _) in frame.inputs.items()}
        return usual | dict(zip([TRANSMITTED], frame.transmitted[1:2], strict=False))

    def _normals(self, draws: Sequence[Draws] | None) -> Array:
        """Return the normal forces (k, 1) of draws, or that in the middle of all."""
        if not self.load_slopes:
            count = 1 if draws is None else sum(draw.random.shape[1] for draw in draws)
            return np.full((count, 1), self.normal)
        rig = self._beside(self._usual if draws is None else draws)
        change = sum(
            slope * (rig[path] - given)
            for path, (slope, given) in self.load_slopes.items()
            if path in rig
        )
        normal = np.maximum(self.normal + change, 1e-9 * self.normal)
        return np.reshape(np.median(normal) if draws is None else normal, (-1, 1))

    @cached_property
    def _usual(self) -> list[Draws]:
        """Draws in whose middle a law stands that is none of them."""
        result: list[Draws] = self.posterior.draws(DRAWN, seed=13)
        return result

    def _bristles(
        self, terms: Mapping[str, tuple[Any, Array]], normal: Array,
        draws: Sequence[Draws] | None,
    ) -> dict[str, Array]:  # fmt: skip
        """Return stiffness and damping of bristles (k,).

        Each draw has the length and the damping of its own node.
        """
        memory = self.presliding
        assert memory is not None
        count = len(next(iter(terms.values()))[1]) if terms else len(normal)
        level, through = np.zeros(count), sum(self.model.frame.transmitted[1:2])
        speed = np.full(count, memory.speed)
        for name, (shape, own) in terms.items():
            if name in LEVELS:
                shapes = tuple(np.broadcast_to(np.ravel(x), count) for x in shape)
                curve = law_column((name, shapes), speed, np.ones(count), 0.0, through)
                level = level + own[:, 0] * curve
        length, damping = self._drawn_bristles(memory, self._usual if draws is None else draws)
        if draws is None:
            length, damping = (np.full(count, np.median(x)) for x in (length, damping))
        return {
            "bristle_stiffness": level / length,
            "bristle_damping": damping / length / normal[:, 0],
        }

    def _drawn_bristles(self, memory: Memory, draws: Sequence[Draws]) -> tuple[Array, Array]:
        """Return lengths of bristles, and the coefficients of their damping (k,), at least 0."""
        rng = np.random.default_rng(9)
        lengths, damping = [], []
        for draw in draws:
            own, count = self.model.memory(draw.node), draw.random.shape[1]
            own = own if own.length else memory
            lengths.append(own.length * np.exp(own.spread * rng.normal(size=count)))
            plain = self.model.split(draw.node, draw.random)
            damping.append(plain["damping"][0] if "damping" in plain else np.zeros(count))
        return np.concatenate(lengths), np.maximum(np.concatenate(damping), 0.0)

    def rig(self, draws: Sequence[Draws]) -> dict[str, Array]:
        """Return what is looked for beside the law (k,) in draws, by path."""
        unknown = self.model.balance.pieces[0].record.unknown
        result = self._beside(draws)
        return {k: x for k, x in result.items() if k not in unknown or not unknown[k].doubt}

    def _beside(self, draws: Sequence[Draws]) -> dict[str, Array]:
        """Return what is looked for, or doubtful, beside the law (k,) in draws, by path."""
        result: dict[str, list[Array]] = {}
        unknown = self.model.balance.pieces[0].record.unknown
        paths = {name: name for name in unknown}
        if self.model.balance.finds_inertia:
            paths["inertia"] = self.inertia_path or "inertia"
        for draw in draws:
            plain = self.model.split(draw.node, draw.random)
            for name, path in paths.items():
                given = unknown[name].given if name in unknown else 0.0
                parts = {other: x.along.get(name, 0.0) for other, x in unknown.items()}
                parts = {k: x for k, x in parts.items() if x} or {name: 1.0}
                change = sum(share * plain[other][0] for other, share in parts.items())
                result.setdefault(path, []).append(given + change)
        return {path: np.concatenate(x) for path, x in result.items()}

    # ---- figures and findings ---------------------------------------------------------------

    @cached_property
    def _left(self) -> tuple[Array, Array, Array, Array]:
        """Velocities, friction and what the gear transmits (n,) of the rows, at the best node.

        What is no friction is taken off; and how far rows are from a turn.
        """
        model, node = self.model, self.posterior.best
        _, b = self.posterior.estimate(node, self.posterior.law_at(node))
        which, memory = model.key(node)
        design, rows = model.design(which, memory), model.balance.rows(which)
        plain = model.plain(node, b[:, None])[:, 0]
        friction = np.isin(design.groups, ("common", "sides", "offset", "side"))
        y = model.response(node) - design.random[:, ~friction] @ plain[~friction]
        through = rows.seen([
            model.balance.transmitted(piece) * model.balance.load(piece) + 0.0 * piece.velocity
            for piece in model.balance.pieces
        ])  # fmt: skip
        return rows.velocity, y, through, rows.far

    def points(self, rung: Rung, *, apart: bool = False) -> MeasuredPoints:
        """Return friction of the rows, less what is no friction, thinned out.

        They are far from turns if many are, or as far `apart` as rows are if that is wanted.
        Friction is at what the gear transmits in the middle, by the share which the law takes.
        """
        v, y, through, far = self._left
        if self.model.frame.transmitted and rung.structure:
            seen = self.design(rung.structure, self.at(v, inputs={TRANSMITTED: through}))
            y = y + (self.design(rung.structure, self.at(v)) - seen) @ rung.coefficients
        least = min(RESOLVED, FARTHER * float(far.max())) if apart else RESOLVED
        few = np.flatnonzero(far > least)
        few = few if apart or len(few) > DRAWN // 10 else np.arange(len(v))
        few = few[:: max(len(few) // DRAWN, 1)]
        ones = np.ones(len(few))
        return MeasuredPoints(
            velocity=v[few], friction=y[few], load=self.normal * ones, weights=ones
        )

    @cached_property
    def _middle(self) -> Array:
        """Friction in the mean of draws, at the speeds over which the band is stated (n,)."""
        return np.asarray(np.mean(self.steady(self.asked(), self._usual), axis=0))

    def scatter(self, rung: Rung) -> float:
        """Return the standard deviation of what the law and what acts beside it leave [N]."""
        at = self.asked()
        off = self._middle - self.design(rung.structure, at) @ rung.coefficients
        return math.hypot(self.noise_of_rows, math.sqrt(float(np.mean(off**2))))

    @property
    def noise_of_rows(self) -> float:
        """Root mean square of the deviations of the rows about what the posterior says."""
        noise, rows = self.model.noises[MIDDLE], self.model.balance.rows(MIDDLE)
        of = self.model.classes(self.model.balance, MIDDLE, noise)
        sizes = noise.deviations[of] * noise.pieces[rows.piece] * self._noisier
        return math.sqrt(float(np.mean(sizes**2)))

    def findings(self, draws: Sequence[Draws]) -> list[Finding]:
        """Return what changes along the records, with its probability."""
        result = [
            self._of_size(name, draws)
            for name in FINDINGS
            if name in self.model.names and not (name == "force" and self._one_way)
        ]
        result += [self._delay(draws)] if "delay" in self.model.names else []
        result += self._given(draws) + self._clipped()
        inputs = [*self.model.frame.inputs]
        result += [self._with_input(name, self._change_with(name, draws)) for name in inputs]
        for name in inputs if len(self.model.frame.sides) > 1 else ():
            own = [self.model.split(x.node, x.random)[f"{FORCE}*{name}"][0] for x in draws]
            pushed = 2.0 * np.concatenate(own) / self.size
            result.append(self._with_input(name, pushed, pushes=True))
        return [item for item in result if item.probability > 0.5]

    def untold(self) -> list[str]:
        """Return sentences on what the design does not tell apart, and what would."""
        result, balance = list[str](), self.model.balance
        if "offset" in self.beside and self.offset and self.model.frame.load == 1.0:
            result.append(
                "A constant offset cannot be distinguished from a level that differs by direction:"
                " a record under another load would separate the two, or the reading of the sensor"
                " without a force."
            )
        if len(self.model.frame.sides) == 1 and self.offset and not balance.measured:
            result.append(f"{ONE_WAY} Move in the other direction too, or hold the offset (fixed).")
        if balance.dampings:
            names = [path.rpartition(".")[2].replace("_", " ") for path in balance.dampings]
            alike, them = ("", "it") if len(names) == 1 else (" together", "them")
            result.append(
                f"The {joined(names)}{alike} cannot be distinguished from viscous friction: the"
                f" value of {them} holds both, and no law with viscous friction is compared."
            )
        return result

    def _of_size(self, name: str, draws: Sequence[Draws]) -> Finding:
        """Return how much the level or the force changes, with the odds that it is not little.

        They are those of its scale or of the change in draws, whichever are less: as of an
        interval, what is out of it on one side counts twice.
        """
        model, rows = self.model, self.model.balance.rows(MIDDLE)
        of = (name, *(("place", "force") if name == "drift" and self._one_way else ()))
        nodes = zip(self.posterior.nodes, self.posterior.weights.sum(axis=1), strict=True)
        likely = sum(w for node, w in nodes if any(model.at(node, x) >= NEGLIGIBLE for x in of))
        frame, waves = model.frame, model.balance.waves
        course = frame.course(rows.time)
        columns = {
            "drift": course,
            "place": frame.places(rows.position, waves[1]),
            "force": model.balance.forces(rows.position),
        }
        changes, apart = [], []
        for draw in draws:
            b = model.split(draw.node, draw.random)[name]
            if name == "run":
                changes.append(np.std(b.reshape(2, -1, b.shape[1])[0], axis=0, ddof=1))
            elif name == "drift":
                apart.append(self._in_time(draw, b, columns))
                changes.append(np.diff(apart[-1], axis=0)[0])
            else:
                moved = columns[name][::7] @ b
                if name == "force":
                    moved += course[::7] @ model.split(draw.node, draw.random)["zero"]
                changes.append(np.std(moved, axis=0))
        change = np.concatenate(changes) / self.size
        middle = float(np.median(change))
        little = min(float(np.mean(k * change < NEGLIGIBLE)) for k in (-1, 1))
        ends = np.median(np.hstack(apart), axis=1).tolist() if apart else ()
        how = self._sentence(name, middle, draws, ends)
        return stated(
            name, FINDINGS[name], min(float(likely), max(1.0 - 2.0 * little, 0.0)), change, how
        )

    @property
    def _one_way(self) -> bool:
        """Whether a force beside friction is not distinguished from the level."""
        return len(self.model.frame.sides) == 1

    def _in_time(self, draw: Draws, b: Array, columns: Mapping[str, Array]) -> Array:
        """Return the level at the beginning and the end from its mean (2, k)."""
        frame, plain = self.model.frame, self.model.split(draw.node, draw.random)
        rows, (level, slope) = self.model.balance.rows(MIDDLE), np.split(b, 2)
        moved = columns["drift"] @ level
        if self._one_way:  # a force and a place pass for time, and so does viscosity
            share = float(np.median(np.abs(rows.velocity))) / frame.top
            beside = columns["drift"] @ plain["zero"] + columns["force"] @ plain["force"]
            moved += columns["drift"] @ (share * slope) + columns["place"] @ plain["place"]
            moved += frame.sides[0] * beside
        ends = [int(np.argmin(rows.time)), int(np.argmax(rows.time))]
        return np.asarray(moved[ends] - np.mean(moved, axis=0))

    def _sentence(
        self, name: str, size: float, draws: Sequence[Draws], ends: Sequence[float]
    ) -> str:
        unit = "N m" if self.turning else "N"
        if name == "drift":
            v = self.asked().velocity
            side = 1.0 if (v > 0.0).any() else -1.0
            at = self.at([side * float(np.median(np.abs(v[side * v > 0.0])))])
            typical = abs(float(np.median(self.steady(at, draws))))
            first, last = (quantity(typical + x, unit, 2) for x in ends)  # a smooth course of it
            verb = "falls" if size < 0.0 else "rises"
            beside = ", or a force beside it," if self._one_way else ""
            return (
                f"Friction{beside} {verb} over the record, from {first} at its beginning to {last}"
                " at its end."
            )
        if name == "run":
            runs = self.model.balance.runs
            return f"The {runs} runs differ by {share_text(size)} of friction (standard deviation)."
        what = {
            "place": "The level of friction depends on position",
            "force": "The recorded force contains a part that depends on position or time, such as"
            " gravity or cogging",
        }[name]
        return f"{what} ({share_text(size)} of friction, standard deviation)."

    def _change_with(self, name: str, draws: Sequence[Draws]) -> Array:
        """Return the change of friction over two deviations of an input, over its size (k,)."""
        v = resolved_speeds(self.model, PLACES)
        side = 1.0 if (v > 0.0).any() else -1.0
        mean, size = self.model.frame.inputs[name]
        at = side * float(np.median(np.abs(v[side * v > 0.0]))) * np.ones(2)
        rows = self.at(at, inputs={name: mean + size * np.array([-1.0, 1.0])})
        ends = steady_curves(self.model, draws, rows)
        return np.asarray(np.diff(ends, axis=1)[:, 0] * side / self.size)

    def _with_input(self, name: str, change: Array, *, pushes: bool = False) -> Finding:
        """Return how much friction, or what pushes beside it, changes with an input.

        Over two standard deviations of it, over the size of friction (k,).
        """
        mean, size = self.model.frame.inputs[name]
        first, last = (quantity(mean + k * size, "", 3) for k in (-1.0, 1.0))
        middle = float(np.median(change))
        term, title = name, CHANGING["level"].format(name)
        how = f"Friction {'falls' if middle < 0.0 else 'rises'} by {percent(abs(middle))}"
        if pushes:
            term, title = f"{FORCE}*{name}", f"force beside friction that changes with the {name}"
            how = f"A force other than friction changes by {percent(abs(middle))} of friction"
        how = f"{how} where the {name} goes from {first} to {last}."
        likely = max(np.mean(k * change > 0.0) for k in (-1, 1)) * (abs(middle) >= NEGLIGIBLE)
        return stated(term, title, float(likely), change, how)

    def _given(self, draws: Sequence[Draws]) -> list[Finding]:
        """Return by how much the inertia, or the mechanism's forces, are not as given.

        Where something is looked for that moves both, what is told is the inertia beside the
        forces of the mechanism.
        """
        names = self.model.balance.given
        if not names:
            return []
        parts = [self.model.split(draw.node, draw.random)["given"] for draw in draws]
        every = dict(zip(names, np.concatenate(parts, axis=1), strict=True))
        gain, beside = every.pop("both", None), {"inertia", "mechanism"} <= {*names}
        if beside and gain is None:
            every = {"beside": every["inertia"] - every["mechanism"]}
        result = []
        large = [self.model.at(draw.node, "given") >= MISTAKEN for draw in draws]
        mistaken = float(np.average(large, weights=[draw.random.shape[1] for draw in draws]))
        for name, own in every.items():
            of, off = name.replace("beside", "inertia"), own if gain is None else own + gain
            factors = [quantity(1.0 + x, "", 3) for x in np.quantile(off, (0.5, 0.025, 0.975))]
            what = {
                "inertia": "The inertia is {} times as given ({} to {})",
                "mechanism": "Forces of the mechanism are {} times as given ({} to {})",
                "body": "What the rigid body takes is {} times as given ({} to {})",
                "beside": "Beside the forces of the mechanism, the inertia is {} times as given"
                " ({} to {})",
            }[name].format(*factors)
            likely = float(np.mean(np.abs(off) > NEGLIGIBLE))
            what += ", or the gain of the force or a unit of length is wrong."
            result.append(stated(f"{of}_given", GIVEN[of], likely, off, what, mistaken))
        return result

    def gain(self) -> float:
        """Return how many times too large the recorded force is [1].

        It is so if the inertia and the forces of the mechanism, both given, have one factor: two
        mistakes of the same size are less likely than one.
        """
        draws = self.posterior.draws(DRAWN)
        found = self._given(draws) if "both" in self.model.balance.given else []
        if len(found) < 2 or not all(item.asserted for item in found):
            return 1.0
        factors = np.array([1.0 + item.size for item in found])
        error = max(0.5 * (item.high - item.low) for item in found)
        if np.ptp(factors) > max(2.0 * error, NEGLIGIBLE * float(np.mean(factors))):
            return 1.0
        return float(np.mean(factors))

    def _clipped(self) -> list[Finding]:
        """Return how often the sensor of the force shows as much as it can, if more acts then."""
        pieces = [piece for piece in self.model.balance.pieces if np.any(piece.clipped)]
        if not any(acts := [item.clipped for item in self.model.actings]):
            return []
        share = np.abs(np.concatenate([piece.clipped for piece in pieces])).mean(keepdims=True)
        sides = [(side * x.clipped, side * x.given.force) for side in (-1, 1) for x in pieces]
        ends = [float(np.max(force)) for clipped, force in sides if np.max(clipped) > 0.0]
        unit = "N m" if self.turning else "N"
        shown = " to ".join(dict.fromkeys(quantity(f(ends), unit, 3) for f in (min, max)))
        what = (
            f"The sensor of the force shows no more than {shown}, as in"
            f" {percent(float(share[0]))} of the samples, where more acts: as the motion needs."
        )
        likely = min(float(self.posterior.scale("acting")[acts].sum()), 1.0)
        return [stated("clipping", "sensor that clips", likely, share, what)]

    def _late(self, draws: Sequence[Draws]) -> Array:
        """Return draws of how much later the force acts than recorded (n,) [s]."""
        model = self.model
        result = [
            model.split(draw.node, draw.random)["delay"][0] + model.acting(draw.node).delay
            for draw in draws
        ]
        return np.asarray(np.concatenate(result) + model.balance.pieces[0].held)

    def _delay(self, draws: Sequence[Draws]) -> Finding:
        """Return by how much the force acts later than recorded."""
        late = self._late(draws)
        step, middle = self.model.balance.pieces[0].sample, float(np.median(late))
        # from going straight to the next sample to holding until it, and half a sample beyond
        likely = float(max(np.mean(late > 1.5 * step), np.mean(late < -0.5 * step)))
        return stated(
            "delay", "delay of the force, or what looks like it", likely, late,
            f"Motion follows the force as if it acted {quantity(abs(middle), 's', 2)}"
            f" {'later' if middle > 0.0 else 'earlier'} than recorded: a channel that is late,"
            " a low pass, backlash, a flexible part and a sensor that clips look alike.",
        )  # fmt: skip


def with_power(structure: Structure, power: float) -> Structure:
    """Return a law whose dry parts follow a power of the load.

    Examples
    --------
    >>> with_power((("level", ()), ("viscous", ())), 0.7)
    (('level', (0.7,)), ('viscous', ()))
    """
    return tuple((name, (*s, power)) if name in DRY else (name, s) for name, s in structure)


def candidates_of(family: Family, structures: Sequence[Structure]) -> Candidates:
    """Return a family as it is compared: its structures may have more terms beside it."""
    names = tuple(name for name, _ in structures[0])
    count = parameters_of(family) + len(names) - len(family)
    count += sum(name.place >= 0 if is_slope(name) else name == GEAR for name in family)
    return Candidates(family=names, structures=structures, parameters=count)


def parts_of(family: Family) -> Family:
    """Return the parts of a law among the terms of a family.

    Examples
    --------
    >>> parts_of(("dahl", "level", "offset", "viscous"))
    ('level', 'viscous')
    """
    names = ("stribeck" if name == "stribeck_sides" else name for name in family)
    return tuple(sorted({name for name in names if name in PARTS or name == GEAR}))
