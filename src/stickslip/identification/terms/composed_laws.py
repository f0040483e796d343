"""Laws of the structures that explain a force balance, with their coefficients as start values."""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, final

import numpy as np

from stickslip.errors import InputError, ParameterError
from stickslip.evidence import (
    GROWN,
    SIGN,
    Explanation,
    Fit,
    Rule,
    Shape,
    Structure,
    Term,
    fades,
    fit,
    polished,
)
from stickslip.friction import OPTIONAL, CandidateSpec, Composition, FrictionLaw, Leaf, Rung, law
from stickslip.identification.estimation.containment import CONSTANTS, FittedLaw

DIRECTIONAL = ("level_dir", "viscous_dir", "power_dir", "stribeck_dir")
"""Kinds of terms that no constant force beside friction can stand for."""
ALONG = ("level_slope", "level_ripple")
"""Kinds that multiply a level along the way."""
GROWING = {"level": "temperature", **{part: kind for kind, part in GROWN.items()}}
"""Kinds of what an input adds to the parts of a law, by part."""
LIKE_DAHL = 0.15
"""Exponent of a memory, from 1, up to which it is Dahl's without one."""
DAMPED = 0.2
"""Damping ratio of a bristle that searches begin with; the force balance says nothing of it."""
LEAST = 1e-9
"""Share of the level below which no level starts: laws divide by theirs."""

Sides = tuple[float, float]
"""Values forward and backward."""


@final
@dataclass(frozen=True, kw_only=True)
class ComposedLaw:
    """The law of a structure."""

    text: str
    """Its composition."""
    specification: CandidateSpec
    """The candidate: the law with its start values, and which of them are looked for."""
    constant: float
    """Constant force [N] beside friction, as mechanisms count it."""
    inertia: float | None
    """Inertia of the structure; None where none was looked for."""
    known: Mapping[str, float] = field(default_factory=dict)
    """Coefficients of columns of the mechanism, by name."""
    held: tuple[str, ...] = ()
    """Paths of values that the balance found and a fit holds, such as those of exponents."""

    @property
    def name(self) -> str:
        """Key of the candidate."""
        return self.specification.name

    @property
    def start(self) -> Mapping[str, float]:
        """Values of what is looked for, by path."""
        law = self.specification.law
        free = {f"friction.{name}": getattr(law, name) for name in self.specification.free or ()}
        return {path: float(value) for path, value in free.items() if value is not None}

    def as_fit(self, unknown: Sequence[str]) -> FittedLaw:
        """Return the coefficients of a structure as a fit from which searches begin."""
        beside = {path: self.inertia for path in unknown if path.endswith(("inertia", "mass"))}
        beside |= {path: self.known[path] for path in unknown if path in self.known}
        values = {**self.start, **{path: x for path, x in beside.items() if x is not None}}
        law = self.specification.law
        if not law.directional:
            values |= dict.fromkeys(CONSTANTS, self.constant)
        assert isinstance(law, FrictionLaw)
        return FittedLaw(law=law, values=values, cost=math.inf, rows=0)


