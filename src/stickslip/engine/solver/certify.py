"""What the record of a run gives beside its motion: a certificate, and sensitivities.

A certificate is evidence from outside of error control. With energies E of the states, which plain
equations give, and works that the run has booked,

    |E_end - E_start - W_supplied + W_friction + W_stops| / size

is the energy error, at most 1e-8 or a thousandfold of the tolerance; its size is the largest of
both energies, of the kinetic ones, and of all work done of either sign. Beside it stand the largest
violation of a guard at the end of a step (1e-9 of its size), the largest distance from its guard at
which an event was located (1e-6), and what a sticking body has moved, which has to be 0.

Friction that drives is told where a law may do so: the work of min(F v, 0), by Gauss's rule in each
step; of bristles, which give back what they took, what they gave beyond that.

Sensitivities are asked of the recorded run, along directions d of parameters and initial states. A
drive's table changes with its parameters by the imaginary parts of complex numbers, and states that
begin where the mechanism says by those of its start (`starts`); the kernels do the rest
(`kernels.sensitivities`).
"""

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.formulation import PAINLEVE, Model, formulate
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.sensitivities import columns_at, sense_size
from stickslip.engine.solver.backend import Equations, Playback, Runner, runner_of
from stickslip.engine.solver.run import Record, work_of
from stickslip.engine.solver.starts import Inputs, schedule_slopes, start_slopes
from stickslip.engine.trajectory import Certificate
from stickslip.errors import InputError
from stickslip.friction import ALWAYS, FrictionLaw, Laws, law_of
from stickslip.mechanisms import Contact, Mechanism
from stickslip.quantities import Parametrised, Quantity, parameters, standing_path
from stickslip.show.formatting import number, percent, quantity

VIOLATION_LIMIT = 1e-9
ENERGY_LIMIT = 1e-8
"""Steps of relative error 1e-12 add up over a long run, and rounding over a longer one."""
NEAR_LIMIT_SHARE = 0.1
"""Share of its largest margin at which a run is said to come near to a limit."""
ROUNDED = 2e-15
"""Share of the largest places by which a sum of them may change by rounding, within a row."""
RESIDUAL_LIMIT = 1e-6
"""Events are located to rounding of the time; a steep guard at a late time leaves this much."""
DEPENDENT = 1e-14
"""Singular value of slip rows, over the largest and for each row, that is rounding."""
NODES, MOST_ROWS = 4, 5_000
"""Places in a step at which the power of friction is looked at, and most steps for that."""
DRIVING_SHARE = 1e-9
"""Share of the work of friction that is rounding."""
SHARED = 1e-9
"""Weight of a row in a sum that vanishes, of squares 1, below which it has no part in it."""


def energy_limit_at(tolerance: float) -> float:
    """Return the energy error that a run with a tolerance may have."""
    return max(ENERGY_LIMIT, 1e3 * tolerance)


def passes(
    evidence: NDArray[np.float64], status: NDArray[np.object_], tolerance: float
) -> NDArray[np.bool_]:
    """Return whether each run of a batch (n,) passes, from its evidence (n, 3 or more)."""
    limits = np.array([energy_limit_at(tolerance), VIOLATION_LIMIT, RESIDUAL_LIMIT])
    complete = np.array([ending.complete for ending in status], dtype=np.bool_)
    return np.asarray((evidence[:, :3] <= limits).all(axis=1) & complete)


