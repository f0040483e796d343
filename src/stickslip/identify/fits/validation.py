"""What verbs take: which parameters are varied and which fixed; slips that Python lets pass."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Generic, TypeAlias, TypeVar, cast

from stickslip.data import Measurement, Rig
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import FrictionLaw, RateState, laws
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.quantities import Quantity, all_paths, fields_of, full_path, parameters
from stickslip.quantities import vary as with_values

AnyLaw: TypeAlias = FrictionLaw | type[FrictionLaw] | RateState | type[RateState] | None
L = TypeVar("L", bound=AnyLaw)
Vary: TypeAlias = str | Sequence[str] | None
Fixed: TypeAlias = Mapping[str, float] | None

LAW = "friction.*"
"""Stands in `vary` for what a law fits by default: its `fit_order`, or what travels can pay for."""

Laws: TypeAlias = Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str]
"""Several laws, as instances, types or names."""


@dataclass(frozen=True, kw_only=True)
class Parameters(Generic[L]):
    """What `vary` and `fixed` say of a mechanism and a law, as fits need it."""

    mechanism: Mechanism
    """The mechanism with its fixed values."""
    law: L
    """The law, an instance with its fixed values; None where several are compared."""
    free: tuple[str, ...] | None = None
    """Paths of the law's parameters that are fitted, `LAW` among them for its default; None if
    that is all."""
    known: Mapping[str, float] = field(default_factory=dict)
    """Fixed values of the law, by path without ``friction``."""
    unknown: tuple[str, ...] = ()
    """Paths of the mechanism's parameters that are fitted."""
    held: tuple[str, ...] = ()
    """Paths of the mechanism's parameters that are fixed, such as an offset, which is fitted unless
    it is."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        law: L,
        vary: Vary = None,
        fixed: Fixed = None,
        *,
        measurement: Measurement | None = None,
    ) -> "Parameters[L]":
        """Resolve names to full paths, and set what is fixed.

        Examples
        --------
        >>> from stickslip import Axis, CoulombViscous
        >>> found = Parameters.of(Axis(inertia=1.0), CoulombViscous, ["friction.*", "inertia"])
        >>> found.free, found.unknown
        (None, ('mechanism.inertia',))
        >>> Parameters.of(Axis(inertia=1.0), CoulombViscous, "visc*", {"inertia": 2.0}).free
        ('friction.viscous_coefficient',)
        """
        of_law = law_quantities(law)
        every = {**of_law, **all_paths(mechanism, "mechanism")}
        if law is None and isinstance(fixed, Mapping):
            refuse_of_laws(map(str, fixed), every)
        kind = law if isinstance(law, type) else type(law)
        values = fixed_values(
            fixed, every, lambda path: (kind if path in of_law else type(mechanism)).__name__
        )
        for record in () if measurement is None else measurement.records():
            for path in values.keys() & record.overrides.keys():
                raise InputError(
                    f"trial {record.name or 'without a name'} sets {path}, which fixed sets too:"
                    " remove one of them."
                )
        friction = {path: v for path, v in values.items() if path in of_law}
        own = {path: v for path, v in values.items() if path not in of_law}
        varied = _varied(mechanism, law, of_law, vary, values)
        free = tuple(path for path in varied if path.startswith("friction."))
        if isinstance(law, type) and not free and not friction:
            free = (LAW,)  # no values of it were given
        if isinstance(law, FrictionLaw | RateState) and friction:
            law = cast("L", with_values(law, "friction", friction))
        return cls(
            mechanism=with_values(mechanism, "mechanism", own) if own else mechanism,
            law=law,
            free=None if free == (LAW,) else free,
            known={path.removeprefix("friction."): v for path, v in friction.items()},
            unknown=tuple(path for path in varied if not path.startswith("friction.")),
            held=tuple(own),
        )


def law_quantities(law: AnyLaw) -> Mapping[str, Quantity]:
    """Return the parameters of a law by path, those of which it has no value included.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> list(law_quantities(Coulomb))
    ['friction.kinetic_coefficient', 'friction.static_coefficient']
    """
    if law is None:
        return {}
    if isinstance(law, type):
        return {f"friction.{name}": quantity for name, quantity in fields_of(law).items()}
    return all_paths(law, "friction")


def refuse_of_laws(names: Iterable[str], known: Collection[str]) -> None:
    """Refuse values of laws where these are compared: by their free parameters, all of each."""
    own = {path.rpartition(".")[2] for path in known}
    for name in names:
        field = name.removeprefix("friction.")
        if name in (*known, *own) or not any(field in fields_of(kind) for kind in laws().values()):
            continue
        raise InputError(
            "fixed (--fixed) takes only parameters of the mechanism when laws are compared, got"
            f" {name}: all parameters of each law are fitted. To hold one, fit its law alone"
            " (`stickslip fit --law NAME --fixed NAME=VALUE`)."
        )


def fixed_values(
    fixed: Fixed, known: Mapping[str, Quantity], owner: Callable[[str], str]
) -> dict[str, float]:
    """Return fixed values by full path, each within the range of its parameter."""
    if fixed is None:
        return {}
    if not isinstance(fixed, Mapping):
        raise InputError(
            f"fixed takes values by name, such as {{'viscous_coefficient': 0.4}}, got {fixed!r}."
        )
    values: dict[str, float] = {}
    for name, value in fixed.items():
        path = full_path(name, known, "parameter in fixed")
        if path in values:
            raise InputError(f"fixed names {path} twice.")
        values[path] = known[path].check(owner(path), path.partition(".")[2], value)
    return values


def _varied(
    mechanism: Mechanism,
    law: AnyLaw,
    of_law: Mapping[str, Quantity],
    vary: Vary,
    values: Collection[str],
) -> list[str]:
    """Return the full paths of what is varied, `LAW` for the default of the law."""
    names = (LAW,) if vary is None else names_of(vary)
    if law is None:  # each law that is compared is fitted
        names = tuple(dict.fromkeys((LAW, *names)))
    for name in names:
        named = name != LAW and not is_pattern(name)
        if law is None and named and name.startswith("friction."):
            raise InputError(
                f"vary takes {LAW!r} and parameters of the mechanism when laws are compared,"
                f" got {name}: fit that law alone."
            )
    own = {path: quantity for path, quantity, _ in parameters(mechanism, "mechanism")}
    known = {**of_law, **own}
    return varied_paths(names, known, values, (LAW,))


def varied_paths(
    names: Sequence[str], known: Collection[str], fixed: Collection[str], kept: Collection[str]
) -> list[str]:
    """Return the full paths of what is varied, each once."""
    result: list[str] = []
    for name in names:
        if name in kept:
            result.append(name)
        elif is_pattern(name):
            hits = [path for path in known if covers(name, path)]
            if not hits:
                raise UnknownNameError("parameter in vary", name, known)
            result += [path for path in hits if path not in fixed]
        else:
            path = full_path(name, known, "parameter in vary")
            if path in fixed:
                raise InputError(f"{path} is in both vary and fixed: remove it from one of them.")
            result.append(path)
    return list(dict.fromkeys(result))


def is_pattern(name: str) -> bool:
    """Whether a name may stand for several parameters."""
    return any(letter in name for letter in "*?[")


def covers(name: str, path: str) -> bool:
    """Whether a name or a pattern stands for a path; without a dot it is that of a last name.

    Examples
    --------
    >>> (
    ...     covers("visc*", "friction.viscous_coefficient"),
    ...     covers("mechanism.*", "friction.yield_exponent"),
    ... )
    (True, False)
    """
    return fnmatchcase(path if "." in name else path.rpartition(".")[2], name)


def check_given(verb: str, mechanism: object, measurement: object) -> None:
    """Check that a verb was given a mechanism and a measurement.

    Examples
    --------
    >>> from stickslip import Axis
    >>> check_given("fit", Axis(inertia=1.0), "run.csv")
    Traceback (most recent call last):
    stickslip.errors.InputError: fit takes a Measurement, got 'run.csv': read the file with ...
    """
    if isinstance(mechanism, Rig):
        raise InputError(
            f"{verb} takes a mechanism and a measurement, got a Rig: give rig.mechanism and"
            " rig.measurement."
        )
    if not isinstance(mechanism, Mechanism):
        raise InputError(
            f"{verb} takes a mechanism such as Axis(inertia=1.0), got {called(mechanism)}."
        )
    if isinstance(measurement, Measurement) and measurement.joint_names():
        return
    slip_of(mechanism)  # several contacts are identified by records of joints alone
    if isinstance(measurement, Measurement):
        return
    cure = "read a file with load_measurement, or make a Measurement of arrays"
    if isinstance(measurement, str):
        cure = f"read the file with load_measurement({measurement!r})"
    elif isinstance(measurement, Rig):
        cure = "give rig.measurement"
    elif isinstance(measurement, (type, FrictionLaw)):
        cure = "the order is mechanism, law, measurement"
    raise InputError(f"{verb} takes a Measurement, got {called(measurement)}: {cure}.")


def check_varied(count: int) -> None:
    """Refuse a fit of no parameters."""
    if not count:
        raise InputError("there is nothing to fit: name at least one parameter in vary.")


def called(given: object) -> str:
    """Return what an argument is, for the error that refuses it.

    Examples
    --------
    >>> called("run.csv"), called(int), called(3)
    ("'run.csv'", 'the class int', 'int')
    """
    if isinstance(given, type):
        return f"the class {given.__name__}"
    return repr(given) if isinstance(given, str) else type(given).__name__


def names_of(given: str | Sequence[str]) -> tuple[str, ...]:
    """Return names, of which a single one may be given without a list around it.

    Examples
    --------
    >>> names_of("inertia"), names_of(["inertia", "offset"])
    (('inertia',), ('inertia', 'offset'))
    """
    names = (given,) if isinstance(given, str) else given
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        raise InputError(f"vary takes a name or a list of names, such as 'inertia', got {given!r}.")
    return tuple(names)


def laws_of(given: Laws | FrictionLaw | type[FrictionLaw] | str | None) -> Laws | None:
    """Return laws, of which a single one may be given without a list around it.

    Examples
    --------
    >>> laws_of("coulomb"), laws_of(None)
    (['coulomb'], None)
    """
    return [given] if isinstance(given, str | type | FrictionLaw | RateState) else given