@final
@dataclass(frozen=True, kw_only=True)
class Asked:
    """The laws of all structures that an explanation met."""

    explanation: Explanation
    laws: Mapping[str, ComposedLaw]
    """By name, that of the best structure first, then those that are not told apart from it."""
    fits: Mapping[str, Fit]
    """The closest structure of each law, by the same names."""
    _judged: dict[tuple[str, FrictionLaw], Fit | None] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @classmethod
    def of(cls, found: Explanation, load: float, inertia: float | None = None) -> "Asked":
        """Return the laws of an explanation under a load [N] and with a mass."""
        laws: dict[str, ComposedLaw] = {}
        fits: dict[str, Fit] = {}
        for one in [found.best, *found.ties, *sorted(found.family.values(), key=lambda f: f.rms)]:
            law = composed_law(one, load, inertia) if one.ok else None
            if law is not None and law.name not in laws:
                laws[law.name], fits[law.name] = law, one
        return cls(explanation=found, laws=laws, fits=fits)

    @property
    def best(self) -> ComposedLaw:
        """The law of the best structure."""
        return next(iter(self.laws.values()))

    @property
    def flows(self) -> bool:
        """Whether the law of the best structure has a part that grows with the speed."""
        flow = _flow(self.explanation.best.structure, "")
        return bool(flow) or "viscous_coefficient" in self.best.specification.law.fit_order

    def starts_of(self, kind: type[FrictionLaw], unknown: Sequence[str]) -> tuple[FittedLaw, ...]:
        """Return fits from which the search of a law begins, one of the best law's values first."""
        found = tuple(one.as_fit(unknown) for one in self.laws.values())
        own = self.start_of(kind, unknown)
        return (own, *found) if own else found

    def start_of(self, kind: type[FrictionLaw], unknown: Sequence[str]) -> FittedLaw | None:
        """Return a law of which the best one has all parameters, with the values that it has."""
        best = self.best.as_fit(unknown)
        if not {*kind.fit_order} <= {*type(best.law).fit_order}:
            return None
        values = {name: getattr(best.law, name) for name in kind.fit_order}
        kept = {path: x for path, x in best.values.items() if not path.startswith("friction.")}
        kept |= {f"friction.{name}": value for name, value in values.items()}
        return replace(best, law=kind(**values), values=kept)

    def rejects(self, own: Fit | None) -> bool:
        """Whether the force balance tells a structure from the best one."""
        best = self.explanation.best
        if own is None or own is best:
            return False
        return Rule().better(best, own, self.explanation.scale)

    def fit_of(self, name: str, law: FrictionLaw) -> Fit | None:
        """Return the closest structure of a law, at its values if the search has not met it.

        Of a law with bristles that the path does not resolve, it is that of the law without them:
        along such a path the noise of positions deflects bristles, and accuses the law of it.
        """
        if name in self.fits and not law.states:
            return self.fits[name]
        if (name, law) not in self._judged:
            self._judged[name, law] = self._fit_of(name, law)
        return self._judged[name, law]

    def _fit_of(self, name: str, law: FrictionLaw) -> Fit | None:
        balance, best = self.explanation.balance, self.explanation.best.structure
        made = partial(structure_of, law, best, covariates=balance.references)
        structure = made()
        shapes = () if structure is None else structure.memories

        def unseen(memories: Sequence[tuple[str, Shape]]) -> set[str]:
            return {c for c, shape in memories if not balance.resolves(shape[0], c)}

        # unless the best structure has such a bristle too, of which damping shows what paths do not
        if unseen(shapes) - unseen(best.memories):
            structure = made(bristles=False)
        elif name in self.fits and not shapes:
            return self.fits[name]
        if structure is None:
            return self.fits.get(name)
        alike = [one for one in self.fits.values() if _searched_as(one.structure, structure)]
        alike += [self.fits[name]] if name in self.fits and structure.memories else []
        if structure.memories:  # a bristle off the values of its law by little is far off its path
            alike.append(fit(balance, polished(balance, structure)))
        return min(alike, key=lambda one: one.rms) if alike else fit(balance, structure)


def _searched_as(one: Structure, own: Structure) -> bool:
    """Whether a structure has the terms of another, and levels of bristles that fade like it."""
    kinds = [{(term.kind, term.channel) for term in each.terms} for each in (one, own)]
    shapes = [[(channel, len(shape)) for channel, shape in each.memories] for each in (one, own)]
    return kinds[0] == kinds[1] and shapes[0] == shapes[1] and all(n > 2 for _, n in shapes[0])


PARTS = {
    "level": "level",
    "stribeck": "stribeck",
    "viscous": "viscous",
    "power": "power",
    "drag": "quadratic",
}
"""Kinds of terms, by the parts of laws that they are."""
GEARS = {
    ("weight", "transmitted"): "weight",
    ("weight", "motor"): "motor_weight",
    ("weight2", "transmitted"): "weight2",
}
"""The same of parts that grow with an input of the contact."""
TWO_SIDED = ("stribeck", "viscous", "power")
"""Kinds with a difference between the directions of their own; that of levels is an offset."""


