"""Columns of a record: what their names say of quantities and units, and how they are to be read.

Words and units in names speak for a quantity, or against it. How a column is read is said alike in
Python, by options and in rig files.
"""

import itertools
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, Literal, TypeAlias

from stickslip.data import measurement
from stickslip.data.readers.layout import Layout, Repair, repairs
from stickslip.data.readers.toml import packaged
from stickslip.data.tolerances import LONGEST_NAME
from stickslip.data.units import read_gain
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.mechanisms import PREFIX, Mechanism, canonical_path, motor_of
from stickslip.quantities import Quantity
from stickslip.units import is_of, shown

# The vocabulary of columns: what they are called, in which units they are, and what words mean.


@dataclass(frozen=True, kw_only=True)
class Meaning:
    """What columns of a quantity are called, and in which units they are."""

    names: tuple[str, ...]
    """Names in English and German, umlauts written out."""
    plain: tuple[str, ...] = ()
    """Names by which the quantity is known wherever nothing else is called like it."""
    units: tuple[str, ...] = ()
    """Kinds of units in SI, of a motion along a line first; what is beside a motion has its own."""
    sensitivity: tuple[str, ...] = ()
    """Assumed of a channel in volts, of a motion along a line and about an axis."""


_FILE: Final = packaged("words.toml")


def _words(given: Iterable[str]) -> tuple[str, ...]:
    """Return words, those of the lists that are referred to in their place."""
    lists = ((word,) if word[0] != "@" else _words(_FILE["words"][word[1:]]) for word in given)
    return tuple(itertools.chain.from_iterable(lists))


VOCABULARY: Final[Mapping[str, Meaning]] = {
    quantity: Meaning(**{what: _words(words) for what, words in meaning.items()})
    for quantity, meaning in _FILE["quantities"].items()
}
"""Columns by the quantity that they hold."""
WORDS: Final = {what: _words(words) for what, words in _FILE["words"].items()}
"""Words in the names of columns by what they say."""
_UNKNOWN: Final = Meaning(names=())


def meaning_of(quantity: str) -> Meaning:
    """Return the names and units of a quantity; none of what is no quantity."""
    return VOCABULARY.get(quantity, _UNKNOWN)


GUESSED: Final = tuple(VOCABULARY)[:8]
"""Quantities whose column is sought by its name, unit and numbers."""
INPUTS: Final = ("pressure", "transmitted", "motor", "external", "gravity")
"""What friction may depend on, beside a temperature."""
MOTION: Final = ("position", "velocity", "reference")
"""Quantities of a motion."""

_PLUS_MINUS: Final = re.compile(r"(?:±|\+/?[-−])(?!\s*\d)")  # before digits it is a range
_HALF_WIDTH: Final = re.compile(
    r"(?i)(?<![\d.,])95\s*%|(?:^|[\W_])(?:ci|ki|conf|u)[ _]?95(?!\d)|(?<!\d)95[ _]?ci(?![^\W_])"
)
_WRITTEN_OUT: Final = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss"})


def is_voltage(name: str) -> bool:
    """Return whether a column is called a voltage.

    Examples
    --------
    >>> [is_voltage(name) for name in ("Motorspannung", "ctrl_V", "V", "v", "velocity")]
    [True, True, True, False, False]
    """
    last = re.split(r"[\W_]", name)[-1]
    return any(word in name.casefold() for word in WORDS["voltage"]) or last in WORDS["volts"]


def parts_of(name: str) -> list[str]:
    """Return the words in a name, umlauts written out."""
    name = _PLUS_MINUS.sub(" plusminus ", name)
    spaced = re.sub(r"(?<=[a-zäöüß])(?=[A-Z])", " ", name).casefold().translate(_WRITTEN_OUT)
    return [part for part in re.split(r"[\W\d_]+", spaced) if part]


def is_wanted(parts: Sequence[str]) -> bool:
    """Whether words are those of a wanted value."""
    joined = "".join(parts)
    return any(part in WORDS["wanted"] for part in parts) or any(
        joined.startswith(word) or joined.endswith(f"{word}wert") for word in WORDS["wanted"]
    )