def certify(
    playback: Playback, w: Sequence[float], iw: Sequence[int], tolerance: float
) -> Certificate:
    """Check energy, guards, events and stick of a finished run."""
    books = _books(playback, w)
    energy_error = books["energy_error"]
    violation, residual = float(w[layout.VIOLATION]), float(w[layout.RESIDUAL])
    drift = _stick_drift(playback, w)
    energy_limit = energy_limit_at(tolerance)
    problems = []
    if iw[layout.STATUS] not in (layout.END_TIME, layout.AT_REST):
        end = quantity(playback.span()[1], "s", 6)
        problems.append(f"the run ended at {end}, before the end that was asked for")
    if not energy_error <= energy_limit:  # NaN is above every limit
        problems.append(
            f"energy balance violated: relative error {number(energy_error, 2)},"
            f" allowed {number(energy_limit, 2)}"
        )
    if not violation <= VIOLATION_LIMIT:
        problems.append(f"a mode condition is violated by {number(violation, 2)} of its scale")
    if not residual <= RESIDUAL_LIMIT:
        problems.append(
            f"an event was located only to within {number(residual, 2)} of its guard function"
        )
    if drift != 0:
        problems.append(f"a sticking body moved by {number(drift, 2)} m")
    margins = _margins(playback, w, iw[layout.STATUS])
    return Certificate(
        **books,
        margins=margins,
        warnings=(
            *(
                _warning(name, share)
                for name, share in margins.items()
                if 0.0 < share < NEAR_LIMIT_SHARE
            ),
            *_doubts(iw),
        ),
        work=_works(playback, w),
        decisions=iw[layout.DECISIONS] if playback.model.contacts else 0,
        ambiguous=iw[layout.AMBIGUOUS] if playback.model.contacts else 0,
        indeterminate=_indeterminate(playback, w) if playback.model.contacts else (),
        guard_violation=violation,
        event_residual=residual,
        stick_drift=drift,
        steps=iw[layout.STEPS],
        rejected=iw[layout.REJECTED],
        problems=tuple(problems),
    )


def _margins(playback: Playback, w: Sequence[float], status: int) -> dict[str, float]:
    """Return the least margin of each limit over its largest, and that of the normal force."""
    header, limits = playback.runner.header, playback.model.limits
    guards = {"lift-off": layout.LIFT_OFF} if header[layout.CAN_LIFT] else {}
    guards |= {name: header[layout.FIRST_LIMIT] + i for i, name in enumerate(limits)}
    # A limit ends a run by a status of its own: its margin is 0 then, whatever the least sample
    # was.
    ends = {"lift-off": layout.LIFTED_OFF}
    ends |= {name: layout.LIMITED + i for i, name in enumerate(limits)}
    result = {}
    for name, guard in guards.items():
        least, size = (
            float(w[header[layout.LOWEST] + guard]),
            float(w[header[layout.REACHED] + guard]),
        )
        if status == ends[name]:
            result[name] = 0.0
        elif math.isfinite(least) and size > 0.0:
            result[name] = max(least, 0.0) / size
    return result


def _works(playback: Playback, w: Sequence[float]) -> dict[str, float]:
    """Return the work that friction has taken at each of several contacts."""
    first = playback.runner.header[layout.WORKS]
    return {name: float(w[first + c]) for c, name in enumerate(playback.model.contacts)}


def _doubts(iw: Sequence[int]) -> tuple[str, ...]:
    """Return what the rigid model leaves open: which contacts hold at an instant."""
    count = iw[layout.AMBIGUOUS]
    if not count:
        return ()
    times = "instant" if count == 1 else "instants"
    return (
        f"at {count} {times} the rigid model allows another decision on which contacts hold;"
        " friction was taken to pass its static level before it drops",
    )


def _warning(name: str, share: float) -> str:
    if name == "lift-off":
        return f"the normal force fell to {percent(share)} of its largest value"
    if name == PAINLEVE:
        return f"the equations came within {percent(share)} of the Painlevé paradox"
    return f"{name}: the margin fell to {percent(share)} of its largest value"


