"""What a solver is, and a run: a model in one of the two tiers.

The tiers are plain Python, at once, and machine code; both take the same vectors and give the same
numbers, to the bit. Which one a run takes, if it may choose (`Work.is_enough`):

1. Machine code that this process has, or that files hold, is taken at once: to load it takes .02 s.
2. What has to be compiled waits until plain runs have taken `PATIENCE` times as long as compiling
   does, as one hires skis until that would have bought them: a run takes at most 1.5 times as long
   as in plain Python then. Runs before count, of the same equations for these, and of all for the
   kernels. One that is on its way asks every `STRETCH` steps and goes on in machine code.
3. Kernels, which take seconds, are compiled by a process in the background; if there can be none,
   by rule 2.

Rows of steps and of events begin with some room, which is doubled where a run finds none.
"""

import functools
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from time import thread_time
from typing import Any, ClassVar, Literal, TypeAlias

import numpy as np

from stickslip.engine.formulation import Model, formulate
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.solver.backend import Runner, runner_of
from stickslip.engine.solver.compile.modules import compile_in_background, load_compiled
from stickslip.engine.solver.compile.programs import KERNELS, code_of
from stickslip.engine.solver.starts import Inputs
from stickslip.engine.trajectory import Trajectory
from stickslip.friction import FrictionLaw, Laws, PrintedForm
from stickslip.mechanisms import Mechanism, slips_by_angle
from stickslip.quantities import Parametrised, parameters, turned
from stickslip.units import per_second

# What a solver is.

KINDS = {"friction": "N", "mode": "1"}
"""Units of columns of a contact that slips along a line; others are bristles [m]."""


@dataclass(frozen=True, kw_only=True)
class Solver(Parametrised, ABC):
    """Settings of a method, which knows how to run a mechanism with a law."""

    @abstractmethod
    def run(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws | PrintedForm,
        *,
        y0: Sequence[float],
        t_end: float,
        told: Sequence[str] = (),
    ) -> Trajectory:
        """Integrate from time 0 to `t_end`.

        Parameters
        ----------
        mechanism : Mechanism
            What moves.
        law : FrictionLaw or PrintedForm
            What holds it back.
        y0 : sequence of float
            Coordinates, rates and bristle states at time 0.
        t_end : float
            Last time [s].
        told : sequence of str
            States that begin where the mechanism says, and with its parameters elsewhere.

        Returns
        -------
        Trajectory
            States at the steps, events, status and certificate.
        """


def column_units(mechanism: Mechanism, columns: Sequence[str]) -> dict[str, str]:
    """Return the unit of each column of a trajectory.

    Friction of a contact that slips along an angle is a torque, and its bristles are angles.
    """
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    units |= dict(zip(mechanism.rates, map(per_second, mechanism.units), strict=True))
    efforts = {guide.effort: guide.unit for guide in mechanism.guided().values()}
    turning = {place.name: slips_by_angle(mechanism, place) for place in mechanism.contacts()}
    several = len(turning) > 1
    own = {}
    for column in columns:
        kind, _, contact = column.partition(":")
        turns = turning.get(contact, False) if several else any(turning.values())
        own[column] = "N" if kind == "normal_force" else turned(KINDS.get(kind, "m"), turns)
    return units | own | efforts


def path_units(
    mechanism: Mechanism, law: FrictionLaw | Laws, bristles: Sequence[str] = ()
) -> dict[str, str]:
    """Return the unit of each initial state and parameter; a load left at 1 is 1 N.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> units = path_units(Axis(inertia=1.0), Coulomb(kinetic_coefficient=1.0))
    >>> units["mechanism.stiffness"], units["initial.v"]
    ('N/m', 'm/s')
    """
    own = column_units(mechanism, bristles)
    states = (*mechanism.coordinates, *mechanism.rates, *bristles)
    units = {f"initial.{state}": own[state] for state in states}
    angular = set(mechanism.units) == {"rad"}
    turns = mechanism.units[-1] == "rad"  # what parts such as stops of an inner body act on
    for path, quantity, _ in parameters(mechanism, "mechanism"):
        part = turns and path.count(".") > 1 and quantity.or_unit == turned(quantity.unit)
        units[path] = turned(quantity.unit, (angular or part) and bool(quantity.or_unit))
    turning = {contact.name: slips_by_angle(mechanism, contact) for contact in mechanism.contacts()}
    everywhere = all(turning.values())  # a law of all contacts
    for path, quantity, _ in parameters(law, "friction"):
        angle = turning.get(path.split(".")[1], everywhere)
        units[path] = quantity.unit_at(per_load=True, turning=angle)
    return units


