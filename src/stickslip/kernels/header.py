"""Sizes of a model, and the whole numbers of a run that follow from them."""

import functools
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate

from typing_extensions import override

from stickslip.kernels import state_layout as at
from stickslip.kernels.state_layout import SWITCH

LAW_NUMBERS = 7
"""Numbers that a law writes before the rates of its bristles."""
WALL_NUMBERS = 2
"""Numbers of a hard stop where several contacts rub: position, restitution."""


@dataclass(frozen=True, kw_only=True)
class Sizes(ABC):
    """How much of everything a model has, and what it can do."""

    coordinates: int
    """Moving coordinates."""
    bristles: int
    """Bristle states."""
    switches: int
    """Conditions of the equations."""
    drives: int
    """Drives."""
    parameters: int
    """Parameters of the mechanism, and of the law where the equations are those of modes."""
    constants: int
    """Numbers that the equations need of parameters alone."""
    rest_is_final: bool
    """Whether only drives can move what is held."""
    waves: int
    """Rows that may have harmonic terms in time where modes are exact: rates and guards of one
    contact, forces where several rub; 0 if none has any."""

    @property
    def states(self) -> int:
        """Coordinates, rates, bristles."""
        return 2 * self.coordinates + self.bristles

    @property
    @abstractmethod
    def guards(self) -> int:
        """Guards of a mode."""

    @property
    @abstractmethod
    def columns(self) -> int:
        """Columns that a recorded run has beside its states."""

    @property
    def first_parameter(self) -> int:
        """Place of the first parameter in the vector of a run."""
        return at.NUMBERS + 4 * self.drives + 1

    @property
    def header(self) -> tuple[int, ...]:
        """The whole numbers of a run that begins: its state, 0, then sizes, places and tables."""
        return _header(self)

    @abstractmethod
    def lengths(self) -> dict[str, int]:
        """Return how many numbers the functions of the equations write, by their names."""

    @abstractmethod
    def _own(self) -> dict[int, int]:
        """Return the sizes that kinds of models have in their own way, by slot."""

    @abstractmethod
    def _tables(self) -> Iterator[tuple[int | None, tuple[int, ...]]]:
        """Yield the slot of each table, and the table."""

    def _rooms(self) -> dict[int, int]:
        """Return the room of each slot in the vector of a run, in their order."""
        n, guards = self.states, self.guards
        return {
            at.CONSTANTS: self.constants,
            at.Y: n,
            at.Y1: n,
            at.SCALE: n,
            at.END: n,
            at.POINT: n,
            at.VALUES: n + guards + self.columns + 8,
            at.PULLS: self.coordinates,  # before the stages: set back for each run
            at.STAGES: at.DOP853_STAGES * n,
            at.MATRIX: n * n,
            at.PIVOTS: n,
            at.DRIFT: n,
            at.DENSE: 1 + (at.SERIES + 1) * n,
            at.SAMPLED: (at.SAMPLES + 1) * guards,
            at.REACHED: guards,
            at.LOWEST: guards,
            at.SLOPES: guards * (n + 1),
            at.WAVES: at.SERIES + 2 + 2 * self.waves,
        }


@functools.lru_cache(maxsize=256)
def _header(sizes: Sizes) -> tuple[int, ...]:
    """Return the whole numbers of a run that begins."""
    n = sizes.states
    whole = [0] * at.HEADER
    whole[at.N_STATES] = n
    whole[at.N_COORDINATES] = sizes.coordinates
    whole[at.N_GUARDS] = sizes.guards
    whole[at.N_SWITCHES] = sizes.switches
    whole[at.N_COLUMNS] = sizes.columns
    whole[at.N_DRIVES] = sizes.drives
    whole[at.HAS_BRISTLES] = int(sizes.bristles > 0)
    whole[at.REST_IS_FINAL] = int(sizes.rest_is_final)
    whole[at.N_WAVES] = sizes.waves
    whole[at.DENSE_SIZE] = 1 + (at.SERIES + 1) * n
    whole[at.ROW_COLUMNS] = at.ROW_DENSE + 1 + (at.TERMS + 1) * n
    whole[at.WALL_COLUMNS] = 3 + sizes.coordinates
    whole[at.GIVEN] = at.NUMBERS + 3 * sizes.drives
    for slot, size in sizes._own().items():
        whole[slot] = size
    place = sizes.first_parameter + sizes.parameters
    for slot, room in sizes._rooms().items():
        whole[slot] = place
        place += room
    if not sizes.constants:
        whole[at.CONSTANTS] = 0
    whole[at.SIZE] = place
    for table, numbers in sizes._tables():
        if table is not None:
            whole[table] = len(whole)
        whole += numbers
    return tuple(whole)