def structure_of(
    law: FrictionLaw,
    best: Structure,
    channel: str = "",
    *,
    covariates: Collection[str] = (),
    bristles: bool = True,
) -> Structure | None:
    """Return the structure of a law beside what else the best structure has.

    None for laws with other parts than terms have. Where the load varies, levels grow with it.
    Without bristles it is that of the law's steady curve.
    """
    made: Composition | None = law.made_of
    if made is None or (made.memory and made.memory.part.name not in ("dahl", "lugre")):
        return None
    # a level that ends with rest is none along a motion
    leaves = [one for one in (*made.inside, *made.outside) if one.part.name not in OPTIONAL]
    gears = [Term(kind, (), channel, what) for kind, what in _gears(leaves, covariates)]
    leaves = [one for one in leaves if not one.inputs]
    if len(gears) != sum(bool(one.inputs) for one in (*made.inside, *made.outside)):
        return None
    if made.factors or any(leaf.part.name not in PARTS for leaf in leaves):
        return None
    if any(leaf.sign is not None for leaf in leaves):
        return None
    rest = {*_text(best, channel, directional=True)[1], *PARTS.values(), *DIRECTIONAL, "load"}
    terms = [one for one in best.terms if one.channel != channel or one.kind not in rest]
    terms += gears
    for leaf in leaves:
        kind, par = PARTS[leaf.part.name], _parameters_of(law, leaf)
        kind, par = ("viscous", ()) if (kind, par) == ("power", (1.0,)) else (kind, par)
        grows = "load" in covariates and kind == "level"
        if kind != "stribeck" or not bristles or not _fades(law, made):  # else the shape has it
            terms += [Term("load", (), channel, "load") if grows else Term(kind, par, channel)]
        both = any(isinstance(one, tuple) for one in leaf.names.values())
        terms += [Term(f"{kind}_dir", par, channel)] if both and kind in TWO_SIDED else []
    # that of a curve by direction may stand for a constant force
    shifted = made.directional or any(
        one.channel == channel and one.kind in DIRECTIONAL for one in best.terms
    )
    if shifted and not any(one.kind == "offset" for one in terms):
        # beside a law of one level, fits look for a constant force in any case
        bristled = made.directional and made.memory and bristles
        terms += [Term("level_dir" if bristled else "offset", (), channel)]
    found = Structure(tuple(sorted(set(terms), key=str)), best.shapes).shaped(channel, SIGN)
    if made.memory is None or not bristles:
        return found
    found = found.shaped(channel, _shape_of(law, made))
    damped = made.memory.part.name == "lugre" and fades(found.shape(channel))
    return found.having(Term("damping", (), channel)) if damped else found


def _gears(leaves: Iterable[Leaf], covariates: Collection[str]) -> Iterator[tuple[str, str]]:
    """Yield kinds and covariates of the parts that grow with the force through a gear."""
    for leaf in leaves:
        for what in leaf.inputs:
            if what in covariates and (leaf.part.name, what) in GEARS:
                yield GEARS[leaf.part.name, what], what


def _value(law: FrictionLaw, leaf: Leaf, name: str) -> float:
    """Return a parameter of a part, the mean of those of both directions."""
    field = leaf.names.get(name, name)
    both = field if isinstance(field, tuple) else (field,)
    return float(np.mean([getattr(law, one) for one in both]))


def _parameters_of(law: FrictionLaw, leaf: Leaf) -> tuple[float, ...]:
    """Return the nonlinear parameters of the term of a part."""
    names = {
        "stribeck": ("stribeck_velocity", "fading_exponent"),
        "power": ("viscous_exponent",),
    }.get(leaf.part.name, ())
    return tuple(_value(law, leaf, name) for name in names)


def _fades(law: FrictionLaw, made: Composition) -> bool:
    """Whether the level to which a bristle goes falls with speed.

    Dahl's with a surplus inside is LuGre's without damping, of which a force balance says nothing.
    """
    if made.memory is None or all(leaf.part.name != "stribeck" for leaf in made.inside):
        return False
    lugre = made.memory.part.name == "lugre"
    return lugre or _value(law, made.memory, "yield_exponent") == 1.0


def _shape_of(law: FrictionLaw, made: Composition) -> Shape:
    """Return the shape of the bristle of a law."""
    assert made.memory is not None
    inside = {leaf.part.name: leaf for leaf in made.inside}
    level = _value(law, inside["level"], "kinetic_coefficient")
    length = level / _value(law, made.memory, "bristle_stiffness")
    if not _fades(law, made):
        plain = made.memory.part.name == "lugre"
        return (length, 1.0 if plain else _value(law, made.memory, "yield_exponent"))
    step = _value(law, inside["stribeck"], "static_coefficient") / level - 1.0
    velocity, fading = _parameters_of(law, inside["stribeck"])
    return (length, 1.0, velocity, step, fading)


