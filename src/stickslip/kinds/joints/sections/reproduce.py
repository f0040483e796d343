"""How to have the report again, and whom to cite."""

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Final

import stickslip
from stickslip.errors import UnknownNameError
from stickslip.friction import FrictionLaw
from stickslip.identification import LAW, RecordSettings
from stickslip.kinds.joints.joint_verdict import BlockwiseVerdict
from stickslip.mechanisms import Mechanism
from stickslip.quantities import fields_of
from stickslip.report import Origin, Section, reproduce
from stickslip.selection import specifications

NO_BREAK: Final = "\N{NO-BREAK SPACE}"
"""Stands for the blanks of names while lines are wrapped."""
WIDTH: Final = 66
"""Letters of a line of code, which a page shows without scrolling."""


def reproduced(
    verdict: BlockwiseVerdict,
    origin: Origin,
    *,
    lines: str,
    law: str,
    laws: Sequence[FrictionLaw],
) -> Section:
    """Return the section from what differs by the kind of verdict."""
    data = "`record` is" if verdict.second is None else "`record` and `second` are"
    caption = (
        f"The selection in Python; {data} read by `load_measurement` with the columns, units and"
        " gains of the data. Laws with start values, such as those of a rig file, are given in"
        " place of their names."
    )
    code = [(lines, caption)]
    fit = verdict.closest.fit
    if fit is not None:
        code.append((law, ""))
        code.append(
            (fit.to_toml().strip(), "The fitted law as code and as a file for simulations.")
        )
    return reproduce(origin, code=code, data=_data(verdict), laws=laws)


def lines_of(verdict: BlockwiseVerdict, names: Sequence[str], rig: str) -> str:
    """Return the lines of Python that make the selection again, from the names of the laws.

    A mechanism that is not all numbers is left to `load_rig`, and laws of one's own to oneself.
    """
    laws = "None" if verdict.usual else _laws(names)
    built = _built(verdict.mechanism)
    kind = type(verdict.mechanism).__name__
    names = [*sorted([kind if built else "load_rig", "RecordSettings"]), "select"]
    parts = [built or f"load_rig({_quoted(rig or 'rig.toml')}).mechanism", laws, "record"]
    parts += _varied(verdict)
    parts.append(f"settings={_settings(verdict.settings)}")
    parts += ["validate=second"] if verdict.second is not None else []
    lines = [_imported(*names), ">>> verdict = select("]
    lines += [f"...     {part}," for part in parts]
    return "\n".join([*lines, "... )"])


def _quoted(text: str) -> str:
    """Return a text as one would write it in Python.

    Examples
    --------
    >>> print(_quoted("arm.toml"), _quoted('my "arm".toml'))
    "arm.toml" 'my "arm".toml'
    """
    plain = text.isprintable() and not {'"', "\\"} & {*text}
    return f'"{text}"' if plain else repr(text)


def _imported(*names: str) -> str:
    """Return the line of Python that imports public names."""
    return f">>> from stickslip import {', '.join(names)}"


def _built(mechanism: Mechanism) -> str:
    """Return a mechanism as one would write it, nothing if not all of it is numbers."""
    if type(mechanism).__name__ not in stickslip.__all__:
        return ""
    found = []
    for one in fields(mechanism):
        value = getattr(mechanism, one.name)
        if value is None or value == one.default:
            continue
        if isinstance(value, bool) or not isinstance(value, int | float):
            return ""
        found.append(f"{one.name}={value!r}")
    return f"{type(mechanism).__name__}({', '.join(found)})"


def _laws(names: Sequence[str]) -> str:
    """Return the argument with the laws by name; names that say nothing are left to oneself."""
    try:
        specifications(names)
    except UnknownNameError:
        return "laws"
    # no line ends within a composition
    said = ", ".join(f'"{name}"'.replace(" ", NO_BREAK) for name in names)
    lines = textwrap.wrap(f"[{said}]", WIDTH, break_on_hyphens=False, break_long_words=False)
    return "\n...      ".join(lines).replace(NO_BREAK, " ")


def _varied(verdict: BlockwiseVerdict) -> list[str]:
    """Return the argument on what was looked for of the mechanism."""
    fit = verdict.closest.fit
    paths = [e.path for e in fit.estimates] if fit else []
    varied = [
        f'"{path}"'
        for path in paths
        if path.startswith("mechanism.") and path != "mechanism.offset"
    ]
    return [f'vary=["{LAW}", {", ".join(varied)}]'] if varied else []


def _settings(settings: RecordSettings) -> str:
    """Return the settings as one would write them, the seed always."""
    usual = RecordSettings()
    said = [
        f"{one.name}={getattr(settings, one.name)!r}"
        for one in fields(settings)
        if one.name == "seed" or getattr(settings, one.name) != getattr(usual, one.name)
    ]
    return f"RecordSettings({', '.join(said)})"


def _data(verdict: BlockwiseVerdict) -> str:
    records = verdict.measurement.records()
    said = list(dict.fromkeys(r.provenance for r in records if r.provenance))
    whole = verdict.measurement.provenance
    return whole or "; ".join(said[:3])


def laws_as_code(laws: Mapping[str, FrictionLaw]) -> str:
    """Return fitted laws by contact as one would write them.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> laws_as_code({"knee": Coulomb(kinetic_coefficient=0.2)}).splitlines()[2]
    '...     "knee": Coulomb(kinetic_coefficient=0.2),'
    """
    kinds = {type(law).__name__ for law in laws.values()}
    lines = [
        f'...     "{name}": {type(law).__name__}({", ".join(_values(law))}),'
        for name, law in laws.items()
    ]
    return "\n".join([_imported(*sorted(kinds)), ">>> laws = {", *lines, "... }"])


def _values(law: FrictionLaw) -> list[str]:
    """Return the arguments of a law that have a value."""
    given = {name: getattr(law, name) for name in fields_of(type(law))}
    return [f"{name}={value:.6g}" for name, value in given.items() if value is not None]