def driving(
    mechanism: Mechanism, law: FrictionLaw | Laws, playback: Playback, certificate: Certificate
) -> tuple[str, ...]:
    """Return at which contacts friction did work on what it should brake, in sentences.

    Without memory it is the work while friction is along the slip. Bristles give back what they
    took, so that theirs is what they gave beyond that.
    """
    result = []
    for contact in mechanism.contacts():
        own = law_of(contact.name, law)
        if own is None or not may_drive(own):
            continue
        several = bool(playback.model.contacts) and not playback.model.alone
        taken = certificate.work[contact.name] if several else certificate.work_friction
        # bristles give back what they took: only what goes beyond that has driven anything
        given = max(-taken, 0.0) if own.states else _driving_work(mechanism, contact, playback)
        if given > DRIVING_SHARE * abs(taken):
            where = f" at {contact.name}" if several else ""
            work = quantity(given, "J", 2)
            did = f"gave {work} more than it took" if own.states else f"did {work} of work on it"
            result.append(
                f"friction drove the motion{where}: it {did}; the law {own.name} with these values"
                " does not oppose slip at every speed"
            )
    return tuple(result)


def may_drive(law: FrictionLaw) -> bool:
    """Whether friction may be along the slip; factors that would turn it end a run before."""
    if law.passivity is ALWAYS or law.composition is None:
        return law.passivity is not ALWAYS
    # Factors only change the size of what they multiply; their own limits end a run where they
    # would turn it.
    parts = (name.part for name in law.composition.parts() if name.role != "factor")
    return not all(part.opposes for part in parts)


def _driving_work(mechanism: Mechanism, contact: Contact, playback: Playback) -> float:
    """Return the work that friction does at a contact while it is along the slip."""
    starts, ends = playback.rows[:, 0], playback.rows[:, 1]
    if len(starts) > MOST_ROWS:  # between evenly chosen times instead of all events
        times = np.linspace(starts[0], ends[-1], MOST_ROWS + 1)
        starts, ends = times[:-1], times[1:]
    # Gauss's rule in each step: the power is smooth within one, and jumps between them.
    halves = 0.5 * (ends - starts)
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    columns = playback((0.5 * (starts + ends) + halves * nodes[:, None]).ravel())
    slip = contact.slip if isinstance(contact.slip, Mapping) else {contact.slip: 1.0}
    rates = dict(zip(mechanism.coordinates, mechanism.rates, strict=True))
    moving = {name: factor for name, factor in slip.items() if rates.get(name) in columns}
    speed = sum(float(factor) * columns[rates[name]] for name, factor in moving.items())
    model = playback.model
    name = model.column("friction", contact.name) if model.contacts else "friction"
    # Only where friction is along the slip: what it brakes elsewhere must not balance that.
    power = np.minimum(columns[name] * speed, 0.0).reshape(NODES, -1)
    return float(-(weights @ power * halves).sum())


def _books(playback: Playback, w: Sequence[float]) -> dict[str, float]:
    """Return energies and works, and their mismatch over all energies and all work done."""
    (start, still), (end, at_rest) = _energies(playback, w)
    # the run books works as it goes, by quadrature along its steps; energies are of states alone
    supplied, taken = float(w[layout.SUPPLIED]), float(w[layout.TAKEN])
    lost = float(w[layout.LOST])
    # of what falls freely, the sum of both energies may be rounding alone
    size = max(abs(start), abs(end), float(w[layout.GROSS]), start - still, end - at_rest)
    mismatch = abs(end - start - supplied + taken + lost)
    return {
        "energy_error": mismatch / size if mismatch != 0 else 0.0,  # what is no number stays none
        "energy_start": start,
        "energy_end": end,
        "work_supplied": supplied,
        "work_friction": taken,
        "work_stops": lost,
    }


def _energies(playback: Playback, w: Sequence[float]) -> list[list[float]]:
    """Return the energies at the start of the first row and at the end of the last, and at rest."""
    rows, n, y = playback.rows, len(playback.model.states), playback.runner.header[layout.Y]
    # lists, as plain equations take them: of few numbers they are faster than arrays
    start = rows[0, layout.ROW_DENSE + 1 : layout.ROW_DENSE + 1 + n].tolist()
    states = start, [float(number) for number in w[y : y + n]]
    equations = Equations(playback.model, playback.inputs)
    coordinates = playback.runner.header[layout.N_COORDINATES]
    still = [0.0] * coordinates
    result = []
    for row, t, state in zip((rows[0], rows[-1]), playback.span(), states, strict=True):
        if row[5] != equations.piece:
            equations.load(int(row[5]))
        moves = state[coordinates : 2 * coordinates] != still
        rest = [*state[:coordinates], *still, *state[2 * coordinates :]]
        own = [equations("energy", 0, int(row[4]), t, y)[0] for y in (state, rest)[: 1 + moves]]
        result.append([float(own[0]), float(own[-1])])
    return result