def composed_law(
    found: Fit, load: float, inertia: float | None = None, channel: str = ""
) -> ComposedLaw | None:
    """Return the law of a structure under a load [N] and with a mass; None if it has no friction.

    Where the notation has no such law, the nearest one without directions is returned.
    """
    structure = found.structure
    coefficients = _Coefficients.of(found, load, inertia, channel)
    for directional in (True, False):
        text = _text(structure, channel, directional=directional)[0]
        if not text:
            return None
        try:
            spec = _specification(structure, text, channel, directional=directional)
            kind = spec.law if isinstance(spec.law, type) else type(spec.law)
            values = _values(kind, coefficients)
            start = kind(**values)
        except (InputError, ParameterError):
            continue
        own = kind.fit_order if spec.free is None else spec.free
        free = tuple(dict.fromkeys((*own, *_powers(kind))))
        return ComposedLaw(
            text=text,
            specification=replace(spec, law=start, free=free),
            constant=0.0 if kind.directional else next(iter(found.of("offset", channel)), 0.0),
            inertia=next(iter(found.of("inertia", channel)), None),
            known={
                term.what: float(x)
                for x, term in zip(found.coef, found.owner, strict=True)
                if term.kind == "known"
            },
            held=tuple(f"friction.{name}" for name in values if name not in free),
        )
    return None


def _powers(kind: type[FrictionLaw]) -> Iterator[str]:
    """Yield exponents of powers of the speed: with one that is held, its coefficient is wrong."""
    for leaf in (*kind.made_of.inside, *kind.made_of.outside):
        if leaf.part.name == "power":
            names = leaf.names.get("viscous_exponent", "viscous_exponent")
            yield from (names,) if isinstance(names, str) else names


def _specification(
    structure: Structure, text: str, channel: str, *, directional: bool
) -> CandidateSpec:
    """Return the default candidate that a structure is, or else that of its text."""
    rung = _rung(structure, channel, directional=directional)
    if rung is not None:
        return rung.specification
    return CandidateSpec.of(law(text).name, law(text))


def _of(structure: Structure, channel: str) -> dict[str, Term]:
    return {one.kind: one for one in structure.terms if one.channel == channel}


def _text(structure: Structure, channel: str, *, directional: bool) -> tuple[str, set[str]]:
    """Return the composition of a structure, and the kinds of terms that it has."""
    terms, shape = _of(structure, channel), structure.shape(channel)
    both = {kind for kind in DIRECTIONAL if kind in terms} if directional else set()
    levels, flow = _levels(structure, channel), _flow(structure, channel)
    gear = _joined(f"{part}[{what}]" for (part, what), kind in GEARS.items() if kind in terms)
    used = {"level", "load", "second", "damping", *GEARS.values(), *both}
    used |= {"stribeck", "stribeck_cov", "temperature", *ALONG} & set(terms)
    slope = "power" if "power" in flow else "viscous"
    used |= {slope, f"{slope}_dir", f"{slope}_cov"}
    used |= {"quadratic"} if "drag" in flow or "power" in flow else set()
    if not levels and not gear:
        return flow, used
    sides = _sides(both)
    memory = _memory(terms, shape)
    if levels and not memory and all(sides) and flow:
        return _joined([f"both_ways[levels]({levels} + {flow})", gear]), used
    levels = f"both_ways[levels]({levels})" if sides[0] and levels else levels
    flow = f"both_ways[levels]({flow})" if sides[1] and flow else flow
    levels = _joined([levels, gear])
    whole = f"{memory}({levels})" if memory else levels
    return _joined([whole, flow]), used


def _joined(parts: Iterable[str]) -> str:
    return " + ".join(one for one in parts if one)


def _sides(both: set[str]) -> tuple[bool, bool]:
    """Whether levels and flows differ by direction: levels do if anything does.

    A constant force and half a difference between levels are one column, and a law by direction
    has levels of its own.
    """
    return bool(both), bool(both & {"viscous_dir", "power_dir"})


