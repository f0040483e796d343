"""What is exported: a law as equations and as a program, and what targets make of it.

1. The law is evaluated with symbols in place of its parameters, once for each sense of slip and
   once at rest, as solvers do: conditions that `where` decides become branches.
2. Its functions are a program as data: assignments, branches and calls, in names that C, MATLAB and
   tools of Modelica, which import FMUs, accept alike. Languages print it.
3. A subject is the law with all that is known of it; a target turns a subject into files.
"""

import re
import unicodedata
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any, ClassVar, Final, TypeAlias

import symengine as se

from stickslip.data import LawEstimates, Levels, Rig
from stickslip.engine.formulation import Switchboard, Traced, collapsed, expression
from stickslip.errors import InputError, TracingError
from stickslip.friction import FrictionLaw, bound
from stickslip.identify.fits import inputs_text
from stickslip.maths import Latches
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, parameters, shadow, turned
from stickslip.show.documents import unwritable, write_files
from stickslip.show.formatting import parameter_words, printable

# Names that programs of other languages accept, from symbols and titles of any spelling.

LONGEST_NAME: Final = 40
"""Characters of a name; MATLAB takes 63, of which a function's own suffix needs some."""
TEMPORARY: Final = re.compile(r"[csx]\d+")
"""Names of temporaries and of switches, which no symbol may have."""
RESERVED: Final = frozenset(
    """
    algorithm alignas alignof and annotation asm assert auto block bool boolean break case catch
    char class classdef complex connect connector const constant constexpr constrainedby
    continue decltype default delete der discrete do double each else elseif elsewhen
    encapsulated end enum equation eval expandable explicit export extends extern external false
    final float flow for friend function global goto if import imaginary impure in initial
    inline inner input int integer loop long model mutable namespace new noexcept not nullptr
    operator or otherwise outer output package parallel parfor partial persistent pre private
    protected public pure real record redeclare reinit register replaceable restrict return
    sample short signed sizeof spmd static string struct stream switch template terminal
    terminate then this throw time true try type typedef typeid typename typeof union unsigned
    unwind_protect using virtual void volatile when while within xor abs acos asin atan ceil cos
    cosh erf exp fabs floor fmax fmin gamma hypot isnan isinf j0 j1 jn lgamma log log10 max min
    mod pi pow rem round sign sin sinh sqrt tan tanh tgamma trunc y0 y1 yn ans eps i inf j nan
    nargin nargout NaN Inf NAN INFINITY HUGE_VAL NULL EOF I errno linux unix Boolean Integer
    Real String
    """.split()  # noqa: SIM905  # a list of texts would have a page of quotes
)
"""Words of C, C++, MATLAB and Modelica, and functions and constants that every file of them has."""


def identifier(text: str) -> str:
    """Return a text as a name of letters, digits and underscores that begins with a letter.

    Examples
    --------
    >>> [identifier(text) for text in ("mu_+", "σ_0", "my axis", "2nd joint", "double", "c1")]
    ['mu_plus', 'sigma_0', 'my_axis', 'p_2nd_joint', 'double_', 'c1_']
    """
    spelt = "".join(_spelt(character) for character in text.replace("+", "plus"))
    spelt = re.sub(r"-$", "minus", spelt.strip()).replace("'", "_prime")
    name = re.sub(r"\W+", "_", spelt, flags=re.ASCII).strip("_")[:LONGEST_NAME].rstrip("_") or "p"
    name = name if name[0].isalpha() else f"p_{name}"
    return f"{name}_" if name in RESERVED or TEMPORARY.fullmatch(name) else name


def identifiers(texts: Sequence[str], taken: Collection[str] = ()) -> tuple[str, ...]:
    """Return names of texts that differ from one another and from those that are taken.

    Examples
    --------
    >>> identifiers(["v", "mu", "mu'", "mu_prime"], taken=["v"])
    ('v_2', 'mu', 'mu_prime', 'mu_prime_2')
    """
    known = set(taken)
    result = []
    for text in texts:
        first = name = identifier(text)
        count = 1
        while name in known:
            count += 1
            name = f"{first}_{count}"
        known.add(name)
        result.append(name)
    return tuple(result)