def is_barred(parts: Sequence[str], quantity: str) -> bool:
    """Whether the words of a name are those of an error, a condition or wear, not of a quantity.

    Examples
    --------
    >>> is_barred(parts_of("pid.jointEr.position"), "position")
    True
    >>> [is_barred(parts_of("force amplitude"), q) for q in ("position", "force")]
    [True, False]
    """
    if quantity in MOTION and any(
        part.startswith(("dd", *WORDS["accelerations"])) for part in parts
    ):
        return True
    if any(
        part in WORDS["other words"] or (quantity in MOTION and part in WORDS["no motion"])
        for part in parts
    ):
        return True
    if any(
        part.startswith(WORDS["other"]) or part.endswith((*WORDS["other"], "err")) for part in parts
    ):
        return True  # poserr
    return bool(parts) and parts[-1].endswith(WORDS["last"])


def is_half_width(header: str) -> bool:
    """Whether a column of uncertainties says that they are half-widths of intervals of 95 %.

    Examples
    --------
    >>> [is_half_width(name) for name in ("F ci95 (N)", "CI 95 %", "error (95 %)", "sd (N)")]
    [True, True, True, False]
    """
    return _HALF_WIDTH.search(header) is not None


def doubted(name: str) -> list[str] | None:
    """Return what a name says beside that it is an uncertainty; None if it is that of none.

    Examples
    --------
    >>> [doubted(name) for name in ("sd", "F ±", "Messfehler Kraft", "tracking error", "force")]
    [[], ['f'], ['kraft'], ['tracking'], None]
    """
    parts = parts_of(name)
    cut = [re.sub(f"(?:{'|'.join(WORDS['doubting'])})$", "", part) for part in parts]
    said = cut != parts or {*parts} & {*WORDS["doubts"]}
    if not is_half_width(name) and ({*parts} & {*WORDS["confidence"]} or not said):
        return None
    return [
        part
        for part in cut
        if part and part not in (*WORDS["doubts"], *WORDS["confidence"], *WORDS["of doubts"])
    ]


# Units that stand in the names of columns, and the kinds of units that a quantity has.

SURE_STYLES: Final = (
    re.compile(r"(?P<name>.*?)\s*[\[(<{](?P<unit>[^\[\]()<>{}]+)[\])>}]\s*"),
    re.compile(r"(?P<name>.+?)\s+in\s+(?P<unit>\S.*)"),
    re.compile(r"(?P<name>.+?)\s*/\s*(?P<unit>\S.*)"),
)
"""How headers carry units, whatever these are: Weg [mm], Weg (mm), Weg in mm, Weg / mm."""
STYLES: Final = (
    *SURE_STYLES,
    re.compile(r"[\[(<{](?P<unit>[^\[\]()<>{}]+)[\])>}]\s*(?P<name>.+)"),
    re.compile(r"(?P<name>[^\[(]+?)\s*[\[(](?P<unit>[^\[\](),;]+)[\]),;].+"),
    re.compile(r"(?P<name>.+)[_ ,.;:-](?P<unit>[^\s_]+)"),
)
"""... and where it may be any other word: [mm] Weg, Weg [mm] roh, Weg_mm."""


def is_unit_of(unit: str, quantity: str) -> bool:
    """Whether a unit is of a kind that a quantity has.

    Examples
    --------
    >>> is_unit_of("rpm", "velocity"), is_unit_of("1/min", "velocity"), is_unit_of("V", "velocity")
    (True, True, False)
    """
    return any(is_of(unit, kind) for kind in _kinds(quantity))


def _kinds(quantity: str) -> tuple[str, ...]:
    first = quantity.partition(".")[0]
    if units := meaning_of(first).units:
        return units
    if measurement.is_beside(quantity):
        return (measurement.unit_of_input(first), measurement.unit_of_input(first, turning=True))
    known = measurement.QUANTITIES.get(first)
    return () if known is None else tuple(filter(None, (known.unit, known.or_unit)))


def stated_unit(header: str, quantity: str) -> str | None:
    """Return the unit that the header of a quantity's column carries, if it is one of its kind.

    Examples
    --------
    >>> stated_unit("Velocity (mm/s)", "velocity"), stated_unit("Velocity (raw)", "velocity")
    ('mm/s', None)
    """
    result = _surely(header)
    return next(
        (hit["unit"].strip() for hit in result if is_unit_of(hit["unit"].strip(), quantity)), None
    )


def without_unit(header: str) -> str:
    """Return a header without the unit in brackets, or behind a slash, that ends it.

    Examples
    --------
    >>> without_unit("Velocity (mm/s)"), without_unit("Weg / mm"), without_unit("Weg")
    ('Velocity', 'Weg', 'Weg')
    """
    return next((hit["name"].strip() for hit in _surely(header)), header.strip())


