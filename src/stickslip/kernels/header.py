"""Sizes of a model, and the whole numbers of a run that follow from them."""

import functools
from dataclasses import dataclass

from stickslip.kernels import state_layout as at
from stickslip.kernels.enums import SWITCH

__all__ = ["Sizes"]


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """How much of everything a model has, and what it can do."""

    coordinates: int
    """Moving coordinates."""
    bristles: int
    """Bristle states."""
    slip: int
    """Index of the slip velocity among the states."""
    switches: int
    """Conditions of the equations."""
    limits: int
    """Conditions that end a run."""
    channels: int
    """Efforts of guided coordinates."""
    drives: int
    """Drives."""
    parameters: int
    """Parameters."""
    walls: tuple[tuple[int, int], ...]
    """Index of the coordinate and side, 1 above and -1 below, of each hard stop."""
    can_stick: bool
    """Whether the contact can be held."""
    can_lift: bool
    """Whether the normal force can change."""
    rest_is_final: bool
    """Whether only drives can move what is held."""

    @property
    def states(self) -> int:
        """Coordinates, rates, bristles."""
        return 2 * self.coordinates + self.bristles

    @property
    def guards(self) -> int:
        """Guards of a mode."""
        return SWITCH + self.switches + self.limits + len(self.walls)

    @property
    def first_parameter(self) -> int:
        """Place of the first parameter in the vector of a run."""
        return at.NUMBERS + 4 * self.drives + 1

    def _widths(self) -> dict[int, int]:
        """Return the room of each slot in the vector of a run, in their order."""
        n, guards = self.states, self.guards
        columns = 3 + self.coordinates
        return {
            at.Y: n,
            at.Y1: n,
            at.SCALE: n,
            at.END: n,
            at.POINT: n,
            at.VALUES: n + guards + self.channels + 8,
            at.STAGES: at.DOP853_STAGES * n,
            at.MATRIX: n * n,
            at.PIVOTS: n,
            at.DRIFT: n,
            at.DENSE: 1 + (at.SERIES + 1) * n,
            at.SAMPLED: (at.SAMPLES + 1) * guards,
            at.REACHED: guards,
            at.LOWEST: guards,
            at.SLOPES: guards * (n + 1),
            at.WALLS: len(self.walls) * columns,
            at.SIZE: 0,
        }

    @functools.cached_property
    def header(self) -> tuple[int, ...]:
        """The whole numbers of a run that begins: its state, 0, then sizes, places and tables."""
        whole = [0] * at.HEADER
        whole[at.N_STATES] = self.states
        whole[at.N_COORDINATES] = self.coordinates
        whole[at.N_GUARDS] = self.guards
        whole[at.N_SWITCHES] = self.switches
        whole[at.N_LIMITS] = self.limits
        whole[at.N_CHANNELS] = self.channels
        whole[at.N_WALLS] = len(self.walls)
        whole[at.N_DRIVES] = self.drives
        whole[at.SLIP] = self.slip
        whole[at.CAN_STICK] = int(self.can_stick)
        whole[at.CAN_LIFT] = int(self.can_lift)
        whole[at.HAS_BRISTLES] = int(self.bristles > 0)
        whole[at.REST_IS_FINAL] = int(self.rest_is_final)
        whole[at.FIRST_LIMIT] = SWITCH + self.switches
        whole[at.FIRST_WALL] = SWITCH + self.switches + self.limits
        whole[at.MOST_EVENTS] = 4 + self.switches * self.switches
        whole[at.WALL_COLUMNS] = 3 + self.coordinates
        whole[at.DENSE_SIZE] = 1 + (at.SERIES + 1) * self.states
        whole[at.ROW_COLUMNS] = at.ROW_DENSE + 1 + (at.TERMS + 1) * self.states
        whole[at.GIVEN] = at.NUMBERS + 3 * self.drives
        place = self.first_parameter + self.parameters
        for slot, width in self._widths().items():
            whole[slot] = place
            place += width
        return (*whole, *(number for wall in self.walls for number in wall))