def _spelt(character: str) -> str:
    """Return a Greek letter by its name, and others without their accent."""
    if character.isascii():
        return character
    words = unicodedata.name(character, "").split()
    if words[:1] == ["GREEK"] and "LETTER" in words:
        name = words[words.index("LETTER") + 1].lower().replace("lamda", "lambda")
        return name if "SMALL" in words else name.capitalize()
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return plain or "_"


# The equations of a law with its parameters as symbols, one expression for each sense of slip.

Values: TypeAlias = tuple[se.Expr, ...]

LOCAL: Final = (
    "velocity", "load", "force", "applied", "mass", "period", "direction", "speed", "width",
    "factor", "normal", "displacement", "friction", "sticks", "steady", "level", "velocity_end",
    "speed_end", "share", "used", "rest", "sense", "pivot", "ahead", "back", "rates",
    "break_away", "step", "slide", "departure", "compensation", "slip", "x", "v", "along",
    "v_start", "force_v", "speed_mid", "first_v", "second_v", "rate", "drop", "low", "miss",
    "miss_low", "tried", "miss_tried", "scale", "shift", "turn", "settle", "implicit", "inertia",
    "torque", "each",
)  # fmt: skip
"""Names that programs use themselves."""
OF_BRISTLES: Final = ("{}_end", "{}_rate")
"""Names that they make of each bristle state."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter of a law in programs."""

    name: str
    """Name of the field."""
    identifier: str
    """Name in programs."""
    quantity: Quantity
    """Symbol and unit."""
    value: float
    """Value [SI]."""


@dataclass(frozen=True, kw_only=True)
class BySense:
    """What holds in forward slip, in backward slip and at rest."""

    ahead: Values
    """At velocities above 0."""
    back: Values
    """At velocities below 0."""
    rest: Values
    """At velocity 0."""


@dataclass(frozen=True, kw_only=True)
class Equations:
    """A law as expressions of the symbols `velocity`, `load`, its bristles and its parameters."""

    parameters: tuple[Parameter, ...]
    """Those that stand in the equations."""
    bristles: tuple[str, ...]
    """Names of the bristle states in programs."""
    flags: tuple[str, ...]
    """Names of what tells whether latched switches are on, 1 or 0."""
    inputs: Mapping[str, str]
    """Contact inputs by their names in programs."""
    slip: BySense
    """Friction force, then the rates of the bristles."""
    moved: BySense | None
    """Bristles after a `period` at a velocity, of laws that have a formula for them."""
    steady: BySense | None
    """Friction force of steady sliding, of laws with bristles."""
    break_away: tuple[se.Expr, se.Expr]
    """Levels that rest gives way to, forward and backward."""
    holds: bool
    """Whether a body is held at rest by a force of any size up to break-away."""
    drops: bool
    """Whether the force falls at once where a bristle gives way."""


VELOCITY, LOAD, PERIOD = map(se.Symbol, ("velocity", "load", "period"))


def equations_of(law: FrictionLaw) -> Equations:
    """Return the equations of a law, whoever wrote it.

    Examples
    --------
    >>> from stickslip import CoulombViscous
    >>> found = equations_of(CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=3.0))
    >>> found.slip.ahead, found.slip.back, found.slip.rest
    ((load*mu_k + sigma_2*velocity,), (-(load*mu_k - sigma_2*velocity),), (0,))
    """
    if not isinstance(law, FrictionLaw):
        raise InputError(
            f"{law!r} is no friction law that can be exported: give one such as Coulomb(...), a"
            " fit, a verdict, or a rig with one law."
        )
    result = list(parameters(law, "friction"))
    # In this order: what comes later steps out of the way of names that are taken.
    states = identifiers((*law.states, *_flags(law)), LOCAL)
    own = identifiers(law.inputs, (*LOCAL, *states))
    inputs = dict(zip(own, law.inputs, strict=True))
    taken = (*LOCAL, *states, *inputs, *(form.format(z) for z in states for form in OF_BRISTLES))
    names = identifiers([quantity.symbol for _, quantity, _ in result], taken)
    symbols = {path: name for (path, _, _), name in zip(result, names, strict=True)}

    def traced(board: Switchboard) -> FrictionLaw:
        twin = shadow(law, "friction", lambda path: Traced(se.Symbol(symbols[path]), board))
        return bound(twin, {key: Traced(se.Symbol(name), board) for name, key in inputs.items()})

    try:
        return Equations(
            parameters=tuple(
                Parameter(
                    name=path.removeprefix("friction."),
                    identifier=symbols[path],
                    quantity=quantity,
                    value=float(value),
                )
                for path, quantity, value in result
            ),
            bristles=states[: len(law.states)],
            flags=states[len(law.states) :],
            inputs=inputs,
            slip=_by_sense(traced, states, _slip),
            moved=_by_sense(traced, states, _moved) if _has_formula(law) else None,
            steady=_by_sense(traced, states, lambda twin, v, load, _: (twin.steady(v[0], load),))
            if law.states
            else None,
            break_away=_levels(traced),
            holds=law.holds,
            drops=law.made_of is not None and law.made_of.drops,
        )
    except TracingError as error:
        raise InputError(
            f"{type(law).__name__} cannot be exported: {error}. See 'Write your own friction law'."
        ) from error


