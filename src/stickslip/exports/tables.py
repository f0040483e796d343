"""CSV and JSON: a table of forces, and the law with all that is known of it."""

from typing import Any, ClassVar, Final, final

import numpy as np
from typing_extensions import override

from stickslip.documents import document, json_text
from stickslip.exports.base import Export, Target
from stickslip.exports.languages import commented
from stickslip.exports.simplification import steady_force
from stickslip.exports.subject import Subject
from stickslip.quantities import fields_of, turned

EVEN: Final = 200
"""Evenly spaced speeds in each direction."""
DENSE: Final = 100
"""Speeds in each direction that are spaced by a constant ratio, for what happens near rest."""
LEAST: Final = 1e-5
"""Smallest speed over the largest."""


@final
class CsvTable(Target):
    """Friction force by velocity, for lookup tables."""

    name: ClassVar[str] = "csv"
    title: ClassVar[str] = "lookup table (CSV)"
    evaluates: ClassVar[bool] = True

    @override
    def export(self, subject: Subject) -> Export:
        law, load, most = subject.law, subject.needed_load(), subject.needed_speed()
        even = np.linspace(0.0, most, EVEN + 1)[1:]
        speed = np.union1d(even, np.geomspace(LEAST * most, most, DENSE))
        speed[-1] = most  # which geomspace may miss by a rounding
        speed = np.unique(speed)
        velocity = np.concatenate([-speed[::-1], speed])
        force = steady_force(subject, velocity, load)
        unit, speed_unit = turned("N", subject.rotary), turned("m/s", subject.rotary)
        what = "torque" if subject.rotary else "force"
        notes = [
            *subject.header(),
            f"Friction of {'long' if law.states else 'any'} sliding"
            + (f" at a load of {load!r} N." if subject.levels == "per load" else "."),
            *([f"Contact inputs: {subject.at_text}."] if subject.at else []),
            *(
                f"Break-away {words}: {float(law.towards(side).break_away(load))!r} {unit}."
                for words, side in (("forward", 1), ("backward", -1))
            ),
            f"Velocity 0 has no row: there friction is any {what} up to break-away. A table that is"
            " interpolated between the rows beside it does not hold a body at rest.",
        ]
        rows = [f"{v!r},{f!r}" for v, f in zip(velocity.tolist(), force.tolist(), strict=True)]
        lines = [*commented(notes, "# "), f"velocity [{speed_unit}],friction [{unit}]", *rows]
        text = "\n".join(lines) + "\n"
        return Export(target=self.name, files={f"{subject.name}.csv": text})


@final
class JsonDocument(Target):
    """The law with its parameters, units, intervals and covariance."""

    name: ClassVar[str] = "json"
    title: ClassVar[str] = "JSON"

    @override
    def export(self, subject: Subject) -> Export:
        text = json_text(document("law", _content(subject)))
        return Export(target=self.name, files={f"{subject.name}.json": text})


def _content(subject: Subject) -> dict[str, Any]:
    law, known = subject.law, subject.estimates
    return {
        "law": law.name,
        "title": law.title,
        "formula": law.formula,
        "sources": list(law.sources),
        "motion": "rotary" if subject.rotary else "linear",
        "levels": subject.levels,
        "load": subject.load,
        "inputs": list(law.inputs),
        "largest_speed": None if known is None else known.largest_speed,
        "static_switch": getattr(law, "static_switch", None),
        "bristles": list(law.states),
        "parameters": [_parameter(subject, one.name) for one in subject.equations.parameters],
        "shape": dict(_shape(subject)),
        "covariance_of": [] if known is None else list(known.covariance_of),
        "covariance": [] if known is None else [list(row) for row in known.covariance],
        "provenance": subject.source or None,
    }


def _parameter(subject: Subject, name: str) -> dict[str, Any]:
    (one,) = (one for one in subject.equations.parameters if one.name == name)
    known = subject.estimates
    low, high = (None, None) if known is None else known.intervals.get(name, (None, None))
    return {
        "parameter": name,
        "symbol": one.quantity.symbol,
        "unit": subject.unit(one.quantity),
        "value": one.value,
        "low": low,
        "high": high,
        "interval": known.interval if known is not None and low is not None else None,
        "known": subject.known(name) or None,
    }


def _shape(subject: Subject) -> list[tuple[str, float]]:
    """Return whole exponents, which shape the equations instead of standing in them."""
    law = subject.law
    return [
        (name, float(getattr(law, name)))
        for name, one in fields_of(type(law)).items()
        if one.structural and not one.stands_in_equations(getattr(law, name))
    ]