# Runs a model in one of the two tiers: plain Python at once, or machine code.

Tier: TypeAlias = Literal["auto", "python", "compiled"]

LOADING = 0.02
"""Processor time to load kernels that an earlier process compiled [s, measured]."""
EQUATIONS = 0.1
"""Processor time to compile the equations of a model [s, measured]."""
PATIENCE = 2.0
"""Time in plain Python over that of compiling, from which machine code is compiled."""
ASIDE = 0.12
"""Time in plain Python from which a process in the background compiles the kernels [s]."""
LOOKS = 0.02
"""Time in plain Python after which files are looked at again [s]: that takes a hundredth of it."""
STRETCH = 500
"""Steps in plain Python after which a run asks whether machine code would pay."""
FIRST_ROWS = 128
"""Rows of steps and of events that a run begins with room for."""


@dataclass
class Work:
    """What runs of a model have taken in this process."""

    model: Model
    """Equations of a mechanism with a law."""
    seconds: float = 0.0
    """Processor time of the steps of plain runs [s]."""
    all_seconds: ClassVar[float] = 0.0
    """That of all models [s]."""
    pace: float = 0.0
    """Processor time of a run in the last chunk of an ensemble [s]; 0 if there was none."""
    ready: bool = False
    """Whether this process has machine code of the model, which then stays."""
    kept: tuple[bool, bool] = False, False
    """Whether there were files of the kernels and of the equations when they were looked for."""
    next_look: float = 0.0
    """What plain runs of the model have to take until files are looked at again [s]."""

    def add(self, seconds: float) -> None:
        """Count what a plain run has taken."""
        self.seconds += seconds
        Work.all_seconds += seconds

    def is_enough(self, own: float | None = None) -> bool:
        """Whether machine code is here or in files, or compiling it pays.

        What files hold is loaded at once: that takes some hundredths of a second in a process.
        What has to be compiled waits until plain runs have taken twice as long as compiling does.
        A run that begins counts those before it, of this model for its equations, and of all
        models for the kernels, which they share. One that is on its way counts its own time
        alone. A run that waits for compiling therefore takes at most 1.5 times as long as in plain
        Python, unless it is so short that compiling takes longer than that by itself; and all
        together never take more than that. Kernels that nobody has compiled yet are compiled by a
        process in the background, and without one here.
        """
        if self.ready:
            return True
        code = code_of(self.model)
        kernels, equations = KERNELS.is_ready(), code.is_ready()
        self.ready = kernels and equations
        if not self.ready and self.seconds >= self.next_look:
            self.next_look = self.seconds + LOOKS
            self.kept = KERNELS.is_kept(), code.is_kept()
        kernels, equations = kernels or self.kept[0], equations or self.kept[1]
        if kernels and equations:
            return True
        shared, these = (Work.all_seconds, self.seconds) if own is None else (own, own)
        cost = 0.0 if KERNELS.is_ready() else LOADING
        if not kernels:
            if shared < ASIDE or compile_in_background(code):
                return False
            cost = KERNELS.seconds
        missing = 0.0 if equations else EQUATIONS
        return shared >= PATIENCE * (cost + missing) and these >= PATIENCE * missing


@functools.lru_cache(maxsize=256)
def work_of(model: Model) -> Work:
    """Return what plain runs of a model have taken, one object in a process for each model."""
    return Work(model)