def _levels(structure: Structure, channel: str) -> str:
    terms = _of(structure, channel)
    if not {"level", "load"} & set(terms):
        return ""
    level = _grown("level", structure, channel)
    level += " * linear[position]" if "level_slope" in terms else ""
    level += " * ripple[position]" if "level_ripple" in terms else ""
    falls = {"stribeck", "stribeck_dir"} & set(terms) or fades(structure.shape(channel))
    return f"{level} + {_grown('stribeck', structure, channel)}" if falls else level


def _flow(structure: Structure, channel: str) -> str:
    terms = _of(structure, channel)
    if {"power", "power_dir"} & set(terms):
        return _grown("power", structure, channel)
    viscous = {"viscous", "viscous_dir", "viscous_cov"} & set(terms)
    parts = [_grown("viscous", structure, channel)] if viscous else []
    parts += ["drag"] if "quadratic" in terms else []
    return " + ".join(parts)


def _grown(part: str, structure: Structure, channel: str) -> str:
    """Return a part with what it grows with."""
    return part + "".join(f" * linear[{one.what}]" for one in _growth(part, structure, channel))


def _growth(part: str, structure: Structure, channel: str) -> list[Term]:
    """Return the terms of the inputs that a part grows with."""
    own = (GROWING[part], channel)
    return [one for one in structure.terms if (one.kind, one.channel) == own]


def _memory(terms: Mapping[str, Term], shape: Shape) -> str:
    if shape == SIGN:
        return ""
    if len(shape) == 5:
        return "lugre"
    if "second" in terms:
        return "maxwell[4]"
    return "maxwell[1]" if shape[1] <= LIKE_DAHL else "dahl"


def _rung(structure: Structure, channel: str, *, directional: bool) -> Rung | None:
    """Return the default candidate that the text of a structure is; None if it is none of them.

    A law of which the text alone is taken would hold what the default candidate looks for, such as
    the exponent of a power, under the name of another one.
    """
    terms, shape = _of(structure, channel), structure.shape(channel)
    if any(kind in terms for kind in (*ALONG, *GROWING.values(), *GEARS.values())):
        return None
    memory, flow = _memory(terms, shape), _flow(structure, channel)
    flow = {"": "viscous" if memory else "", "viscous + drag": "drag"}.get(flow, flow)
    levels = _levels(structure, channel)
    both = set(DIRECTIONAL) & set(terms) if directional else set()
    if memory not in ("", "dahl", "lugre") or flow not in ("viscous", "power", "drag"):
        return None
    if not levels or (both and not all(_sides(both))):
        return None
    rung = Rung(
        both_ways=bool(both),
        stribeck="stribeck" in levels,
        flow=flow,
        memory=memory,
        exponent=memory == "dahl" and abs(shape[1] - 1.0) > LIKE_DAHL,
    )
    return rung if not rung.exponent or rung == Rung(memory="dahl", exponent=True) else None


