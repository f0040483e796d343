"""The battery: all tests of a law, and of several side by side."""

import dataclasses
import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final, TypeAlias

import numpy as np

from stickslip.errors import InputError, SimulationError, UnknownNameError
from stickslip.friction import FrictionLaw, law_type, with_typical_values
from stickslip.identify.fits import starting_law
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import Quantity, fields_of
from stickslip.show.display import InPanels, Summary
from stickslip.show.formatting import capital, joined, number, unit_text
from stickslip.study.characterization import presliding_tests, sliding_tests
from stickslip.study.characterization.bench import Bench, Characteristic

Given: TypeAlias = FrictionLaw | type[FrictionLaw] | str
"""A law, its type, or its name or composition."""

TESTS: Final[Mapping[str, Callable[[Bench], Characteristic]]] = MappingProxyType(
    {
        "steady": sliding_tests.steady_curve,
        "presliding": presliding_tests.presliding,
        "break-away": presliding_tests.break_away,
        "drift": presliding_tests.drift,
        "passivity": sliding_tests.passivity,
    }
)
"""The tests by name, in the order of pages."""

ROLES = ("kinetic_coefficient", "static_coefficient", "stribeck_velocity", "bristle_stiffness")
"""What several laws have in common: F_c, F_s, v_s and stiffness."""
LOAD = Quantity("N", "N", above=0)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Characterization(InPanels):
    """What the battery says of a law; a test that was not made, or could not be, is None."""

    title: str
    """The law in running text, with the values of its inputs."""
    law: FrictionLaw
    """The law with the parameters that were tried."""
    load: float
    """Normal force [N]."""
    steady: sliding_tests.SteadyCurve | None = None
    """Friction after long sliding."""
    presliding: presliding_tests.Presliding | None = None
    """Loop of small displacements, and its memory."""
    break_away: presliding_tests.BreakAway | None = None
    """Break-away against rate and rest."""
    drift: presliding_tests.Drift | None = None
    """Motion under a ripple below break-away."""
    passivity: sliding_tests.Passivity | None = None
    """Least energy of a cycle."""
    failed: Mapping[str, str] = field(default_factory=dict)
    """Why a test could not be made, by its name."""
    matched: str = ""
    """Which parameters were set to those of the first law, in a sentence."""
    others: tuple["Characterization", ...] = ()
    """The same of the other laws, or of other values of the inputs."""

    @property
    def all(self) -> tuple["Characterization", ...]:
        """The law itself and the others."""
        return (self, *self.others)

    @property
    def results(self) -> Mapping[str, Characteristic]:
        """The tests that were made, by name."""
        found = {name: getattr(self, name.replace("-", "_")) for name in TESTS}
        return {name: value for name, value in found.items() if value is not None}

    @property
    def by_test(self) -> dict[str, dict[str, Characteristic]]:
        """Results of all laws by test, and by the title of the law for each."""
        found: dict[str, dict[str, Characteristic]] = {}
        for law in self.all:
            for name, result in law.results.items():
                found.setdefault(name, {})[law.title] = result
        return found

    def to_dict(self) -> dict[str, Any]:
        """Return laws, sentences and numbers, as in JSON."""
        entry = {
            "law": self.law.name,
            "title": self.title,
            "parameters": {name: getattr(self.law, name) for name in fields_of(type(self.law))},
            "load": self.load,
            "matched": self.matched,
            "tests": {name: result.to_dict() for name, result in self.results.items()},
            "failed": dict(self.failed),
        }
        return {**entry, "others": [other.to_dict() for other in self.others]}

    def _summary(self) -> Summary:
        if self.others:
            head = ["test", *(law.title for law in self.all)]
            names = dict.fromkeys(name for law in self.all for name in law.results)
            rows = [[name, *(law.told(name) for law in self.all)] for name in names]
            return Summary(sentence=f"{len(self.all)} laws side by side.", head=head, rows=rows)
        rows = [[name, self.told(name)] for name in (*self.results, *self.failed)]
        return Summary(sentence=f"{self.title}, normal force {number(self.load)} N.", rows=rows)

    def told(self, test: str) -> str:
        """Return what a test says in a sentence; `failed` has why one could not be made."""
        result = self.results.get(test)
        if result is not None:
            return result.sentence
        return "no result" if test in self.failed else "not made"