def _surely(header: str) -> list[re.Match[str]]:
    if len(header) > LONGEST_NAME:
        return []
    return [hit for style in SURE_STYLES if (hit := style.fullmatch(header))]


# How the files of a measurement are read, and how that is said: in Python, by options, in rigs.

Speaker: TypeAlias = Literal["python", "options", "rig"]
"""Who says how files are read: a call, the options of a command, or a rig file."""

_SETTING: Final = re.compile(
    r"""\b(?P<setting>columns|units|gain|repair|conditions)=
        (?:"(?P<word>\w+)"|\{"(?P<name>[\w.]+)":\ (?P<value>"[^"]*"|\[[^\]]*\]|[^"}]+)\})""",
    re.VERBOSE,
)
MOTOR_KEY: Final = "motor_constant = "
_OPTIONS: Final = {"units": "unit"}
"""Options that are called otherwise."""


def spelled(text: str, by: Speaker) -> str:
    """Return a message with the settings that it names as they are given there.

    Examples
    --------
    >>> said = 'Give columns={"position": "..."} and repair="sort".'
    >>> spelled(said, "options")
    'Give --columns position=... and --repair sort.'
    >>> spelled(said, "rig")
    'Give columns = { position = "..." } and repair = ["sort"].'
    """
    if by == "python":
        return text
    text = text.replace("motor_constant=", "--motor-constant " if by == "options" else MOTOR_KEY)
    text = text.replace('columns={"time": "50 Hz"}', "--rate 50Hz") if by == "options" else text
    return _SETTING.sub(_option if by == "options" else _key, text)


def _option(found: re.Match[str]) -> str:
    setting = _OPTIONS.get(found["setting"], found["setting"])
    if found["word"]:
        return f"--{setting} {found['word']}"
    value = ",".join(part.strip(' "') for part in found["value"].strip("[]").split(","))
    pair = f"{found['name']}={value}"
    return f'--{setting} "{pair}"' if " " in pair else f"--{setting} {pair}"


def _key(found: re.Match[str]) -> str:
    if found["word"]:
        return f'{found["setting"]} = ["{found["word"]}"]'
    return f"{found['setting']} = {{ {found['name']} = {found['value']} }}"


Column: TypeAlias = str | tuple[str, str]
"""Name of a column, or of the two with a position in a plane."""
PAIR: Final = (list, tuple)
OF_TRIALS = ("uncertainty", "uncertainty_kind", "name", "provenance")
"""What else a table of trials may have."""
MOTORS = {
    "current": "newtons per ampere (of the motor's constant and its gears; N m/A of a joint that"
    " turns)",
    "voltage": "newtons per volt (of the amplifier and its motor)",
    "torque": "the factor to the mechanism's unit, 1 if the mechanism is in radians",
}
"""What drives a rig but is no quantity of its own, and what its gain is."""


def motor_constants(given: Any) -> dict[str, float | str]:
    """Return motor constants by current: newtons or newton metres per ampere.

    Examples
    --------
    >>> motor_constants("12 Ncm/A"), motor_constants({"elbow": 0.12}), motor_constants("0.12")
    ({'current': '12 Ncm/A'}, {'current.elbow': 0.12}, {'current': 0.12})
    """
    constants = given if isinstance(given, Mapping) else {"current": given}
    result: dict[str, float | str] = {}
    for name, value in constants.items():
        key = name if name.partition(".")[0] == "current" else f"current.{name}"
        quantity = Quantity("K_m", "N/A", or_unit="N m/A")
        label = f"motor_constant ({quantity.symbol}) of {key}"
        try:
            constant = read_gain(value) if isinstance(value, str) else value
            number = quantity.check("", "", constant)
            result[key] = constant if isinstance(constant, str) else number
        except ParameterError:
            number = 0.0
        if number == 0.0:
            raise ParameterError(
                f"{label} must be a number other than 0 in N/A or N m/A, or text with a unit such"
                f' as "0.12 N m/A", got {shown(value)}.'
            )
    return result