@dataclass(frozen=True)
class Record:
    """What the kernels wrote down of a run."""

    runner: Runner
    """What ran it, for what is asked of the run later."""
    log: Sequence[float]
    """Rows of steps one after the other, laid out as in `kernels.state_layout`."""
    events: Sequence[float]
    """Rows of events one after the other."""
    w: Sequence[float]
    """The vector of the run at its end."""
    iw: list[int]
    """(WHOLES,): the whole numbers of the run at its end."""
    spent: float | None = None
    """What it took in plain Python [s], where what is asked of it later may take machine code."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle numbers only: the vector of a run has addresses in it, or functions."""
        numbers = list(self.w)
        numbers[layout.ADDRESS] = numbers[layout.SEVERAL] = 0.0
        taken = self.iw[layout.STEPS] * self.runner.header[layout.ROW_COLUMNS]
        log, events = (np.array(rows, dtype=np.float64) for rows in (self.log, self.events))
        rows = self.runner, log[:taken], events, np.array(numbers)
        return _restored, (*rows, self.iw, self.spent)


def _restored(
    runner: Runner, log: Any, events: Any, w: Any, iw: list[int], spent: float | None
) -> Record:
    """Return the record of a pickle, as its tier takes it."""
    rows = runner.flat(log), runner.flat(events), runner.taken_over(w)
    return Record(runner, *rows, iw, spent)


def execute(
    model: Model,
    inputs: Inputs,
    y0: Sequence[float],
    *,
    t_end: float,
    tolerance: float,
    limit: int,
    tier: Tier,
    books: bool = True,
) -> Record:
    """Run a model from time 0 to `t_end`, with or without its books of energy."""
    work = work_of(model)
    runner = runner_of(model, compiled=tier == "compiled" or (tier == "auto" and work.is_enough()))
    header = runner.header
    w, iw = runner.working(inputs.p), runner.iw()
    iw[layout.BOOKS] = int(books)
    for i, value in enumerate(y0, header[layout.Y]):
        w[i] = float(value)
    given = inputs.table, inputs.bounds if len(inputs.bounds) else [0.0]
    table, bounds = map(runner.flat, given)
    # Each piece of the drives takes a step at least: room for as many spares doubling a long log.
    # Pages that no step reaches cost nothing.
    pieces = len(table) // (1 + 3 * header[layout.N_DRIVES]) if runner.compiled else 0
    log: Any = runner.zeros((FIRST_ROWS + min(pieces, limit)) * header[layout.ROW_COLUMNS])
    events: Any = runner.zeros(FIRST_ROWS * layout.EVENT_COLUMNS)
    spent = 0.0
    while True:
        # plain runs stop now and then to ask whether machine code would pay by now
        most = (
            limit if tier != "auto" or runner.compiled else min(limit, iw[layout.STEPS] + STRETCH)
        )
        start = 0.0 if runner.compiled else thread_time()
        log, events = runner.run(
            w, iw, table, bounds, t_end, tolerance, inputs.time_scale / 6.0, most, log, events
        )
        if not runner.compiled:
            taken = thread_time() - start
            work.add(taken)
            spent += taken
        if (
            most >= limit or iw[layout.STATUS] != layout.STEP_LIMIT
        ):  # of the run, not of the stretch
            known = spent if tier == "auto" else None
            return Record(runner, log, events, w, np.asarray(iw).tolist(), known)
        if work.is_enough(spent):  # the rest in machine code, which gives the same bits
            runner = runner_of(model, compiled=True)
            w, iw = runner.taken_over(w), runner.int_vectors(iw)
            log, events = runner.vector(log), runner.vector(events)
            table, bounds = map(runner.flat, given)


def prepare(mechanism: Mechanism, law: FrictionLaw | Laws) -> None:
    """Compile the equations of a pair, or load the machine code that an earlier process left.

    Afterwards runs of the same equations in this process are compiled ones, whatever their
    parameters.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw
        Friction of its contact.
    """
    load_compiled(formulate(mechanism, law))
