r"""The certificate of a verdict on a motion: what is handed over, run by the engine, and its work.

A balance may explain the forces of a record and yet not make its motion: it never runs. So

1. **Reduced motion.** Along the record, J dv/dt = u(t) - k x - c v - f(v): f is the law handed
   over, J its inertia, k and c spring and damper of an axis, and u the recorded force with all
   other known forces along the measured motion, less the constant force that was found. Of several
   joints, what the motion of the others takes is among them. Of asserted findings a delay shifts
   the recorded force (a delay by sampling always does), what is not as given has its factor, and a
   force by place is taken off u.
2. **Run.** Stretches of `CONSTANTS` time constants J / (f / v), of friction over speed in the mean,
   and of a mean period of the motion at most, begin at smoothed measured states. The compiled
   engine runs them together, u having its mean in each of at most `STEPS` steps. The error is
   sqrt(median mse / median var), of the simulated position over the variance of the measured one
   in a stretch. A free motion is run whole, from the start by which it is followed best, and what
   that leaves stands against the white noise of the readings. So is a motion of which runs are
   judged: under its own drive or a recorded voltage, each stretch from the start that fits best.
3. **Plain.** The same with Coulomb + viscous friction, and with what is looked for of the
   mechanism, by least squares on the rows of the balance: what anybody has in five lines.
4. **Expected.** `DRAWS` laws of the posterior, each with its mechanism and a start that is off by
   the noise of the smoothed states, are run over some stretches. Their distance from their mean is
   the error that a right posterior leaves, of which a quantile is stated.
5. **Work.** What the law takes along the measured motion, over what u puts in less the change of
   kinetic energy: 1 where friction is all that takes energy.

Source: runs as a check of estimates from one-step errors, L. Ljung, "System Identification", 2nd
ed. (1999), section 16.6.
"""

import contextlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from stickslip.engine.solver import EventDriven, IncrementalEnsemble
from stickslip.errors import StickslipError
from stickslip.friction import CoulombViscous, FrictionLaw
from stickslip.identify.bands import RunCertificate, Stretch
from stickslip.identify.forces import TRANSMITTED
from stickslip.identify.judgement import Judgement
from stickslip.identify.laws import drawn_curve
from stickslip.identify.posterior import Array
from stickslip.identify.problems.driven_runs import DrivenProblem, DrivenRuns
from stickslip.identify.problems.free_motion import FreeMotionProblem
from stickslip.identify.problems.free_runs import KNOTS, Candidate, begun
from stickslip.identify.problems.record_rows import MIDDLE, Piece, mean_frequency
from stickslip.identify.problems.records import RecordProblem
from stickslip.identify.projection import names_of
from stickslip.mechanisms import Axis, Mechanism, as_rotary, given_inputs
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import parameters, vary

CONSTANTS = 5.0
"""Time constants of friction in a stretch."""
STEPS = 120
"""Most steps of a stretch in each of which the force has its mean."""
FEWEST_STEPS = 20
"""Samples of a stretch at least."""
PARTS_OF_RECORD = 5
"""Stretches into which a piece of a record is cut at least."""
STRETCHES = 25
"""Most stretches that are run."""
STIRS = 0.1
"""Spread of the position in a stretch, over the largest of all, below which the body rests."""
DRAWS = 20
"""Laws that are drawn."""
FEW = 6
"""Stretches of each."""
QUANTILE = 0.95
"""Quantile of the errors of draws that is stated."""
SAMPLING = (-0.5, 1.5)
"""Samples by which forces act later where their sampling alone decides."""
SOLVER = EventDriven(tier="compiled")
NOT_RUN = "The law was not run with the recorded force: {}"
"""Why there is no certificate."""


def certificate_of(judgement: Judgement, mechanism: Mechanism) -> RunCertificate | str | None:
    """Return the certificate of the law of a judgement and of a mechanism handed over.

    Or why there is none; None where nothing was moved by a force: friction itself was measured.
    """
    problem = judgement.problem
    if isinstance(problem, FreeMotionProblem):
        return _of_free_motion(judgement, problem) if judgement.named.structure else None
    driven = problem if isinstance(problem, DrivenProblem) else None
    problem = problem if driven is None else driven.plain
    if not isinstance(problem, RecordProblem) or problem.records[0].friction:
        return None
    try:
        if driven is None and TRANSMITTED in _law(judgement).inputs:
            return NOT_RUN.format("friction depends on what the gear transmits.")
        reduced = _Reduced(judgement, problem, mechanism)
        return _of_record(reduced) if driven is None else _of_runs(reduced, driven.following)
    except (StickslipError, ArithmeticError, ValueError) as error:
        return NOT_RUN.format(error)