def column_of(quantity: str, given: Any) -> Column:
    """Return the name of the column that holds a quantity, or the two names of a position.

    Examples
    --------
    >>> column_of("force", "u"), column_of("position", ["x", "y"])
    ('u', ('x', 'y'))
    """
    if isinstance(given, str):
        return given
    if quantity == measurement.STATED and isinstance(given, float | int):
        return str(given)
    names = [name for name in given if isinstance(name, str)] if isinstance(given, PAIR) else []
    if quantity == "position" and len(set(names)) == 2 == len(given):
        return (names[0], names[1])
    plane = " or two different names, for the two coordinates of a position in a plane,"
    raise InputError(
        f"columns.{quantity} must be the name of one column,{plane * (quantity == 'position')}"
        f" got {shown(given)}."
    )


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How files are read; arguments as in `load_measurement`.

    Examples
    --------
    >>> rig = Reading(columns={"position": "q"}, gain={"force": 35.15})
    >>> rig.with_changes(Reading(columns={"force": "u"})).columns
    {'position': 'q', 'force': 'u'}
    """

    columns: Mapping[str, Column] = field(default_factory=dict)
    """Quantity -> name of its column; two names for a position along a line in a plane."""
    units: Mapping[str, str] = field(default_factory=dict)
    """Quantity -> unit of its column."""
    gain: Mapping[str, float | str] = field(default_factory=dict)
    """Quantity -> factor, as in `load_measurement`."""
    offset: Mapping[str, float] = field(default_factory=dict)
    """Quantity -> offset of its sensor, in SI."""
    repair: tuple[Repair, ...] = ()
    """What is repaired."""
    motor_constant: Mapping[str, float | str] = field(default_factory=dict)
    """Current -> newtons or newton metres per ampere, as a number or with its unit; by joint as
    ``current.elbow``."""
    layout: Layout | None = None
    """How a text file holds its table; found out if not given."""
    conditions: tuple[str, ...] = ()
    """Columns that hold a condition of the trial, one value in each."""
    rotary: bool | None = None
    """Whether the rig is stated to be rotary (True) or linear (False), as units then have to be."""
    by: Speaker = field(default="python", compare=False)
    """Who said so, and is to be told in the same spelling what else to say."""

    def __post_init__(self) -> None:
        """Check columns and what is to be repaired."""
        columns = {name: column_of(name, given) for name, given in self.columns.items()}
        object.__setattr__(self, "columns", columns)
        object.__setattr__(self, "repair", repairs(self.repair))
        object.__setattr__(self, "motor_constant", motor_constants(self.motor_constant))
        object.__setattr__(self, "conditions", tuple(dict.fromkeys(self.conditions)))

    def with_changes(self, other: "Reading") -> "Reading":
        """Return this one with what another one says in addition or instead."""
        tables = ("columns", "units", "gain", "offset", "motor_constant")
        return Reading(
            **{name: {**getattr(self, name), **getattr(other, name)} for name in tables},
            repair=self.repair + other.repair,
            layout=other.layout or self.layout,
            conditions=self.conditions + other.conditions,
            rotary=self.rotary if other.rotary is None else other.rotary,
            by=self.by if other.by == "python" else other.by,
        )


def check_columns(
    names: Iterable[str], mechanism: Mechanism | None = None, currents: Collection[str] = ()
) -> None:
    """Check that each key of ``columns`` is a quantity or a path: a typo would drop its column.

    Examples
    --------
    >>> check_columns(["time", "position.elbow", "mechanism.compression", "initial.x"])
    >>> check_columns(["positon"])
    Traceback (most recent call last):
    stickslip.errors.UnknownNameError: unknown quantity in columns 'positon'. Did you mean ...
    """
    electric = () if motor_of(mechanism) else measurement.ELECTRIC
    quantities = (name for name in measurement.QUANTITIES if name not in electric)
    known = ("time", *quantities, *measurement.BESIDE, *OF_TRIALS, "trial", measurement.STATED)
    for name in names:
        first, _, rest = str(name).partition(".")
        if name in (*known, *currents) or (
            rest and first in ("initial", PREFIX, *measurement.BY_JOINT, *measurement.BESIDE)
        ):
            continue
        if first in MOTORS:
            force = f"force.{rest}" if rest else "force"
            raise InputError(
                f"columns: {name} is not a quantity of a measurement, but a force with a gain:"
                f" give its column as {force}, and as gain of {force} {MOTORS[first]}"
                + (', or give motor_constant="0.12 N m/A".' if first == "current" else ".")
            )
        if mechanism is not None and _is_path(mechanism, str(name)):
            continue
        raise UnknownNameError("quantity in columns", name, known)


def _is_path(mechanism: Mechanism, name: str) -> bool:
    """Whether a plain last name stands for a parameter of a mechanism."""
    try:
        canonical_path(mechanism, name)
    except UnknownNameError:
        return False
    return True
