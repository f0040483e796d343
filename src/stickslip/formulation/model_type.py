"""What a formulated mechanism with its friction is: text, sizes, and the meaning of each number."""

from dataclasses import dataclass

from stickslip.kernels.header import Sizes


@dataclass(frozen=True, kw_only=True)
class Model:
    """The equations of a mechanism with a law, ready to be run, and the meaning of each number."""

    title: str
    """Mechanism and law in words."""
    sizes: Sizes
    """How much of everything it has, for the vectors of a run."""
    text: str
    """Program text: the functions that the kernels call."""
    states: tuple[str, ...]
    """Names of the states, coordinates before rates before bristles."""
    parameter_paths: tuple[str, ...]
    """Paths of the parameters in their order."""
    places: tuple[int, ...]
    """Place of each parameter in the vector of a run."""
    drives: tuple[str, ...]
    """Names of the drives; each owns three places at the beginning: value, slope, start."""
    has_slopes: bool
    """Whether the text has the derivatives with respect to parameters."""
    switch_events: tuple[tuple[str, str] | None, ...]
    """What each switch is called in events, when it comes true and when it ceases to hold."""
    impact_events: tuple[str | None, ...]
    """What an impact of each coordinate is called in events; None where it has no hard stop."""
    limits: tuple[str, ...]
    """What the limits are called that end a run."""
    latched: bool
    """Whether it has latched switches: the state alone does not tell which switches are on."""
    channels: tuple[str, ...]
    """What the efforts of guided coordinates are called."""
    contacts: tuple[str, ...] = ()
    """Names of the contacts, where several rub: the equations are parts then."""
    alone: bool = False
    """Whether there is but one contact, whose equations are parts all the same."""
    turning: tuple[str, ...] = ()
    """Paths of the parameters on which the change of coordinates depends, where slips are sums."""
    closing: tuple[str, ...] = ()
    """Names of the contacts whose slips follow from those of others."""
    law_switch_events: tuple[tuple[tuple[str, str] | None, ...], ...] = ()
    """What the switches of each contact's law are called in events."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns that a run has beside its states."""
        if not self.contacts:
            return ("friction", "normal_force", *self.channels)
        kinds = ("friction", "normal_force", "mode")
        own = (self.column(kind, name) for kind in kinds for name in self.contacts)
        return (*own, *self.channels)

    def column(self, kind: str, contact: str) -> str:
        """Return the column of a contact: its name stands in it where there are several."""
        return kind if self.alone else f"{kind}:{contact}"