def _contact_drift(playback: Playback, w: Sequence[float]) -> float:
    """Return the largest change of a coordinate, or of a sum, within a row in which it is held.

    Of a sum the rounding of its parts is no change.
    """
    header = playback.runner.header
    rows, n, y = playback.rows, header[layout.N_COORDINATES], header[layout.Y]
    # The last row has no follower: its end is the state with which the run ended.
    end = np.array([float(x) for x in w[y : y + n]])
    places = np.vstack([rows[:, layout.ROW_DENSE + 1 : layout.ROW_DENSE + 1 + n], end])
    modes = _modes(playback)
    moved = np.abs(np.diff(places, axis=0))[modes[:, :n] == layout.HELD_FAST]
    closing = _closing_slips(playback, w)
    if not closing.size:
        return float(moved.max(initial=0.0))
    sums = np.diff(places @ closing.T, axis=0)
    # Rounding of a sum is that of its largest parts.
    allowed = ROUNDED * np.abs(places).max(axis=0) @ np.abs(closing).T
    beyond = np.maximum(np.abs(sums) - allowed, 0.0)
    beyond = beyond[modes[:, n : n + len(closing)] == layout.HELD_FAST]
    return float(max(moved.max(initial=0.0), beyond.max(initial=0.0)))


def _modes(playback: Playback) -> NDArray[np.float64]:
    """Return the modes of all directions and cuts in each row."""
    count, pairs = len(playback.model.contacts), playback.runner.header[layout.N_PAIRS]
    last = playback.rows.shape[1] - 2 * count
    return playback.rows[:, last - pairs : last]


def _closing_slips(playback: Playback, w: Sequence[float]) -> NDArray[np.float64]:
    """Return the factors (m, n) of the coordinates in the slips that close loops."""
    header = playback.runner.header
    n, first = header[layout.N_COORDINATES], header[layout.LOOPS]
    m = header[layout.N_DIRECTIONS] - n
    return np.array([float(x) for x in w[first : first + m * n]]).reshape(m, n)


def _indeterminate(playback: Playback, w: Sequence[float]) -> tuple[tuple[str, ...], ...]:
    """Return the sets of contacts that held together though fewer of them would have done.

    Those are contacts along one direction, and those of a loop.
    """
    header, names = playback.runner.header, playback.model.contacts
    slips = header[header[layout.SLIPS] : header[layout.SLIPS] + len(names)]
    holds = header[header[layout.HOLDS] : header[layout.HOLDS] + len(names)]
    n = header[layout.N_COORDINATES]
    # With one contact a direction, and without loops, what holds is what is needed.
    if len(set(slips)) == len(slips) and not playback.model.closing:
        return ()
    every = np.vstack([np.eye(n), _closing_slips(playback, w)])
    width, count = playback.rows.shape[1], len(names)
    states = np.hstack([_modes(playback)[:, : len(every)], playback.rows[:, width - count :]])
    result: dict[tuple[str, ...], None] = {}
    # Few states of contacts occur in a run: each is looked at once.
    for state in np.unique(states, axis=0):
        held = [
            c
            for c in range(count)
            if holds[c] and not state[len(every) + c] and state[slips[c]] == layout.HELD_FAST
        ]
        for loop in _dependent(every[[slips[c] for c in held]]):
            result[tuple(names[held[k]] for k in loop)] = None
    return tuple(result)