@dataclass(frozen=True, kw_only=True)
class ModeSizes(Sizes):
    """Of a model whose equations are those of the modes of one contact."""

    slip: int
    """Index of the slip velocity among the states."""
    limits: int
    """Conditions that end a run."""
    channels: int
    """Efforts of guided coordinates."""
    walls: tuple[tuple[int, int], ...]
    """Index of the coordinate and side, 1 above and -1 below, of each hard stop."""
    can_stick: bool
    """Whether the contact can be held."""
    can_lift: bool
    """Whether the normal force can change."""

    @property
    @override
    def guards(self) -> int:
        """Guards of a mode."""
        return SWITCH + self.switches + self.limits + len(self.walls)

    @property
    @override
    def columns(self) -> int:
        """Friction, normal force, efforts."""
        return 2 + self.channels

    @override
    def lengths(self) -> dict[str, int]:
        """Return how many numbers the functions of the equations write, by their names."""
        n, guards = self.states, self.guards
        quantities = 3 * self.drives + self.parameters
        return {
            "field": n,
            "jacobian": n * n,
            "time_slope": n,
            "guards": guards,
            "guard_slopes": guards * (n + 1),
            "linear": 1,
            "contact": 4 + self.channels,
            "power": 2,
            "energy": 1,
            "margins": self.switches,
            "diagram": self.coordinates + 3,
            "rest": 3,
            "walls": len(self.walls) * (3 + self.coordinates),
            "constants": self.constants,
            "waves": 2 * self.waves + int(self.waves > 0),
            "field_slopes": n * quantities,
            "guard_parameters": guards * quantities,
            "impact": self.coordinates,
            "impact_slopes": self.coordinates * n,
            "impact_parameters": self.coordinates * quantities,
        }

    @override
    def _own(self) -> dict[int, int]:
        return {
            at.N_LIMITS: self.limits,
            at.N_WALLS: len(self.walls),
            at.N_CHANNELS: self.channels,
            at.SLIP: self.slip,
            at.CAN_STICK: int(self.can_stick),
            at.CAN_LIFT: int(self.can_lift),
            at.FIRST_LIMIT: SWITCH + self.switches,
            at.FIRST_WALL: SWITCH + self.switches + self.limits,
            at.MOST_EVENTS: 4 + self.switches * self.switches,
        }

    @override
    def _rooms(self) -> dict[int, int]:
        return {**super()._rooms(), at.WALLS: len(self.walls) * (3 + self.coordinates)}

    @override
    def _tables(self) -> Iterator[tuple[int | None, tuple[int, ...]]]:
        yield None, tuple(number for wall in self.walls for number in wall)


def law_rows(
    first: int, numbers: Sequence[int], inputs_of: Sequence[int], bristles_of: Sequence[int]
) -> tuple[int, ...]:
    """Return where the row of each law begins, and where the last one ends.

    A row has a speed, parameters, contact inputs, bristles and a load.
    """
    beside = 2 + max(inputs_of, default=0) + max(bristles_of, default=0)
    return tuple(accumulate((number + beside for number in numbers), initial=first))