@final
@dataclass(frozen=True, kw_only=True)
class _Coefficients:
    """Values by part and by its own name of them: of one, or of both directions."""

    values: Mapping[tuple[str, str], float | Sides]

    @classmethod
    def of(cls, found: Fit, load: float, inertia: float | None, channel: str) -> "_Coefficients":
        structure = found.structure
        terms, shape = _of(structure, channel), structure.shape(channel)

        def of(kind: str, index: int = 0, what: str | None = None) -> float:
            own = [
                float(x)
                for x, term in zip(found.coef, found.owner, strict=True)
                if (term.kind, term.channel) == (kind, channel) and what in (None, term.what)
            ]
            return own[index] if own else 0.0

        both = any(kind in terms for kind in DIRECTIONAL)
        level = max(of("level") + load * of("load") + of("second"), LEAST)
        constant = of("level_dir") + (of("offset") if both else 0.0)
        sides = [max(level + s * constant, LEAST) / load for s in (1.0, -1.0)]
        steps = [max(of("stribeck") + s * of("stribeck_dir"), 0.0) / load for s in (1.0, -1.0)]
        if len(shape) == 5:
            steps = [shape[3] * one for one in sides]
        velocity, fading = _fading(terms, shape)
        flow = "power" if {"power", "power_dir"} & set(terms) else "viscous"
        slopes = [max(of(flow) + s * of(f"{flow}_dir"), 0.0) for s in (1.0, -1.0)]
        exponent = next((t.par[0] for k, t in terms.items() if k in ("power", "power_dir")), 1.0)
        values: dict[tuple[str, str], float | Sides] = {
            ("level", "kinetic_coefficient"): (sides[0], sides[1]),
            ("stribeck", "static_coefficient"): (sides[0] + steps[0], sides[1] + steps[1]),
            ("stribeck", "stribeck_velocity"): velocity,
            ("stribeck", "fading_exponent"): fading,
            ("viscous", "viscous_coefficient"): (slopes[0], slopes[1]),
            ("power", "viscous_coefficient"): (slopes[0], slopes[1]),
            ("power", "viscous_exponent"): exponent,
            ("drag", "quadratic_coefficient"): max(of("quadratic"), 0.0),
        }
        if shape != SIGN:
            stiffness = 0.5 * sum(sides) / shape[0]
            mass = inertia if inertia else 1.0
            values["*", "bristle_stiffness"] = stiffness
            dahl = abs(shape[1] - 1.0) <= LIKE_DAHL or len(shape) == 5
            values["*", "yield_exponent"] = 1.0 if dahl else shape[1]
            critical = 2.0 * math.sqrt(stiffness * load * mass)
            damping = of("damping") / shape[0] or DAMPED * critical
            values["*", "bristle_damping"] = damping / load
        values |= _factors(terms, of, level)
        for part in GROWING:
            whole = level if part == "level" else max(of(part), LEAST)
            for one in _growth(part, structure, channel):
                slope = of(one.kind, what=one.what) / whole
                values[f"{part} * linear[{one.what}]", "slope"] = slope
        growth = {"weight": "coefficient", "weight2": "quadratic_coefficient"}
        for (part, what), kind in GEARS.items():
            values[f"{part}[{what}]", growth[part]] = max(of(kind), 0.0) / load
        return cls(values=values)

    def field(self, text: str, leaf: Leaf, name: str) -> float | Sides | None:
        """Return the value of a part's parameter, if the structure says it."""
        part = leaf.part.name
        for key in ((text, name), (part, name), ("*", name)):
            if key in self.values:
                return self.values[key]
        return None


def _fading(terms: Mapping[str, Term], shape: Shape) -> Sides:
    """Return Stribeck velocity and exponent."""
    if len(shape) == 5:
        return shape[2], shape[4]
    for kind in ("stribeck", "stribeck_dir"):
        if kind in terms:
            return terms[kind].par[0], terms[kind].par[1]
    return 1.0, 2.0


def _factors(terms: Mapping[str, Term], of: Any, level: float) -> dict[tuple[str, str], float]:
    """Return the parameters of factors along the way, relative to what they multiply."""
    found: dict[tuple[str, str], float] = {}
    if "level_slope" in terms:
        found["level * linear[position]", "slope"] = of("level_slope") / level
    if "level_ripple" in terms:
        found["level * ripple[position]", "sine"] = of("level_ripple", 0) / level
        found["level * ripple[position]", "cosine"] = of("level_ripple", 1) / level
        found["level * ripple[position]", "harmonic"] = terms["level_ripple"].par[0]
    return found


def _values(kind: type[FrictionLaw], coefficients: _Coefficients) -> dict[str, float]:
    """Return the values of a law that its structure has."""
    made: Composition = kind.made_of
    values: dict[str, float] = {}
    for text, leaf in _leaves(made):
        for parameter in leaf.part.parameters:
            value = coefficients.field(text, leaf, parameter.name)
            if value is None:
                continue
            field = leaf.names.get(parameter.name, parameter.name)
            if isinstance(field, tuple):
                pair = value if isinstance(value, tuple) else (value, value)
                values |= dict(zip(field, pair, strict=True))
            else:
                values[field] = 0.5 * sum(value) if isinstance(value, tuple) else value
    return {name: value for name, value in values.items() if name in made.fields}


def _leaves(made: Composition) -> Iterator[tuple[str, Leaf]]:
    """Yield parts in their places, with their text: of factors with what they multiply."""
    plain = [] if made.memory is None else [made.memory]
    for leaf in (*plain, *made.inside, *made.outside):
        yield str(leaf), leaf
    yield from made.factors.items()