def _dependent(rows: NDArray[np.float64]) -> list[list[int]]:
    """Return the sets of rows in which each follows from others, those apart from each other."""
    if len(rows) == 0:
        return []
    # Of the transposed rows, so that right singular vectors are weights of rows.
    _, sizes, right = np.linalg.svd(rows.T)
    rank = int((sizes > sizes[0] * len(rows) * DEPENDENT).sum())
    # weights with which rows add up to nothing; a row without one follows from no others
    shared = np.abs(right[rank:].T @ right[rank:]) > SHARED
    sets: list[list[int]] = []
    for k in range(len(rows)):
        # Sets that have a row in common are one: a loop may close another.
        if shared[k, k]:
            own = {k, *np.flatnonzero(shared[k]).tolist()}
            apart = [row for row in sets if not own & set(row)]
            joined = own.union(*(row for row in sets if own & set(row)))
            sets = [*apart, sorted(joined)]
    return sets


def _stick_drift(playback: Playback, w: Sequence[float]) -> float:
    """Return the largest change of the slip coordinate within a row of rest, at a stop or not."""
    rows, header = playback.rows, playback.runner.header
    if playback.model.contacts:
        return _contact_drift(playback, w)
    (held,) = (np.abs(rows[:, 3]) != 1.0).nonzero()  # modes -1 and 1 slip
    if not held.size:
        return 0.0
    coordinate = header[layout.SLIP] - header[layout.N_COORDINATES]
    places = playback.column(layout.ROW_DENSE + 1 + coordinate, w[header[layout.Y] + coordinate])
    moved = places[held + 1] - places[held]
    return float(np.abs(moved).max()) if np.count_nonzero(moved) else 0.0


# Sensitivities of a run, from its record.

Array = NDArray[np.float64]


def roots_of(mechanism: Mechanism, law: FrictionLaw | Laws) -> Mapping[str, Parametrised]:
    """Return what has the parameters of a run, by the prefix of their paths."""
    return {"mechanism": mechanism, "friction": law}


def quantities_of(
    mechanism: Mechanism, law: FrictionLaw | Laws, model: Model
) -> Mapping[str, Quantity]:
    """Return what can vary by full path."""
    known = {f"initial.{state}": Quantity(state) for state in model.states}
    for prefix, root in roots_of(mechanism, law).items():
        known |= {path: quantity for path, quantity, _ in parameters(root, prefix)}
    return known


@dataclass(frozen=True)
class Directions:
    """What sensitivities are taken with respect to, as kernels take it."""

    own: Array
    """Quantity of each direction, -1 for an initial state."""
    start: Array
    """Sensitivities at the start (states, directions)."""
    table: Array
    """Derivatives of the drives' tables, a row a run; innermost a column a direction."""
    quantities: int
    """Number of quantities that the equations have."""


def directions_of(
    mechanism: Mechanism,
    model: Model,
    paths: Sequence[str],
    columns: Mapping[str, Array],
    tables: Array,
    t_end: float,
    told: Sequence[str] = (),
) -> Directions:
    """Return the directions of full paths, for runs of a model that differ by `columns`.

    `tables` has a row a run, or one where no drive varies; `told` are the states that begin where
    the mechanism says.
    """
    for path in paths:
        if path in model.turning:
            raise InputError(
                f"{path} has no sensitivity: a contact of {type(mechanism).__name__} slips along a"
                " sum of coordinates that depends on it. Choose relative coordinates, of which the"
                " slip is one, or take differences of runs."
            )
    own, start = _along(model, tuple(paths))
    if told:  # states that begin where the mechanism says change with its parameters
        start = start.copy()
        for state, slope in start_slopes(mechanism, columns, paths, told).items():
            start[model.states.index(state)] += slope
    driven = {path: column for path, column in columns.items() if len(column) == len(tables)}
    slopes = schedule_slopes(mechanism, driven, paths, tables, t_end)
    quantities = 3 * len(model.drives) + len(model.parameter_paths)
    return Directions(own, start, slopes, quantities)


