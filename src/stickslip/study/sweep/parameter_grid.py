"""Grids of parameters: paths, their products, and what each row makes of the mechanism."""

import math
import numbers
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.engine.simulation import initial_state
from stickslip.engine.solver import EventDriven, as_numbers, path_units
from stickslip.errors import InputError, ParameterError, check_size, concerning
from stickslip.friction import FrictionLaw, Laws, bristle_names
from stickslip.mechanisms import Mechanism, cycle_of
from stickslip.quantities import Quantity, full_path, parameters, vary
from stickslip.show.formatting import span
from stickslip.study.energy import columns_of, energy_balance

Array: TypeAlias = NDArray[np.float64]
Progress: TypeAlias = Callable[[int, int], object]

PERIOD = Quantity("T", "s", above=0)
MOST_RANGES = 3
"""Ranges of a parameter that a sentence lists; of more it gives the ends."""
MOST_CYCLES = 1_000_000
"""Cycles of a run; more are a slip of the pen."""


def states_of(mechanism: Mechanism, law: FrictionLaw | Laws) -> tuple[str, ...]:
    """Return the names of all states, bristles last.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> states_of(Axis(inertia=1.0), Coulomb(kinetic_coefficient=1.0))
    ('x', 'v')
    """
    contacts = tuple(contact.name for contact in mechanism.contacts())
    return (*mechanism.coordinates, *mechanism.rates, *bristle_names(contacts, law))


def axis_of(
    mechanism: Mechanism, law: FrictionLaw | Laws, path: str, values: ArrayLike
) -> tuple[str, Array]:
    """Return the full path and the numbers of what varies.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> axis_of(Axis(inertia=1.0), Coulomb(kinetic_coefficient=1.0), "inertia", [1, 2])
    ('mechanism.inertia', array([1., 2.]))
    """
    known = {f"initial.{name}": Quantity(name) for name in states_of(mechanism, law)}
    for root, prefix in ((mechanism, "mechanism"), (law, "friction")):
        known |= {match: quantity for match, quantity, _ in parameters(root, prefix)}
    full = full_path(path, known)
    array = np.atleast_1d(as_numbers(full, values))
    if array.ndim > 1 or not array.size or not np.isfinite(array).all():
        raise InputError(f"{full} must be an array (n,) of finite numbers, got {values!r}.")
    return full, array


def check_path(owner: str, path: object) -> None:
    """Refuse what does not name one parameter, and a full path of an initial state.

    Examples
    --------
    >>> check_path("orbit_diagram", "mechanism.stiffness")
    """
    if not isinstance(path, str):
        raise InputError(
            f"{owner}: path must name one parameter, as 'friction.static_coefficient' does, got"
            f" {path!r}: vary one at a time."
        )
    if path.startswith("initial."):
        raise InputError(
            f"{owner}: {path} is not a parameter of the equations; give one of the mechanism or of"
            " the law."
        )


def unit_of(mechanism: Mechanism, law: FrictionLaw | Laws, path: str) -> str:
    """Return the SI unit of a full path.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> unit_of(Axis(inertia=1.0), Coulomb(kinetic_coefficient=1.0), "mechanism.stiffness")
    'N/m'
    """
    return path_units(mechanism, law).get(path, "1")


def product(axes: Mapping[str, Array]) -> dict[str, Array]:
    """Return all combinations of the axes, the last one varying fastest.

    Examples
    --------
    >>> product({"a": np.array([1.0, 2.0]), "b": np.array([5.0, 6.0])})["a"]
    array([1., 1., 2., 2.])
    """
    count = math.prod(len(values) for values in axes.values())
    check_size("grid", count * len(axes), "give fewer values")
    grids = np.meshgrid(*axes.values(), indexing="ij")
    return {path: grid.ravel() for path, grid in zip(axes, grids, strict=True)}


def cycles_of(mechanism: Mechanism, columns: Mapping[str, Array], period: float | None) -> Array:
    """Return the period of each row (n,) [s]: the one that is given, or that of its drives.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(inertia=1.0, drive=Sine(amplitude=1.0, frequency=2.0))
    >>> cycles_of(axis, {"mechanism.drive.frequency": np.array([4.0, 5.0])}, None)
    array([0.25, 0.2 ])
    """
    count = len(next(iter(columns.values())))
    if period is not None:
        return np.full(count, PERIOD.check("sweep", "period", period))
    own = {path: values for path, values in columns.items() if path.startswith("mechanism.")}
    result = np.empty(count)
    seen: dict[tuple[float, ...], float] = {}
    for row in range(count):
        changes = {path: float(values[row]) for path, values in own.items()}
        key = tuple(changes.values())
        if key not in seen:
            with concerning(f"run {row}:"):
                seen[key] = cycle_of(vary(mechanism, "mechanism", changes))
        result[row] = seen[key]
    return result