At: TypeAlias = tuple[Any, Switchboard]
"""A velocity, and what collects the switches of its sense."""


def _slip(law: Any, at: At, load: Traced, states: tuple[Traced, ...]) -> tuple[Any, ...]:
    arguments = at[0], load, states
    return (law.force(*arguments), *law.rates(*arguments))


def _moved(law: Any, at: At, load: Traced, states: tuple[Traced, ...]) -> tuple[Any, ...]:
    """Return the states after a period, and whether each latched switch is on then."""
    result = law.moved(at[0], load, states, Traced(PERIOD, at[1]))
    after = (
        se.Piecewise((se.Integer(1), at[1].deciding(switch) > 0), (se.Integer(0), True))
        for switch in at[1].switches.values()
        if switch.hold is not None
    )
    return (*result, *(Traced(value, at[1]) for value in after))


def _has_formula(law: FrictionLaw) -> bool:
    # Any state tells whether there is a formula.
    with Latches():
        return _told(law).moved(0.0, 1.0, (0.0,) * len(law.states), 1.0) is not None


def _told(law: FrictionLaw) -> FrictionLaw:
    """Return a law that can be asked for its switches, whatever its contact inputs are."""
    return bound(law, dict.fromkeys(law.inputs, 1.0))


def _flags(law: FrictionLaw) -> tuple[str, ...]:
    """Return names of the latched switches of the rates of a law."""
    latches = Latches()
    with latches:
        _told(law).rates(1.0, 1.0, (0.0,) * len(law.states))
    if latches and (law.holds or not _has_formula(law)):
        raise InputError(
            f"{type(law).__name__} cannot be exported: it has latched switches, which exports"
            " follow with a formula for constant velocity and without static_switch. An FMU of the"
            " rig does: --to fmu."
        )
    return tuple(f"slips{i + 1}" for i in range(len(latches.flags)))


TracedLaw: TypeAlias = Callable[[Switchboard], FrictionLaw]
"""Makes a law of symbols, whose switches are collected."""


def _by_sense(
    law: TracedLaw,
    states: tuple[str, ...],
    evaluate: Callable[[Any, At, Traced, tuple[Traced, ...]], tuple[Any, ...]],
) -> BySense:
    """Evaluate a law in both senses of slip and at rest, where no latched switch is on."""

    def traced(sense: int) -> Values:
        # Signs of the velocity are known in each sense, and decide its switches.
        board = Switchboard(signs={"velocity": sense} if sense else {})
        velocity = Traced(VELOCITY, board) if sense else 0.0
        twin = law(board)
        count = len(twin.states)
        z = tuple(Traced(se.Symbol(name), board) for name in states[:count])
        values = evaluate(twin, (velocity, board), Traced(LOAD, board), z)
        # At rest no latch is on: its flag is 0, and not a symbol.
        flags = [se.Symbol(name) if sense else se.Integer(0) for name in states[count:]]
        return tuple(_closed(expression(value), board, flags) for value in values)

    return BySense(ahead=traced(1), back=traced(-1), rest=traced(0))