def characterize(
    law: Given,
    *others: Given,
    load: float = 1.0,
    rig: Mechanism | None = None,
    tests: Sequence[str] | None = None,
    match: bool = True,
    inputs: Mapping[str, float | Sequence[float]] | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Characterization:
    """Try a law on a battery of tests, or several side by side.

    Parameters
    ----------
    law : FrictionLaw, type or str
        The law; one given by type, name or composition has its typical values.
    *others : FrictionLaw, type or str
        Laws beside it.
    load : float
        Normal force [N].
    rig : Axis, SpringBlock or TowedBlock, optional
        Body whose mass is taken; 1 kg if not given.
    tests : sequence of str, optional
        Names of tests: steady, presliding, break-away, drift, passivity. All if not given.
    match : bool
        Whether the other laws take the levels, the Stribeck velocity and the bristle stiffness of
        the first.
    inputs : mapping of str to float or sequence of float, optional
        Values of the inputs that a law depends on, such as ``{"temperature": (20.0, 40.0)}``: each
        is tried as a law of its own.
    progress : callable, optional
        Called with the number of tests done and of all.

    Returns
    -------
    Characterization
        The results by test, and those of the others.

    Raises
    ------
    InputError
        If an argument cannot be used, or an input of a law has no value.
    UnknownNameError
        If a law or a test is unknown.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=1.5, bristle_stiffness=1e5, viscous_coefficient=0.4)
    >>> found = characterize(law, tests=["drift"])
    >>> found.drift.sentence
    'It drifts: 3.41 mm in 8 s under a load that never reaches break-away.'
    """
    load = LOAD.check("characterize", "load", load)
    chosen = list(TESTS) if tests is None else list(dict.fromkeys(tests))
    for name in chosen:
        if name not in TESTS:
            raise UnknownNameError("test", name, tuple(TESTS))
    if not chosen:
        raise InputError(f"tests must name one of {', '.join(TESTS)}, got none.")
    given = [law_with_values(friction, load) for friction in (law, *others)]
    notes = [""] * len(given)
    # Levels and stiffness of the first law, so that differences are those of the shape.
    if match:
        for i, member in enumerate(given[1:], 1):
            given[i], notes[i] = _matched(member, given[0])
    tried = [
        (title, twin, at, note)
        for friction, note in zip(given, notes, strict=True)
        for title, twin, at in _levels(friction, inputs or {})
    ]
    _refuse_unused(inputs or {}, given)
    titles = _distinct([title for title, *_ in tried])
    benches: list[Bench] = []
    for _, member, at, _ in tried:
        # Settings of matched laws are the same too.
        same = (benches[0].force, benches[0].speed) if benches and match else None
        benches.append(Bench.of(member, load, rig, at, same))
    count, done = len(chosen) * len(tried), itertools.count(1)
    found: list[Characterization] = []
    for title, bench, (_, member, _, note) in zip(titles, benches, tried, strict=True):
        results: dict[str, Any] = {}
        failed: dict[str, str] = {}
        for name in chosen:
            try:
                results[name.replace("-", "_")] = TESTS[name](bench)
            # One law that cannot be followed does not end the others.
            except SimulationError as error:
                why, dot, _ = str(error).partition(". ")  # the rest is advice on rigs of one's own
                failed[name] = (
                    f"{why}{dot.strip()} The bench cannot follow this law with these values: give"
                    " others, such as a larger smoothing velocity or a smaller bristle stiffness,"
                    " or leave the test out."
                )
            if progress is not None:
                progress(next(done), count)
        found.append(
            Characterization(
                title=title, law=member, load=load, matched=note, failed=failed, **results
            )
        )
    return dataclasses.replace(found[0], others=tuple(found[1:]))


def law_with_values(given: Given, load: float) -> FrictionLaw:
    """Return a law; one that is given by type, name or text with its typical values.

    Examples
    --------
    >>> law_with_values("coulomb", 1.0)
    Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
    """
    law: Any = law_type(given) if isinstance(given, str) else given
    is_type = isinstance(law, type) and issubclass(law, FrictionLaw)
    if not (is_type or isinstance(law, FrictionLaw)):
        raise InputError(
            f"a law must be a FrictionLaw, its type, or its name or composition, got {given!r}."
        )
    return with_typical_values(law) or starting_law(law, load)


def _matched(law: FrictionLaw, first: FrictionLaw) -> tuple[FrictionLaw, str]:
    """Return a law with levels, Stribeck velocity and stiffness of another; and which, in words."""
    values: dict[str, float] = {}
    for name in fields_of(type(law)):
        role = name.rpartition("ward_")[2]
        own = name if hasattr(first, name) else role if hasattr(first, role) else f"forward_{role}"
        value = getattr(first, own, None) if role in ROLES else None
        if value is not None:
            values[name] = float(value)
    # A level at rest may not lie below one that was matched above it.
    for name, quantity in fields_of(type(law)).items():
        least = quantity.at_least
        if least in values and name not in values and (own_value := getattr(law, name)) is not None:
            values[name] = max(float(own_value), values[least])
    words = dict.fromkeys(name.rpartition("ward_")[2].replace("_", " ") for name in values)
    if not words:
        return law, f"Nothing of {law.title} could be matched to {first.title}."
    return dataclasses.replace(law, **values), f"{capital(joined([*words]))} as {first.title}."


def _levels(
    law: FrictionLaw, inputs: Mapping[str, float | Sequence[float]]
) -> Iterator[tuple[str, FrictionLaw, dict[str, float]]]:
    """Return the law at each combination of values of its inputs, with its title and the values."""
    missing = [name for name in law.inputs if name not in inputs]
    if missing:
        raise InputError(
            f"the law {law.name} depends on {joined(missing)}: give values, such as"
            f" inputs={{{missing[0]!r}: [...]}} in Python or --input {missing[0]}=VALUE,... on the"
            " command line."
        )
    choices = [np.atleast_1d(np.asarray(inputs[name], dtype=float)) for name in law.inputs]
    # Every combination of values, the last input fastest.
    for values in itertools.product(*choices):
        at = {name: float(value) for name, value in zip(law.inputs, values, strict=True)}
        told = "".join(f", {name} {_input_text(name, value)}" for name, value in at.items())
        yield f"{law.title}{told}", law, at


def _input_text(name: str, value: float) -> str:
    """Return a value of an input with its unit."""
    unit = unit_text(CONTACT_INPUTS[name].unit) if name in CONTACT_INPUTS else ""
    return f"{number(value, 4)} {unit}".strip()


def _refuse_unused(
    inputs: Mapping[str, float | Sequence[float]], laws: Sequence[FrictionLaw]
) -> None:
    known = tuple(dict.fromkeys(name for law in laws for name in law.inputs))
    for name in inputs:
        if name not in known:
            depends = f"depend on {joined(known)}" if known else "depend on no input"
            raise InputError(f"inputs: no law here depends on {name!r}; they {depends}.")


def _distinct(titles: Sequence[str]) -> list[str]:
    """Return titles of which no two are equal."""
    seen: dict[str, int] = {}
    found = []
    for title in titles:
        seen[title] = seen.get(title, 0) + 1
        found.append(title if seen[title] == 1 else f"{title} ({seen[title]})")
    return found