# ---- records with a force ---------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True, eq=False)
class _Member:
    """A law, an axis, and what drives it in each piece."""

    axis: Mechanism
    inertia: float
    load: float
    law: FrictionLaw
    pushes: Sequence[Array]
    """Forces of each piece (n,) [N]."""


@dataclass(frozen=True, kw_only=True)
class _Cut:
    """A stretch of a piece."""

    piece: int
    first: int
    every: int
    """Samples of a step."""
    steps: int

    def of(self, x: Array) -> Array:
        """Return values at the ends of steps (steps + 1,)."""
        return np.asarray(x[self.first : self.first + self.every * self.steps + 1 : self.every])

    def means(self, x: Array) -> Array:
        """Return means of a signal that is straight between samples, in the steps (steps,)."""
        own = x[self.first : self.first + self.every * self.steps + 1]
        each = np.reshape(0.5 * (own[1:] + own[:-1]), (self.steps, self.every))
        return np.asarray(np.mean(each, axis=1))


class _Reduced:
    """Records as motions of an axis."""

    def __init__(self, judgement: Judgement, problem: RecordProblem, mechanism: Mechanism) -> None:
        self.judgement, self.problem, self.mechanism = judgement, problem, mechanism
        self.balance = problem.model.balance
        self.pieces = self.balance.pieces
        self.position = [_smooth(piece) for piece in self.pieces]
        self.known = {path: float(x) for path, _, x in parameters(mechanism, "mechanism")}
        self.has_offset = "offset" in names_of(judgement.named.structure) and not judgement.offset
        asserted = {x.term: x.size for x in judgement.findings if x.asserted and not x.is_mistake}
        # draws of runs are none of the balance
        self.is_own = judgement.problem is problem
        self.by_place = "force" in asserted and self.is_own
        self.late = self._late("delay" in asserted)
        self.factor = 1.0 + asserted.get("inertia_given", 0.0)
        self.gain = 1.0 + asserted.get("mechanism_given", asserted.get("body_given", 0.0))
        own = mechanism if isinstance(mechanism, Axis) else None
        self.spring, self.damper = (own.stiffness, own.damping) if own else (0.0, 0.0)

    def _late(self, asserted: bool) -> float:
        """Return how much later than recorded forces act, those between samples as straight [s].

        They may hold until the next sample, or be filtered as the motion is not: a delay within
        `SAMPLING` samples is none of the mechanism, and needs no assertion.
        """
        first, late = self.pieces[0], self.plain_late
        if self.is_own and "delay" in self.problem.model.names:
            late = float(np.median(self.problem._late(self.judgement.draws)))
        low, high = SAMPLING[0] * first.sample, SAMPLING[1] * first.sample
        return late if asserted else min(max(late, low), high)

    @property
    def plain_late(self) -> float:
        """The same as least squares have it [s]."""
        return self.balance.acting.delay + self.pieces[0].held

    def member(
        self, law: FrictionLaw, values: Mapping[str, float], *, found: bool = True
    ) -> _Member:
        """Return what is run with values of what is looked for, perhaps without what was `found`.

        Forces that a spring and a damper of an axis take are taken by the run.
        """
        first = self.pieces[0].record
        inertia = first.inertia or 0.0
        if self.balance.finds_inertia:
            inertia += values[self.problem.inertia_path or "inertia"]
        open_ = {p: x for p, x in first.unknown.items() if not x.doubt and p in values}
        inertia += sum(x.inertia * (values[p] - x.given) for p, x in open_.items())
        inertia *= self.factor if found else 1.0
        spring = values.get("mechanism.stiffness", self.spring) if self.spring else 0.0
        damper = values.get("mechanism.damping", self.damper) if self.damper else 0.0
        load = self.judgement.composition.normal()
        axis: Mechanism = Axis(
            inertia=abs(inertia), stiffness=spring, damping=damper,
            load=load, drive=Sampled(times=(0.0,), values=(0.0,)),
        )  # fmt: skip
        axis = as_rotary(axis) if self.problem.turning else axis
        if law.inputs:
            axis = given_inputs(axis, self.problem.usual_inputs)
        forces = [0.0 * x for x in self.position]
        if found and self.by_place:
            forces = self.forces_by_place
        pushes = [
            self.push(piece, values, found=found) + spring * x + damper * piece.velocity - by_place
            for piece, x, by_place in zip(self.pieces, self.position, forces, strict=True)
        ]
        return _Member(axis=axis, inertia=abs(inertia), load=load, law=law, pushes=pushes)

    def push(self, piece: Piece, values: Mapping[str, float], *, found: bool) -> Array:
        """Return all known forces (n,) [N] but those of acceleration and friction."""
        record, result = piece.record, piece.record.force
        late = self.late if found else self.plain_late
        if late:
            result = np.interp(record.time - late, record.time, result)
        if record.mechanism is not None:
            result = result + (self.gain if found else 1.0) * record.mechanism
        for path, item in record.unknown.items():
            if not item.doubt and path in values:
                result = result + item.force * (values[path] - item.given)
        return np.asarray(result - values.get("offset", 0.0))

    @property
    def handed(self) -> dict[str, float]:
        """What is looked for, as it is handed over."""
        result = dict(self.known)
        if self.has_offset:
            path = self.problem.offset
            found = self.judgement.composition.rig.get(path, self.judgement.rig.get(path))
            total = self.known.get("mechanism.offset", 0.0) if found is None else float(found[0])
            result["offset"] = total - self.problem.records[0].constant
        if self.balance.finds_inertia and self.problem.inertia_path not in result:
            result[self.problem.inertia_path or "inertia"] = float(self.judgement.rig["inertia"][0])
        return result

    @property
    def plain(self) -> tuple[dict[str, float], float, float]:
        """What least squares find of the mechanism, and level and slope of friction [N, N s/m]."""
        balance, rows = self.balance, self.balance.rows(MIDDLE)
        fixed, level = balance.fixed(MIDDLE), balance.plain()[:, -1]
        sought = [p for p, x in self.pieces[0].record.unknown.items() if not x.doubt]
        names = [name for name in ("offset", "inertia", *sought) if name in fixed]

        columns = [fixed[name][:, 0] for name in names] + [fixed["slope"][:, 0], level]
        x = np.column_stack(columns)
        size = np.sqrt(np.mean(x * x, axis=0)) + 1e-300
        *c, viscous, level = np.linalg.lstsq(x / size, rows.response, rcond=1e-9)[0] / size
        result = dict(self.known)
        unknown = self.pieces[0].record.unknown
        for name, value in zip(names, map(float, c), strict=True):
            path = (self.problem.inertia_path or name) if name == "inertia" else name
            result[path] = value + (unknown[name].given if name in unknown else 0.0)
        return result, max(float(level), 0.0), max(float(viscous), 0.0) / balance.frame.top

    @property
    def forces_by_place(self) -> list[Array]:
        """Force that changes with the place, in the mean of draws, along each piece (n,) [N]."""
        model, draws = self.problem.model, self.judgement.draws
        sizes = np.hstack([model.split(draw.node, draw.random)["force"] for draw in draws])
        return [self.balance.forces(x) @ np.mean(sizes, axis=1) for x in self.position]

    def cuts(self, constant: float) -> list[_Cut]:
        """Return stretches of so many time constants [s] in which the body moves."""
        result, longest = [], CONSTANTS * constant
        longest = min(longest, 1.0 / (mean_frequency(self.problem.records) + 1e-300))
        for k, piece in enumerate(self.pieces):
            count = len(piece.record.time) - 1
            most = max(count // PARTS_OF_RECORD, min(FEWEST_STEPS, count))
            length = int(np.clip(longest / piece.step, min(FEWEST_STEPS, most), most))
            every = max(1, math.ceil(length / STEPS))
            steps = length // every
            starts = range(0, count - every * steps + 1, every * steps)
            result += [_Cut(piece=k, first=i, every=every, steps=steps) for i in starts]
        spreads = np.array([np.std(cut.of(self.position[cut.piece])) for cut in result])
        stirred = np.flatnonzero(spreads >= STIRS * np.max(spreads))
        few = stirred[:: math.ceil(len(stirred) / STRETCHES)]
        return [result[k] for k in few.tolist()]

    def starts(self, cuts: Sequence[_Cut]) -> Array:
        """Return smoothed positions and velocities at the beginning of stretches (s, 2)."""
        each = [(self.position[c.piece][c.first], self.pieces[c.piece].velocity[c.first])
                for c in cuts]  # fmt: skip
        return np.array(each)

    def measured(self, cuts: Sequence[_Cut]) -> list[Array]:
        """Return smoothed positions of stretches."""
        return [cut.of(self.position[cut.piece]) for cut in cuts]

    def start_noise(self, cuts: Sequence[_Cut]) -> Array:
        """Return the standard deviations of what starts are off (s, 2)."""
        pieces = [self.pieces[cut.piece] for cut in cuts]
        return np.array([
            (p.noise * math.sqrt(min(2.0 * p.step * p.wider * p.cutoff, 1.0)),
             p._speed_noise(p.wider)) for p in pieces
        ])  # fmt: skip


def _smooth(piece: Piece) -> Array:
    """Return positions in the band of the velocity (n,) [m]."""
    middle = piece.filters[MIDDLE]
    return middle(piece.record.position, bent=True, wider=piece.wider, full=True)


def _bristle(law: FrictionLaw, speed: float, load: float) -> float:
    """Return how far bristles are bent in steady motion [m]."""
    stiffness = getattr(law, "bristle_stiffness", None)
    if not stiffness or not speed:
        return 0.0
    return float(law.steady(speed, load)) / (float(stiffness) * load)


def _run(
    reduced: _Reduced, members: Sequence[_Member], cuts: Sequence[_Cut], starts: Sequence[Array]
) -> list[list[Array]]:
    """Return simulated positions of each member in each stretch (steps + 1,).

    All runs go on together, step by step; one that fails is not finite.
    """
    first, count = members[0], len(members) * len(cuts)
    runs = IncrementalEnsemble(first.axis, first.law, count=count, solver=SOLVER, threads=1)
    steps = max(cut.steps for cut in cuts)
    pushes, ends = np.zeros((count, steps)), np.zeros((count, steps))
    result = np.full((count, steps + 1), np.nan)
    for m, (member, own) in enumerate(zip(members, starts, strict=True)):
        at = np.arange(m * len(cuts), (m + 1) * len(cuts))
        states = np.zeros((len(cuts), runs.states.shape[1]))
        states[:, :2], load = own, member.load
        if states.shape[1] > 2:
            states[:, 2] = [_bristle(member.law, v, load) for v in own[:, 1].tolist()]
        runs.begin(at, states, member.axis, member.law)
        result[at, 0] = own[:, 0]
        for row, cut in zip(at.tolist(), cuts, strict=True):
            step = cut.every * reduced.pieces[cut.piece].step
            ends[row] = step * np.minimum(np.arange(1, steps + 1), cut.steps)
            pushes[row, : cut.steps] = cut.means(member.pushes[cut.piece])
    for k in range(steps):
        runs.advance(ends[:, k], np.ascontiguousarray(pushes[:, k : k + 1]))
        result[:, k + 1] = np.where(runs.running, runs.states[:, 0], np.nan)
    each = [result[row, : cut.steps + 1] for row, cut in enumerate([*cuts] * len(members))]
    return [each[m * len(cuts) : (m + 1) * len(cuts)] for m in range(len(members))]


def _error(simulated: Sequence[Array], measured: Sequence[Array]) -> float:
    """Return the error of runs over the spread of what was measured, in the middle of stretches."""
    squares = [float(np.mean((x - y) ** 2)) for x, y in zip(simulated, measured, strict=True)]
    spread = float(np.median([np.var(y) for y in measured]))
    return math.sqrt(float(np.median(np.nan_to_num(squares, nan=math.inf))) / (spread + 1e-300))


def _law(judgement: Judgement) -> FrictionLaw:
    """Return the law handed over; one through levels with these as numbers, compiled once."""
    composed, sliding, own = judgement.handed_over(judgement.named)
    if own is None and not composed.memory:
        return drawn_curve(sliding, composed.normal())
    return composed.through(sliding) if own is None else own


def _of_record(reduced: _Reduced) -> RunCertificate:
    """Return the certificate of records with a force."""
    law, (values, level, viscous) = _law(reduced.judgement), reduced.plain
    load = reduced.judgement.composition.normal()
    own_law = CoulombViscous(kinetic_coefficient=level / load, viscous_coefficient=viscous / load)
    plain = reduced.member(own_law, values, found=False)
    speed = float(np.mean(np.abs(np.concatenate([x.velocity for x in reduced.pieces]))))
    slope = viscous + level / (speed + 1e-300)
    cuts = reduced.cuts(plain.inertia / (slope + 1e-300))
    handed = reduced.member(law, reduced.handed)
    starts, measured = reduced.starts(cuts), reduced.measured(cuts)
    (simulated,) = _run(reduced, [handed], cuts, [starts])
    (usual,) = _run(reduced, [plain], cuts, [starts])
    steps = [cut.of(reduced.pieces[cut.piece].record.time) for cut in cuts]
    each = zip(steps, measured, simulated, usual, strict=True)
    return RunCertificate(
        run_error=_error(simulated, measured),
        plain_error=_error(usual, measured),
        expected_error=_expected(reduced, law, cuts),
        friction_work=_work(reduced, handed),
        duration=float(np.median([t[-1] - t[0] for t in steps])),
        stretches=tuple(Stretch(time=t, measured=y, simulated=x, plain=z) for t, y, x, z in each),
        motion=tuple(
            (piece.record.time, x)
            for piece, x in zip(reduced.pieces, reduced.position, strict=True)
        ),
    )


def _expected(reduced: _Reduced, law: FrictionLaw, cuts: Sequence[_Cut]) -> float:
    """Return a quantile of the errors that the posterior expects; NaN without draws of the law."""
    rng, named = np.random.default_rng(1), reduced.judgement.named_values
    terms = {path for path, _, _ in parameters(law, "friction")}
    if any(path.startswith("friction.") and path not in terms for path in named):
        return math.nan  # a law through levels has none of the named one's parameters
    every = max(map(np.size, named.values()), default=0)
    draws = np.linspace(0, max(every - 1, 0), DRAWS).astype(int).tolist()
    few = [cuts[k] for k in np.unique(np.linspace(0, len(cuts) - 1, FEW).astype(int))]
    starts, noise = reduced.starts(few), reduced.start_noise(few)
    handed, members = reduced.handed, list[_Member]()
    for k in draws:
        own = {path: float(np.broadcast_to(x, every)[k]) for path, x in named.items()}
        with contextlib.suppress(StickslipError):  # a value out of its range
            inner = {path: x for path, x in own.items() if path in terms}
            moved = {path: x for path, x in own.items() if path in handed}
            members.append(reduced.member(vary(law, "friction", inner), handed | moved))
    if len(members) < DRAWS // 2:
        return math.nan
    off = [starts + noise * rng.normal(size=noise.shape) for _ in members]
    each = [np.array(x) for x in zip(*_run(reduced, members, few, off), strict=True)]
    squares = np.median([np.mean((x - np.mean(x, axis=0)) ** 2, axis=1) for x in each], axis=0)
    spread = float(np.median([np.var(y) for y in reduced.measured(few)])) + 1e-300
    # a run that fails has no end: a value itself, as none is between it and another
    most = np.quantile(np.nan_to_num(squares, nan=math.inf), QUANTILE, method="higher")
    return float(np.sqrt(most / spread))


def _work(reduced: _Reduced, handed: _Member) -> float:
    """Return the share of the work that the named law takes along the measured motion."""
    judgement, taken, supplied = reduced.judgement, 0.0, 0.0
    rung, inertia = judgement.named, handed.inertia
    if not rung.structure:
        return 0.0
    names = names_of(rung.structure)
    offset = rung.coefficients[names.index("offset")] if reduced.has_offset else 0.0
    for piece in reduced.pieces:
        record, v = piece.record, piece.velocity
        seen = np.where(v == 0.0, 1e-300, v)
        rows = reduced.problem.at(seen, record.load, record.inputs or None)
        curve = np.where(v == 0.0, 0.0, judgement.curve_of(rung, rows) - offset)
        push = reduced.push(piece, reduced.handed, found=True)
        taken += float(np.sum(curve * v)) * piece.step
        supplied += float(np.sum(push * v)) * piece.step - 0.5 * inertia * (v[-1] ** 2 - v[0] ** 2)
    return float(taken / supplied) if supplied > 0.0 else math.nan


# ---- runs from the start that follows best ----------------------------------------------------


def _of_runs(reduced: _Reduced, following: DrivenRuns) -> RunCertificate:
    """Return the certificate of what was judged by runs under a drive or a voltage."""
    values, level, viscous = reduced.plain
    load = reduced.judgement.composition.normal()
    usual = CoulombViscous(kinetic_coefficient=level / load, viscous_coefficient=viscous / load)
    laws = (_law(reduced.judgement), reduced.handed), (usual, values)
    left = [following.beside_nothing(law, own).seen for law, own in laws]
    return _of_whole(
        [(x.start + x.times, x.measured) for x in following.runs.segments],
        [seen.residual if seen.finite else None for seen in left],
        problem=reduced.problem, how=f"Run under {following.drive}", expected=following.error,
    )  # fmt: skip


def _of_free_motion(judgement: Judgement, problem: FreeMotionProblem) -> RunCertificate | str:
    """Return the certificate of free motions, each of which is run whole; or why there is none."""
    rung, balance, motion = judgement.named, problem.balance, problem.model.motion
    columns = [balance.base, *(balance.column(name)[:, None] for name in ("level", "viscous"))]
    x = np.hstack(columns)
    norm = np.linalg.norm(x, axis=0) + 1e-300
    least = np.where(np.arange(x.shape[1]) < balance.base.shape[1], -np.inf, 0.0)
    plain = lsq_linear(x / norm, balance.y, (least, np.inf), method="bvls").x[-2:] / norm[-2:]
    usual = Candidate(structure=(("level", ()), ("viscous", ())), coefficients=plain)
    named = Candidate(structure=rung.structure, coefficients=rung.coefficients)
    left = [_left(problem, own) for own in (named, usual)]
    if left[0] is None:
        return "A run of the law does not follow the motion."
    return _of_whole(
        [(item.time, item.values) for item in motion.motions], left,
        problem=problem, how="Run from its start", expected=problem.model.sigma,
        reading=max(x.position_noise if x.located else x.velocity_noise for x in problem.records),
        work=_free_work(judgement, problem),
    )  # fmt: skip


def _of_whole(
    motions: Sequence[tuple[Array, Array]], left: Sequence[Array | None], *,
    problem: RecordProblem | FreeMotionProblem, how: str, expected: float,
    reading: float = math.nan, work: float = math.nan,
) -> RunCertificate:  # fmt: skip
    """Return the certificate of motions from what runs of two laws leave of them; None if all."""
    times, values = zip(*motions, strict=True)
    spread = math.sqrt(float(np.mean(np.concatenate([x - np.mean(x) for x in values]) ** 2)))
    ends = np.cumsum([len(x) for x in values])
    parts = [np.full(ends[-1], np.nan) if x is None else x for x in left]
    run, plain = (float(np.nan_to_num(np.sqrt(np.mean(x**2)), nan=np.inf)) for x in parts)
    each = zip(times, values, *(np.split(x, ends[:-1]) for x in parts), strict=True)
    return RunCertificate(
        run_error=run / spread, plain_error=plain / spread, expected_error=expected / spread,
        friction_work=work, reading_error=reading / spread, how=how, motion=tuple(motions),
        duration=max(float(t[-1] - t[0]) for t in times),
        compared="position" if problem.records[0].located else "velocity",
        stretches=tuple(
            Stretch(time=t, measured=y, simulated=y - x, plain=y - z) for t, y, x, z in each
        ),
    )  # fmt: skip


def _left(problem: FreeMotionProblem, law: Candidate) -> Array | None:
    """Return what runs of a law leave of the readings (n,), from the best starts; None if all fail.

    What no balance sees of the mechanism begins as it is handed over.
    """
    runs, x = begun(problem.model.motion, law, alone=True)
    x[KNOTS:] = problem.model.linear.x[KNOTS:]
    found = runs.beside(x)
    return None if found is None else found.residual


def _free_work(judgement: Judgement, problem: FreeMotionProblem) -> float:
    """Return the share of the energy lost, or of the momentum, that the named law takes."""
    taken, lost = 0.0, 0.0
    for item in problem.balance.each:
        speed = np.maximum(np.abs(item.velocity), 1e-300)
        rows = problem.at(problem.side * speed)
        way = item.taken(problem.side * judgement.curve_of(judgement.named, rows))
        taken, lost = taken + float(way[-1] - way[0]), lost + float(np.ptp(item.response[[0, -1]]))
    return taken / lost if lost > 0.0 and not problem.balance.goes_on else math.nan