def _levels(law: TracedLaw) -> tuple[se.Expr, se.Expr]:
    board = Switchboard()
    load = Traced(LOAD, board)
    ahead, back = (law(board).towards(side).break_away(load) for side in (1, -1))
    return _closed(expression(ahead), board), _closed(expression(back), board)


def _closed(e: se.Expr, board: Switchboard, flags: Sequence[se.Expr] = ()) -> se.Expr:
    """Put the margins of switches in place of their symbols; a margin may have switches too.

    In place of those of latched ones stand their flags, in their order.
    """
    latched = [switch.symbol for switch in board.switches.values() if switch.hold is not None]
    return collapsed(board.settled(e).subs(dict(zip(latched, flags, strict=False))))


# A program as data: functions of assignments, branches and calls, which languages print.


@dataclass(frozen=True, kw_only=True)
class Variable:
    """An argument or a result of a function."""

    name: str
    """Its name, which all languages accept."""
    unit: str
    """SI unit; empty for a sense or a truth value."""
    meaning: str
    """What it is, in words."""
    positive: bool = False
    """Whether nothing but a number above 0 makes sense."""


@dataclass(frozen=True, kw_only=True)
class Constant:
    """A parameter of a law in a program."""

    name: str
    """Its name, which all languages accept."""
    value: float
    """Value [SI]."""
    unit: str
    """SI unit."""
    meaning: str
    """Name of the field, and how well the value is known."""


@dataclass(frozen=True)
class Assign:
    """Gives names the values of expressions, which share what they have in common."""

    names: tuple[str, ...]
    """Names, in the order of the values."""
    values: tuple[se.Expr, ...]
    """Their values, none of which contains one of the names after the first."""


@dataclass(frozen=True)
class Call:
    """Gives names the results of another function of the program."""

    names: tuple[str, ...]
    """Names, in the order of the results."""
    function: str
    """Name of the function."""
    arguments: tuple[se.Expr, ...]
    """What it is called with."""


@dataclass(frozen=True)
class Branch:
    """Statements for where one value is below another, and for elsewhere."""

    left: se.Expr
    """The smaller value."""
    right: se.Expr
    """The larger value."""
    yes: tuple["Statement", ...]
    """Where `left` is below `right`."""
    no: tuple["Statement", ...] = ()
    """Elsewhere."""


@dataclass(frozen=True)
class Repeat:
    """Statements that are repeated so many times, or until `Leave`."""

    times: int
    """Most repetitions."""
    body: tuple["Statement", ...]
    """The statements."""


@dataclass(frozen=True)
class Leave:
    """Ends the innermost `Repeat`."""


Statement: TypeAlias = Assign | Branch | Call | Repeat | Leave


@dataclass(frozen=True, kw_only=True)
class Function:
    """A function of a program."""

    name: str
    """Its name without that of the program."""
    summary: str
    """What it returns, in a sentence."""
    inputs: tuple[Variable, ...]
    """Its arguments."""
    outputs: tuple[Variable, ...]
    """Its results."""
    body: tuple[Statement, ...]
    """What it does."""
    inner: bool = False
    """Whether other functions of the program alone call it, with arguments that they checked."""


def floored(name: str, value: se.Expr) -> tuple[Statement, ...]:
    """Return the assignment of a value, or of 0 where it is negative."""
    zero = se.Integer(0)
    below = Branch(se.Symbol(name), zero, (Assign((name,), (zero,)),))
    return Assign((name,), (value,)), below


