"""Structures: sets of terms with a bristle shape for each channel."""

from dataclasses import dataclass, replace
from typing import final

from typing_extensions import override

from stickslip.evidence.bristles import SIGN, Shape
from stickslip.evidence.terms import TERMS, Term
from stickslip.formatting import number

Family = tuple[tuple[tuple[str, str, str], ...], tuple[tuple[str, int], ...]]

GIVEN = ("known", "inertia")
"""Kinds that no search drops or swaps: they are of the mechanism."""
CARRIED = (
    "drift",
    "level_ripple",
    "level_slope",
    "second",
    "stribeck",
    "stribeck_dir",
    "temperature",
)
"""Kinds that modify a level or stand beside it, and need one."""
DRIVEN = ("backlash", "flexible", "loose")
"""Kinds that share an inertia out, and need one."""
LATE_OR_ELASTIC = ("delay", "lag", "backlash", "loose", "flexible")
"""Kinds that all shift force against motion near reversals."""
SHOWN_LATE = ("delay", "lag", "skew")
"""Kinds of which the force channel shows a force late, or ever later."""
SHIFTS = ("offset", "level_dir")
"""Kinds of which a channel has one ..."""
GEARS = ("weight", "motor_weight", "weight2")
"""... and such kinds of a level that grows with the force through a gear."""
DAMPED = "damping"
"""Kind of the damping of a bristle."""
GROWN = {"stribeck_cov": "stribeck", "viscous_cov": "viscous", "power_cov": "power"}
"""Kinds of what an input, such as a temperature, adds to another, whose nonlinear parameters they
share, and of what it adds to."""
PARAMETER = 0.1
"""What a nonlinear parameter counts for, in ranks."""
SHAPE_NAMES = ("r0", "n", "vs", "rho")
"""Names of a shape's values."""


def fades(shape: Shape) -> bool:
    """Return whether the level of a bristle falls with speed, as LuGre's does."""
    return len(shape) == 5