def pair_of(
    mechanism: Mechanism, law: FrictionLaw | Laws, at: Mapping[str, float]
) -> tuple[Mechanism, FrictionLaw | Laws]:
    """Return mechanism and law with values by full path; starts are left out.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> axis, law = Axis(inertia=1.0), Coulomb(kinetic_coefficient=1.0)
    >>> pair_of(axis, law, {"mechanism.inertia": 2.0, "initial.x": 0.1})[0].inertia
    2.0
    """
    own = {path: x for path, x in at.items() if path.startswith("mechanism.")}
    laws = {path: x for path, x in at.items() if path.startswith("friction.")}
    return vary(mechanism, "mechanism", own), vary(law, "friction", laws)


def energies_of(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    columns: Mapping[str, Array],
    spans: Array,
    y0: Mapping[str, float] | Sequence[float] | None,
    solver: EventDriven,
    coordinate: str | None = None,
) -> dict[str, Array]:
    """Return `EnergyBalance.columns` (n,) of a run for each row, within spans of time (n, 2) [s].

    Rows without a span have no number; the span of a run that ends early ends with it.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> axis, law = Axis(inertia=1.0), Coulomb(kinetic_coefficient=0.5)
    >>> speeds, spans = {"initial.v": np.array([1.0, 2.0])}, np.array([[0.0, 4.0], [0.0, 4.0]])
    >>> energies_of(axis, law, speeds, spans, None, compiled(None))["power friction"].tolist()
    [0.125, 0.5]
    """
    result = {name: np.full(len(spans), np.nan) for name in columns_of(mechanism)}
    for row in np.flatnonzero(np.isfinite(spans).all(axis=1)).tolist():
        at = {path: float(values[row]) for path, values in columns.items()}
        own, laws = pair_of(mechanism, law, at)
        begin = zip(states_of(own, laws), initial_state("energies_of", own, laws, y0), strict=True)
        start = [at.get(f"initial.{name}", x) for name, x in begin]
        since, until = spans[row].tolist()
        run = solver.run(own, laws, y0=start, t_end=until)
        if since < run.span[1]:
            balance = energy_balance(
                own, run, coordinate=coordinate, since=since, until=min(until, run.span[1])
            )
            for name, value in balance.columns().items():
                result[name][row] = value
    return result


def counted(owner: str, name: str, value: object, least: int) -> int:
    """Return a whole number of at least `least`, and of no more than a run can have cycles.

    Examples
    --------
    >>> counted("basins", "keep", 12, 2)
    12
    """
    count = _whole(value)
    if count is None or not least <= count <= MOST_CYCLES:
        raise InputError(
            f"{owner}: {name} must be a whole number of {least} to {MOST_CYCLES}, got {value!r}."
        )
    return count