@dataclass(frozen=True, kw_only=True)
class ContactSizes(Sizes):
    """Of a model whose equations are parts, at which any number of contacts rub."""

    slips: tuple[int, ...]
    """Index of the direction along which each contact slips: a coordinate, or a closing slip."""
    looped: frozenset[int]
    """Indices of the coordinates that have a part in a loop of contacts."""
    closing: int
    """Slips that close loops."""
    cuts: int
    """Motions that break loops open."""
    turned: bool
    """Whether the coordinates are not those of the mechanism."""
    kinds: tuple[int, ...]
    """Index of each contact's law among those of different structure."""
    shared: tuple[int, ...]
    """Index of the numbers that each contact's law has: contacts may share a law."""
    numbers: tuple[int, ...]
    """How many parameters each of these has."""
    inputs_of: tuple[int, ...]
    """How many contact inputs each contact's law has."""
    bristles_of: tuple[int, ...]
    """How many bristle states each contact has."""
    holds: tuple[bool, ...]
    """Whether each contact's law holds it: it is set-valued, or has a rule for rest."""
    directional: tuple[bool, ...]
    """Whether each contact's law depends on the direction."""
    reacts: tuple[bool, ...]
    """Whether each contact's load is a reaction."""
    held: int
    """Held coordinates."""
    channels: int
    """Efforts of guided coordinates."""
    own_limits: int
    """Conditions of the mechanism that end a run."""
    walls: tuple[tuple[int, int], ...]
    """Index of the coordinate and side, 1 above and -1 below, of each hard stop."""
    mass: tuple[tuple[int, int], ...]
    """Row and column of each entry of the mass matrix."""
    slopes: tuple[tuple[int, int], ...]
    """Row and column of each slope of the forces along the states."""
    time_slopes: tuple[int, ...]
    """Row of each slope of the forces in time."""
    law_switches: int
    """Most conditions of a law."""
    constant_mass: bool
    """Whether the mass matrix is constant."""
    constant_loads: bool
    """Whether all loads are constant."""
    affine: bool
    """Whether the forces are affine in states and time, at any flags, and loads constant."""
    exact: bool
    """Whether all modes are, whatever the flags are, and never stiff: rows keep one state only."""
    supplies: bool
    """Whether anything puts power in."""
    part_slopes: tuple[tuple[int, ...], ...]
    """Rows of the parts that change with each variable: states, time, then, if there are slopes
    with respect to them, numbers of drives and parameters."""

    @property
    def directions(self) -> int:
        """Coordinates, then slips that follow from them."""
        return self.coordinates + self.closing

    @property
    def pairs(self) -> int:
        """Directions, then cuts: each has two guards."""
        return self.directions + self.cuts

    @property
    def _loop_numbers(self) -> int:
        """Closing slips and cuts by coordinates, and what of the former is in the latter."""
        return (self.closing + self.cuts) * self.coordinates + self.cuts * self.closing

    @property
    def contacts(self) -> int:
        """Contacts."""
        return len(self.slips)

    @property
    @override
    def guards(self) -> int:
        """Two of each pair, switches and opening of each contact, switches, limits, stops."""
        own = 2 * self.pairs + self.contacts * (self.law_switches + 1)
        return own + self.switches + self.limits + len(self.walls)

    @property
    def limits(self) -> int:
        """Conditions that end a run: the pivot of reactions that depend on friction, then own."""
        return int(any(self.reacts)) + self.own_limits

    @property
    @override
    def columns(self) -> int:
        """Friction, load and mode of each contact, efforts."""
        return 3 * self.contacts + self.channels

    @override
    def lengths(self) -> dict[str, int]:
        """Return how many numbers the functions of the equations write, by their names."""
        own = {
            "constants": self.constants,
            "energy": 1,
            "power": 1,
            "margins": self.switches,
            "margin_slopes": self.switches * (self.states + 1),
            "rest": self.coordinates,
            "forces": self.coordinates + self.held,
            "masses": len(self.mass),
            "loads": self.contacts + sum(self.inputs_of),
            "geometry": self.contacts * (1 + 2 * self.held),
            "force_slopes": len(self.slopes) + len(self.time_slopes),
            "waves": 2 * self.waves + int(self.waves > 0),
            "part_slopes": sum(map(len, self.part_slopes)),
        }
        some = {
            "turning": 2 * self.coordinates**2 * self.turned,
            "loops": self._loop_numbers,
            "efforts": self.channels,
            "limits": self.own_limits,
            "walls": WALL_NUMBERS * len(self.walls),
        }
        own |= {name: length for name, length in some.items() if length}
        for kind in set(self.kinds):
            own[f"law_{kind}"] = LAW_NUMBERS + self._most_bristles
            own[f"law_margins_{kind}"] = self.law_switches
            own[f"law_slopes_{kind}"] = self._law_slopes
            own[f"law_margin_slopes_{kind}"] = self.law_switches * self._most_variables
        return own

    @property
    def _most_variables(self) -> int:
        """Speed, parameters, contact inputs, bristles and load of a law."""
        numbers = [max(self.numbers, default=0)]
        return law_rows(0, numbers, self.inputs_of, self.bristles_of)[-1]

    @property
    def _law_slopes(self) -> int:
        """Slopes of a law in one direction, or of its margins."""
        return max(4 + self._most_bristles, self.law_switches) * self._most_variables

    @property
    def _part_rows(self) -> int:
        """Rows of the parts that have slopes."""
        rows = self.coordinates + self.held + self.contacts * (2 + 2 * self.held)
        return rows + self.switches + WALL_NUMBERS * len(self.walls) + sum(self.inputs_of)

    def law_places(self) -> tuple[int, ...]:
        """Return the place in the vector of a run of the numbers of each law."""
        return self._law_rows[:-1]

    @property
    def _law_rows(self) -> tuple[int, ...]:
        first = self.first_parameter + self.parameters
        return law_rows(first, self.numbers, self.inputs_of, self.bristles_of)

    @property
    def _most_bristles(self) -> int:
        return max(self.bristles_of, default=0)

    @override
    def _own(self) -> dict[int, int]:
        diagonal = self.constant_mass and all(
            row == column for row, column in self.mass if row < self.coordinates
        )
        diagonal = diagonal and self.closing == 0
        first_wall = self.guards - len(self.walls)
        return {
            at.N_LIMITS: self.limits,
            at.N_WALLS: len(self.walls),
            at.N_CHANNELS: self.channels,
            at.IS_TURNED: int(self.turned),
            at.WALL_COLUMNS: WALL_NUMBERS,
            at.FIRST_LIMIT: first_wall - self.limits,
            at.FIRST_WALL: first_wall,
            at.MOST_EVENTS: 2 * self._most_changes,  # of a step that ends where drives jump
            at.ROW_COLUMNS: at.ROW_DENSE
            + 1
            + (1 if self.exact else at.TERMS + 1) * self.states
            + self.pairs
            + 2 * self.contacts,
            at.N_DIRECTIONS: self.directions,
            at.N_PAIRS: self.pairs,
            at.N_CONTACTS: self.contacts,
            at.N_HELD: self.held,
            at.N_REACTIONS: sum(self.reacts),
            at.N_INPUTS: sum(self.inputs_of),
            at.N_MASSES: len(self.mass),
            at.N_SLOPES: len(self.slopes),
            at.N_TIME_SLOPES: len(self.time_slopes),
            at.LAW_SWITCHES: self.law_switches,
            at.CONSTANT_MASS: int(self.constant_mass),
            at.DIAGONAL: int(diagonal),
            at.CONSTANT_LOADS: int(self.constant_loads),
            at.AFFINE: int(self.affine),
            at.ALWAYS_EXACT: int(self.exact),
            at.SUPPLIES: int(self.supplies),
            at.N_VARIABLES: len(self.part_slopes),
            at.LAW_SLOPE_ROOM: self._law_slopes,
        }

    @override
    def _rooms(self) -> dict[int, int]:
        n, c, reacting = self.coordinates, self.contacts, sum(self.reacts)
        rows, pairs = n + self.held, self.pairs
        widest = max(self.states, pairs)
        return {
            at.LAW_ROWS: self._law_rows[-1] - self._law_rows[0],  # its table has their places
            **super()._rooms(),
            at.POINT: widest,
            at.DRIFT: widest,
            at.SLIP_FACTORS: c,
            at.HELD_SLIPS: c * self.held,
            at.HELD_NORMALS: c * self.held,
            at.FORCE: rows,
            at.MASS: rows * n,
            at.CHOLESKY: n * n,
            at.ACCELERATION: n,
            at.NEEDED: pairs,
            at.LEVELS: 2 * pairs,
            at.FRICTION: c,
            at.LOAD: c + sum(self.inputs_of),
            at.FRICTION_CONSTANT: c,
            at.FRICTION_FACTOR: c,
            at.LEVEL_CONSTANT: 2 * c,
            at.LEVEL_FACTOR: 2 * c,
            at.DAMPING: c,
            at.BRISTLE_RATES: self.bristles,
            at.LAW_VALUES: 1
            + LAW_NUMBERS
            + len(self.mass)
            + self.switches
            + self.law_switches
            + 4 * self._most_bristles,
            at.NEEDED_SERIES: (at.SERIES + 2) * pairs,
            at.SLOPE_VALUES: len(self.slopes) + len(self.time_slopes) + 1,
            at.ROOTS: 2 * pairs,
            at.BOUNDS: 2 * pairs,
            at.REACTION_ROWS: (reacting + 2) * (self.held + reacting + 2),
            at.WORKS: c,
            at.BOX: 2 * self.drives,
            at.CHANGES: self._most_changes * at.EVENT_COLUMNS,
            at.WALLS: WALL_NUMBERS * len(self.walls),
            at.MOTION_POINT: self.states + n + c,
            at.TURN: 2 * n * n * self.turned,
            **(self._slope_rooms() if self.part_slopes else {}),
            **(self._loop_rooms() if self.closing else {}),
        }

    def _loop_rooms(self) -> dict[int, int]:
        n = self.coordinates
        return {
            at.LOOPS: self._loop_numbers,
            at.FOLLOWED: self.closing * n,
            at.PROJECTED: n * n,
            at.BORNE: n,
            at.SHARES: n * (n + 2) + 2 * self.directions,
            at.REACHED_SO_FAR: n,
        }

    @property
    def _most_changes(self) -> int:
        """Most events of an instant: of each contact, stop, switch, and what ends the run."""
        return self.contacts + len(self.walls) + self.switches * self.switches + 4

    def _slope_rooms(self) -> dict[int, int]:
        n, c = self.coordinates, self.contacts
        return {
            at.PART_SLOPES: sum(map(len, self.part_slopes)),
            at.LAW_SLOPES: 3 * c * self._law_slopes,
            at.PART_COLUMN: self._part_rows,
            at.ACCELERATION_SLOPES: n,
            at.NEEDED_SLOPES: self.pairs,
            at.LOAD_SLOPES: c,
            at.FRICTION_SLOPES: c,
            at.LEVEL_SLOPES: 2 * self.pairs,
            at.BRISTLE_SLOPES: self.bristles,
        }

    @override
    def _tables(self) -> Iterator[tuple[int | None, tuple[int, ...]]]:
        n, c = self.directions, self.contacts
        places = self.law_places()
        first, bristles = 0, []
        for count in self.bristles_of:
            bristles.append(first if count else -1)
            first += count
        rigid = [0] * n + [1] * self.cuts
        for slip, holds in zip(self.slips, self.holds, strict=True):
            rigid[slip] |= int(holds)
        yield None, tuple(number for wall in self.walls for number in wall)
        yield at.MASS_ROWS, tuple(row for row, _ in self.mass)
        yield at.MASS_COLUMNS, tuple(column for _, column in self.mass)
        yield at.SLOPE_ROWS, tuple(row for row, _ in self.slopes)
        yield at.SLOPE_COLUMNS, tuple(column for _, column in self.slopes)
        yield at.TIME_ROWS, self.time_slopes
        yield at.SLIPS, self.slips
        yield at.KINDS, self.kinds
        yield at.BRISTLES, tuple(bristles)
        yield at.BRISTLE_COUNTS, self.bristles_of
        yield at.REACTS, tuple(map(int, self.reacts))
        yield at.LAW_ROWS, tuple(places[index] for index in self.shared)
        counts = zip(self.shared, self.inputs_of, strict=True)
        yield at.LAW_BRISTLES, tuple(1 + self.numbers[index] + own for index, own in counts)
        yield at.INPUTS, tuple(accumulate(self.inputs_of, initial=0))[:-1]
        yield at.INPUT_COUNTS, self.inputs_of
        yield at.DIRECTIONAL, tuple(map(int, self.directional))
        yield at.HOLDS, tuple(map(int, self.holds))
        yield at.RIGID, tuple(rigid)
        closing = range(self.coordinates, n)
        yield at.LOOPED, tuple(int(i in self.looped or i in closing) for i in range(self.pairs))
        yield at.FOLLOWERS, (-1,) * self.closing
        yield at.MODES, (0,) * self.pairs
        yield at.LAW_FLAGS, (0,) * c
        yield at.OPEN, (0,) * c
        yield at.CANDIDATES, (0,) * n
        yield at.FORCED, (0,) * n
        yield at.BEFORE, (0,) * n
        yield at.KEPT, (0,) * n
        yield at.STRUCK, (0,) * n
        yield at.CLOSED, (0,) * c
        yield at.ASKED, (0,) * c
        ends = accumulate(map(len, self.part_slopes), initial=0)
        yield at.PART_STARTS, tuple(ends)
        yield at.PART_ROWS, tuple(row for rows in self.part_slopes for row in rows)
        yield at.VARIABLE_PLACES, self._law_variables()

    def _law_variables(self) -> tuple[int, ...]:
        """Return the place of each variable that is a law's parameter, 0 for all others."""
        before = self.states + 1 + 3 * self.drives + self.parameters
        if len(self.part_slopes) <= before:
            return (0,) * len(self.part_slopes)
        own = zip(self.law_places(), self.numbers, strict=True)
        places = tuple(row + 1 + i for row, number in own for i in range(number))
        return (*(0,) * before, *places)