def renamed(body: tuple[Statement, ...], names: Mapping[str, str]) -> tuple[Statement, ...]:
    """Return statements with other names of variables."""
    symbols = {se.Symbol(old): se.Symbol(new) for old, new in names.items()}

    def called_by(old: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(names.get(name, name) for name in old)

    def in_new(values: tuple[se.Expr, ...]) -> tuple[se.Expr, ...]:
        return tuple(se.sympify(value).subs(symbols) for value in values)

    def of(step: Statement) -> Statement:
        match step:
            case Assign():
                return Assign(called_by(step.names), in_new(step.values))
            case Call():
                return Call(called_by(step.names), step.function, in_new(step.arguments))
            case Branch():
                left, right = in_new((step.left, step.right))
                return Branch(left, right, renamed(step.yes, names), renamed(step.no, names))
            case Repeat():
                return Repeat(step.times, renamed(step.body, names))
            case Leave():
                return step

    return tuple(map(of, body))


def _inside(statement: Statement) -> tuple[Statement, ...]:
    """Return the statements that a statement holds."""
    if isinstance(statement, Branch):
        return (*statement.yes, *statement.no)
    return statement.body if isinstance(statement, Repeat) else ()


def assigned(body: tuple[Statement, ...]) -> Iterator[str]:
    """Yield the names that statements assign, in order; one may come twice."""
    for statement in body:
        yield from assigned(_inside(statement))
        if isinstance(statement, Assign | Call):
            yield from statement.names


def called(body: tuple[Statement, ...]) -> Iterator[str]:
    """Yield the names of the functions that statements call."""
    for statement in body:
        yield from called(_inside(statement))
        if isinstance(statement, Call):
            yield statement.function


def used(body: tuple[Statement, ...]) -> set[str]:
    """Return the names that occur in the values, conditions and arguments of statements."""
    names: set[str] = set()
    for statement in body:
        names |= used(_inside(statement))
        values: tuple[se.Expr, ...] = ()
        if isinstance(statement, Assign):
            values = statement.values
        elif isinstance(statement, Branch):
            values = (statement.left, statement.right)
        elif isinstance(statement, Call):
            values = statement.arguments
        names |= {str(symbol) for value in values for symbol in value.free_symbols}
    return names


# What is exported: a law, how well it is known, and where it is from.

LOAD_TEXT: Final = {
    "per load": "Levels are over the normal force: the load is the normal force in N.",
    "torques per load": "Levels are friction torques over the normal force, in N m per N: the load"
    " is the normal force in N.",
    "forces": "Levels are forces in N, because no normal force was known: the load is 1.",
    "torques": "Levels are torques in N m, because no normal force was known: the load is 1.",
}
JOINT_TEXT: Final = {
    "forces": "Levels are forces in N: the load is 1.",
    "torques": "Levels are torques in N m: the load is 1.",
}
"""The same of joints, which no normal force presses together."""


@dataclass(frozen=True, kw_only=True)
class Subject:
    """A law that is exported."""

    law: FrictionLaw
    """The law with its values."""
    name: str
    """Name of the program, which all languages accept."""
    estimates: LawEstimates | None = None
    """How well it is known, if its file says so."""
    mechanism: Mechanism | None = None
    """The mechanism on which it was fitted, if there is one."""
    contact: str = ""
    """Which contact of the mechanism has it, where there are several."""
    rotary: bool = False
    """Whether the contact slips by an angle, so that friction is a torque."""
    levels: Levels = "per load"
    """What levels of the law are."""
    source: str = ""
    """Where it is from, in words; empty if it was given as an object."""
    load: float | None = None
    """Normal force [N] at which tables and joints have their friction, if it is known."""
    at: Mapping[str, float] = field(default_factory=dict)
    """Contact inputs at which they have it, by name."""
    largest_speed: float | None = None
    """End of the range of use [m/s] or [rad/s], if it is known."""
    rig: Rig | None = None
    """A rig on which the effect of a simplification is computed."""
    own_rig: Rig | None = None
    """The rig of the law's file, which stands in for it where a run of it is possible and moves."""

    @cached_property
    def equations(self) -> Equations:
        """The equations of the law."""
        return equations_of(self.law)

    def unit(self, quantity: Quantity) -> str:
        """Return the unit in which a parameter of the law reads."""
        return quantity.unit_at(per_load=self.levels == "per load", turning=self.rotary)

    def constants(self) -> tuple[Constant, ...]:
        """Return the parameters with units and with how well they are known."""
        return tuple(
            Constant(
                name=parameter.identifier,
                value=parameter.value,
                unit=self.unit(parameter.quantity),
                meaning=", ".join(
                    filter(None, (parameter_words(parameter.name), self.known(parameter.name)))
                ),
            )
            for parameter in self.equations.parameters
        )

    def known(self, name: str) -> str:
        """Return how well a parameter is known, in words; empty where nothing is said of it."""
        known = self.estimates
        if known is None:
            return ""
        if name in known.intervals:
            low, high = known.intervals[name]
            return f"{known.interval}: {low:.6g} to {high:.6g}"
        if name in known.not_identified:
            return f"not identified: {printable(known.not_identified[name])}"
        return "not fitted" if name in known.not_fitted else ""

    def header(self) -> Iterator[str]:
        """Yield what every target says of the law, line by line."""
        title, release = printable(self.law.title), version("stickslip")
        yield f"{title} friction ({printable(self.law.name)}), exported by stickslip {release}."
        if self.source:
            yield f"Source: {printable(self.source)}"
        yield f"Law (LaTeX): {printable(self.law.formula)}"
        yield "Parameters in SI units:"
        for constant in self.constants():
            # To the last bit, so that a program has the very law.
            yield f"  {constant.name} = {constant.value!r} [{constant.unit}] ({constant.meaning})"
        ratio = self.levels == "per load"
        if ratio or self.has_normal_force:
            yield LOAD_TEXT["torques per load" if ratio and self.rotary else self.levels]
        else:
            yield JOINT_TEXT[self.levels]
        if self.estimates is not None and self.estimates.largest_speed is not None:
            most = f"{self.estimates.largest_speed:.6g} {turned('m/s', self.rotary)}"
            yield f"Fitted at speeds up to {most}; the law is extrapolated beyond."

    @property
    def has_normal_force(self) -> bool:
        """Whether a normal force presses the contact together, known or not; joints have none."""
        if self.mechanism is None:
            return self.levels != "torques"  # a law itself, of a rotary joint
        return hasattr(self.mechanism, "load")

    @property
    def at_text(self) -> str:
        """The contact inputs at which tables and joints have their friction, in words."""
        return inputs_text(self.at, turning=self.rotary)

    def needed_load(self) -> float:
        """Return the load of tables and joints."""
        if self.load is not None:
            return self.load
        raise InputError(
            "this target has friction at one normal force, and that of the law's mechanism is not"
            ' known: give it, as --load "50 N" (in Python load=50.0).'
        )

    def needed_speed(self) -> float:
        """Return the end of the range of use [m/s] or [rad/s]."""
        if self.largest_speed is not None:
            return self.largest_speed
        unit = turned("m/s", self.rotary)
        raise InputError(
            "this target has friction over a range of speeds, and neither the law's file nor a rig"
            f' says which: give its end, as --largest-speed "0.5 {unit}" (in Python'
            " largest_speed=0.5)."
        )


# What a target is, and what an export gives back.


@dataclass(frozen=True, kw_only=True)
class Export:
    """A law as files of another program.

    Examples
    --------
    >>> from stickslip import Coulomb, export
    >>> export(Coulomb(kinetic_coefficient=0.25), "c")
    <Export c: coulomb.h, coulomb.c>
    """

    target: str
    """Name of the target."""
    files: Mapping[str, str]
    """Texts by file name."""
    remarks: tuple[str, ...] = ()
    """What does not carry over, in sentences."""

    def save(self, folder: str | Path, *, force: bool = False) -> tuple[Path, ...]:
        """Write the files into a folder, all or none."""
        place = Path(folder)
        paths = {place / name: text for name, text in self.files.items()}
        # All paths are looked at before any file is written.
        for path in paths:
            try:
                there = path.exists() or path.is_symlink()
            except OSError as error:
                raise unwritable(path, error) from error
            if there and not force:
                raise InputError(
                    f"{path} already exists; give --force (in Python force=True) to replace it, or"
                    " another folder."
                )
        write_files(paths)
        return tuple(paths)

    def __repr__(self) -> str:
        return f"<Export {self.target}: {', '.join(self.files)}>"


class Target(ABC):
    """A program or format that a law is exported to."""

    name: ClassVar[str]
    """Name of the target on the command line."""
    title: ClassVar[str]
    """What it is, in running text."""
    evaluates: ClassVar[bool] = False
    """Whether the law is evaluated: at one normal force and one value of each contact input."""

    @abstractmethod
    def export(self, subject: Subject) -> Export:
        """Return the files of a law; the same for the same law, whenever they are made."""