@functools.lru_cache(maxsize=256)
def _along(model: Model, paths: tuple[str, ...]) -> tuple[Array, Array]:
    """Return the quantity of each path, and the sensitivities at the start (states, paths)."""
    own = np.full(len(paths), -1.0)
    start = np.zeros((len(model.states), len(paths)))
    for c, path in enumerate(paths):
        if path in model.parameter_paths:
            own[c] = 3 * len(model.drives) + model.parameter_paths.index(path)
        else:
            start[model.states.index(path.removeprefix("initial.")), c] = 1.0
    return own, start


@dataclass(frozen=True)
class Sensing:
    """Answers how the states of a recorded run change with parameters and initial states."""

    mechanism: Mechanism
    """What moved."""
    law: FrictionLaw | Laws
    """Friction of its contact."""
    inputs: Inputs
    """Parameters and drives of the run."""
    record: Record
    """What the kernels recorded."""
    t_end: float
    """End that was asked for."""
    told: tuple[str, ...]
    """States that began where the mechanism says."""
    sloped: Model | None = None
    """Equations with derivatives, where they are known."""

    def __call__(self, t: Array, paths: Sequence[str]) -> Array:
        """Return sensitivities (n, states, paths) at times (n,)."""
        model = self.sloped or formulate(self.mechanism, self.law, slopes=True)
        full = list(paths)
        if not {*model.parameter_paths, *map("initial.{}".format, model.states)}.issuperset(paths):
            roots = roots_of(self.mechanism, self.law)
            known = quantities_of(self.mechanism, self.law, model)
            full = [standing_path(path, known, roots) for path in paths]
        record = self.record
        runner = runner_of(model, compiled=self._takes_code(model))
        table = self.inputs.table[None, :]
        along = directions_of(self.mechanism, model, full, {}, table, self.t_end, self.told)
        order = np.argsort(t, kind="stable")
        out = runner.zeros(len(t) * len(model.states) * len(full))
        log, events = record.log, record.events
        # The record may be of the other tier, whose vectors are lists or arrays.
        if runner.compiled is not record.runner.compiled:
            log, events = runner.flat(log), runner.flat(events)
        # Time of the interpreter alone: it decides when machine code would have paid.
        begun = 0.0 if runner.compiled else thread_time()
        runner.kernels.enter_sense(
            log,
            record.iw[layout.STEPS],
            events,
            record.iw[layout.EVENTS],
            runner.flat(t[order]),
            runner.flat(self.inputs.table),
            runner.flat(along.table),
            runner.flat(along.own),
            along.quantities,
            working(runner, runner.working(self.inputs.p), along),
            runner.iw(),
            out,
            0,
        )
        if not runner.compiled:
            work_of(model).add(thread_time() - begun)
        # Kernels answer in increasing times; users ask in any order.
        result = np.empty((len(t), len(model.states), len(full)))
        result[order] = np.reshape(out, result.shape)
        return result

    def _takes_code(self, model: Model) -> bool:
        """Whether machine code takes over from the tier of the run.

        It does as in runs: once plain Python has taken twice as long as getting it. The run itself
        counts, because its sensitivities take as long again at least.
        """
        spent, work = self.record.spent, work_of(model)
        if self.record.runner.compiled or spent is None:
            return self.record.runner.compiled
        return work.is_enough(spent + work.seconds)


def working(runner: Runner, w: Any, along: Directions) -> Any:
    """Return the vector of a run, made long enough, with the sensitivities at the start."""
    size, first = _places(runner.model, along.quantities, len(along.own))
    longer = runner.zeros(size)
    longer[: len(w)] = w
    start = along.start.ravel()
    longer[first : first + start.size] = start if runner.compiled else start.tolist()
    return longer


@functools.lru_cache(maxsize=256)
def _places(model: Model, quantities: int, directions: int) -> tuple[int, int]:
    """Return how long the vector must be, and where the sensitivities stand in it."""
    sizes = quantities, directions, [*model.sizes.header]
    return sense_size(*sizes), columns_at(0, *sizes)