def _whole(value: object) -> int | None:
    """Return a whole number as such; floats count where they are whole."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        return None
    result = float(value)
    return int(result) if result.is_integer() else None


def whole_run(owner: str, mechanism: Mechanism, cycles: int) -> None:
    """Refuse more cycles than the drives of a mechanism can go through.

    A run would say so too, but only after it was compiled.

    Examples
    --------
    >>> from stickslip import Capsule
    >>> from stickslip.mechanisms.drives import SineSwing
    >>> from stickslip.mechanisms import Prescribed
    >>> swing = Prescribed(profile=SineSwing(amplitude=0.01, frequency=2.0))
    >>> whole_run("basins", Capsule(capsule_mass=0.8, inner_mass=0.2, drive=swing), 100)
    """
    for drive in mechanism.drives().values():
        period = drive.repeats()
        if period is not None:
            try:
                drive.pieces(cycles * float(period))
            except ParameterError as error:
                raise InputError(f"{owner}: {cycles} cycles are too many: {error}") from None


def compiled(solver: EventDriven | None) -> EventDriven:
    """Return the solver, the compiled one if none is given.

    Examples
    --------
    >>> compiled(None).tier
    'compiled'
    """
    return EventDriven(tier="compiled") if solver is None else solver


@dataclass
class Tally:
    """Counts the runs of several ensembles as those of one."""

    total: int
    """Runs in all."""
    report: Progress | None
    """Called with runs done and in all; asks to stop by returning False. None if nobody watches."""
    done: int = 0
    """Runs that are done."""
    going: bool = True
    """Whether nobody has asked to stop."""

    def part(self) -> Progress:
        """Return the progress of the next ensemble."""
        before = self.done

        def progress(done: int, _of: int) -> bool:
            self.tell(before + done)
            return self.going

        return progress

    def tell(self, done: int) -> None:
        """Note how many runs are done by now."""
        self.done = done
        if self.report is not None and self.report(done, self.total) is False:
            self.going = False


def near(periods: Array, ratio: float) -> Iterator[NDArray[np.intp]]:
    """Yield the rows in groups within which no period is longer than another by that ratio.

    Examples
    --------
    >>> [rows.tolist() for rows in near(np.array([1.0, 3.0, 1.1]), 1.25)]
    [[0, 2], [1]]
    """
    order = np.argsort(periods, kind="stable")
    while order.size:
        # From the shortest that is left: each group reaches up to the ratio above it.
        together = periods[order] <= ratio * periods[order[0]]
        yield np.sort(order[together])
        order = order[~together]


#: What a band does with runs that ended early.
NOT_IN_BAND = "The band leaves them out."


def early_ends(
    status: NDArray[np.object_],
    lacks: str,
    axes: Mapping[str, Array] | None = None,
    units: Mapping[str, str] | None = None,
    noun: str = "points",
) -> tuple[str, ...]:
    """Return where runs ended early, why, and what there is none of: a sentence for each reason.

    The last dimension of `status` may be of several runs at each point of the `axes`.

    Examples
    --------
    >>> from stickslip.engine.trajectory import Status
    >>> status = np.array([Status.ZENO, Status.END_TIME, Status.LIFT_OFF])
    >>> frequency = {"mechanism.drive.frequency": np.array([1.0, 2.0, 3.0])}
    >>> early_ends(status[1:], "No value there.", {"f": np.array([2.0, 3.0])}, {"f": "Hz"})
    ('At 1 of 2 points (f 3 Hz) the run stopped: Lift-off: the normal force fell to zero. No value
    there.',)
    """
    sentences = []
    # In the order in which they are met.
    for reason in dict.fromkeys(ending for ending in status.ravel() if not ending.complete):
        here = status == reason
        where = where_of(here, axes or {}, units or {})
        sentences.append(
            f"At {int(here.sum())} of {here.size} {noun}{where} the run stopped: {reason.value}"
            f" {lacks}".rstrip()
        )
    return tuple(sentences)


def runs_of(chosen: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return where runs of neighbours that are chosen begin and end (n, 2).

    Examples
    --------
    >>> runs_of(np.array([True, False, True, True])).tolist()
    [[0, 1], [2, 4]]
    """
    return np.flatnonzero(np.diff(chosen, prepend=False, append=False)).reshape(-1, 2)


def where_of(here: NDArray[np.bool_], axes: Mapping[str, Array], units: Mapping[str, str]) -> str:
    """Return where in a grid points lie: their ranges on one axis, on several what holds all.

    Examples
    --------
    >>> where_of(np.array([True, False]), {"f": np.array([1.0, 2.0])}, {"f": "Hz"})
    ' (f 1 Hz)'
    """
    places = []
    for dimension, (path, values) in enumerate(axes.items()):
        others = tuple(i for i in range(here.ndim) if i != dimension)
        order = np.argsort(values, kind="stable")
        chosen, sorted_values = np.asarray(here.any(axis=others))[order], values[order].tolist()
        pairs = [(sorted_values[a], sorted_values[b - 1]) for a, b in runs_of(chosen)]
        # On several axes a union of ranges would say less than the box around it.
        scattered = len(axes) > 1 or len(pairs) > MOST_RANGES
        if scattered:
            pairs = [(pairs[0][0], pairs[-1][1])]
        word = path.rpartition(".")[2].replace("_", " ")
        ranges = ", ".join(span(low, high, units.get(path, "1"), 4) for low, high in pairs)
        places.append(f"{word} {'within ' if scattered else ''}{ranges}")
    return f" ({'; '.join(places)})" if places else ""


def reasons_of(status: NDArray[np.object_]) -> list[str]:
    """Return why each run ended early, in words; empty where it is complete."""
    return ["" if ending.complete else ending.value for ending in status.ravel()]


def names_of(status: NDArray[np.object_]) -> NDArray[np.str_]:
    """Return the name of each `Status` of an array, in its shape.

    Examples
    --------
    >>> from stickslip.engine.trajectory import Status
    >>> names_of(np.array([[Status.END_TIME, Status.ZENO]])).tolist()
    [['END_TIME', 'ZENO']]
    """
    return np.array([ending.name for ending in status.ravel()]).reshape(status.shape)