@final
@dataclass(frozen=True)
class Structure:
    """A hypothesis: terms, and the shape of the bristle they act through in each channel."""

    terms: tuple[Term, ...]
    """The terms, sorted by their text."""
    shapes: tuple[tuple[str, Shape], ...] = ()
    """Shapes by channel, where they are not the sign of the direction: (length, exponent) of Dahl
    and of the elasto-plastic stop, (length, 1, v_s, rho, delta) of LuGre."""

    def shape(self, channel: str) -> Shape:
        """Return the shape of a channel."""
        return dict(self.shapes).get(channel, SIGN)

    @property
    def memories(self) -> tuple[tuple[str, Shape], ...]:
        """Return channels and shapes of those that remember."""
        return tuple((channel, shape) for channel, shape in self.shapes if shape != SIGN)

    def having(self, *terms: Term) -> "Structure":
        """Return the structure with further terms; what an input adds is like what it adds to."""
        found = replace(self, terms=tuple({*self.terms, *terms}))
        return replace(self, terms=tuple(sorted(map(found.alike, found.terms), key=str)))

    def alike(self, term: Term) -> Term:
        """Return a term; one that an input adds to another, with the parameters of that one."""
        if term.kind not in GROWN:
            return term
        base = (GROWN[term.kind], term.channel)
        own = (one.par for one in self.terms if (one.kind, one.channel) == base)
        return replace(term, par=next(own, term.par))

    def without(self, term: Term) -> "Structure":
        """Return the structure without a term."""
        return replace(self, terms=tuple(one for one in self.terms if one != term))

    def shaped(self, channel: str, shape: Shape) -> "Structure":
        """Return the structure with another shape in a channel; only LuGre's bristle is damped."""
        shapes = {**dict(self.shapes), channel: shape}
        terms = self.terms
        if not fades(shape):
            terms = tuple(one for one in terms if (one.kind, one.channel) != (DAMPED, channel))
        return replace(self, terms=terms, shapes=tuple(sorted(shapes.items())))

    def has(self, kind: str, channel: str | None = None) -> bool:
        """Return whether there is a term of a kind, in a channel or in any."""
        return any(
            one.kind == kind and (channel is None or one.channel == channel) for one in self.terms
        )

    @property
    def free(self) -> tuple[Term, ...]:
        """Return the terms that are not of the mechanism."""
        return tuple(one for one in self.terms if one.kind not in GIVEN)

    @property
    def faults(self) -> tuple[Term, ...]:
        """Return the terms that accuse the rig or the measurement."""
        return tuple(one for one in self.terms if TERMS[one.kind].fault)

    def forgetting(self, channel: str) -> "Structure":
        """Return the structure without the memories of a channel.

        A level that differs between directions is an offset then, unless it grows with a load.
        """
        kept = []
        loaded = self.has("load", channel)
        for one in self.terms:
            if one.channel == channel and one.kind == "level_dir" and not loaded:
                kept.append(replace(one, kind="offset"))
            elif one.channel != channel or one.kind != "second":
                kept.append(one)
        return Structure((), self.shapes).having(*kept).shaped(channel, SIGN)

    @property
    def cost(self) -> float:
        """Return how unusual the structure is: the ranks of what it is made of.

        A nonlinear parameter counts a little, so that drag is more usual than a power of 2.
        """
        shapes = sum(2 * (len(shape) - 1) for _, shape in self.memories)
        terms = sum(TERMS[one.kind].rank + 1 + PARAMETER * len(one.par) for one in self.terms)
        return shapes + terms

    @property
    def late(self) -> tuple[float, float, float]:
        """Return how late the force channel shows a force.

        By a delay [s], through a filter of a time constant [s], and later by so much per second.
        """
        delay, lag, skew = (
            sum(one.par[0] for one in self.terms if one.kind == kind) for kind in SHOWN_LATE
        )
        return delay, lag, skew

    @property
    def family(self) -> Family:
        """Return what structures with the same terms and memories share, whatever their values."""
        kinds = tuple(sorted((one.kind, one.channel, one.what) for one in self.terms))
        return kinds, tuple((channel, len(shape)) for channel, shape in self.memories)

    @property
    def complete(self) -> bool:
        """Return whether every term has the one that it modifies, or that it stands beside."""
        return not any(
            (one.kind in DRIVEN and not self.has("inertia", one.channel))
            or (
                self.shape(one.channel) == SIGN
                and (
                    one.kind == "second"
                    or (one.kind == "level_dir" and not self.has("load", one.channel))
                )
            )
            or (one.kind == DAMPED and not fades(self.shape(one.channel)))
            or (one.kind in GROWN and not self.has(GROWN[one.kind], one.channel))
            # after a reversal a level is missing in a gap and in presliding alike
            or (one.kind == "backlash" and self.shape(one.channel) != SIGN)
            or (
                one.kind in CARRIED
                and not self.has("level", one.channel)
                and not self.has("load", one.channel)
            )
            for one in self.terms
        )

    def clashes(self, term: Term) -> bool:
        """Return whether a term of the same kind stands in the same channel already.

        An offset and a level that differs between directions are one in all but presliding.
        """
        alike = next((kinds for kinds in (SHIFTS, GEARS) if term.kind in kinds), None)
        return any(
            one.channel == term.channel
            and (one.kind in alike if alike else (one.kind, one.what) == (term.kind, term.what))
            for one in self.terms
        )

    @override
    def __str__(self) -> str:
        """Return the terms and memories in words."""
        text = " + ".join(str(one) for one in self.terms)
        for channel, shape in self.memories:
            where = f"{channel} " if channel else ""
            text += f" | {where}memory of {number(shape[0])}, exponent {number(shape[1], 2)}"
            if len(shape) == 5:
                text += f", Stribeck velocity {number(shape[2])}, step {number(shape[3], 2)}"
        return text
