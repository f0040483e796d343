"""``stickslip warmup``."""

import dataclasses
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from stickslip.cli.output import document, note, print_json, stdout
from stickslip.cli.progress import Compiling
from stickslip.drives import Pulse
from stickslip.errors import InputError
from stickslip.experiments import load_rig
from stickslip.friction import FrictionLaw, law_type
from stickslip.friction import laws as known_laws
from stickslip.identification import starting_law
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms import mechanisms as known_mechanisms
from stickslip.quantities import fields_of, named
from stickslip.solver import WarmUp, warm_up

__all__ = ["run"]

DRIVE = Pulse(level=1.0, duration=1.0)
"""Stands for any drive: of another one only the equations differ, not the kernels."""


def run(
    path: Path | None,
    mechanisms: Sequence[str],
    laws: str | None,
    *,
    jobs: int | None,
    as_json: bool,
) -> None:
    """Compile, and say what was done."""
    if path is not None and mechanisms:
        raise InputError("give --rig or --mechanism, not both: a rig file has its own mechanism.")
    chosen = _laws(laws)
    pairs = _of_rig(path, chosen) if path is not None else _of_registry(mechanisms, chosen)
    with Compiling() as progress:
        try:
            done = warm_up(pairs, jobs=jobs, progress=progress)
        except KeyboardInterrupt:
            note("What was compiled so far stays in the cache.")
            raise
    if as_json:
        print_json(document("warmup", _content(pairs, done)))
    else:
        stdout().print(_sentence(done), markup=False)


def _laws(names: str | None) -> Sequence[type[FrictionLaw]] | None:
    return None if names is None else [law_type(name.strip()) for name in names.split(",")]


def _of_rig(
    path: Path, chosen: Sequence[type[FrictionLaw]] | None
) -> list[tuple[Mechanism, FrictionLaw]]:
    """Return the mechanism of a rig with the laws that `stickslip select` would try."""
    rig = load_rig(path)
    if chosen is None:
        usual = [law for law in known_laws().values() if not law.on_request]
        own = list(rig.laws.values()) or [starting_law(law) for law in usual]
        return [(rig.mechanism, law) for law in own]
    return [(rig.mechanism, rig.laws.get(law.name) or starting_law(law)) for law in chosen]


def _of_registry(
    names: Sequence[str], chosen: Sequence[type[FrictionLaw]] | None
) -> list[tuple[Mechanism, FrictionLaw]]:
    """Return mechanisms by name, without and with a drive, with laws; all if none are named."""
    known = known_mechanisms()
    kinds = [named(known, name, "mechanism") for name in names] or list(known.values())
    laws = [starting_law(law) for law in chosen or known_laws().values()]
    return [(rig, law) for kind in kinds for rig in _variants(kind) for law in laws]


def _variants(kind: type[Mechanism]) -> Iterator[Mechanism]:
    """Yield a mechanism with ordinary numbers, without and, if it takes one, with a drive."""
    quantities = fields_of(kind)
    values: dict[str, Any] = {
        field.name: min(max(1.0, quantities[field.name].low), quantities[field.name].high)
        for field in dataclasses.fields(kind)
        if field.name in quantities and field.default is dataclasses.MISSING
    }
    yield kind(**values)
    if "drive" in kind.__dataclass_fields__:
        yield kind(**values, drive=DRIVE)  # type: ignore[call-arg]  # not every mechanism has one


def _content(pairs: Sequence[tuple[Mechanism, FrictionLaw]], done: WarmUp) -> dict[str, Any]:
    return {
        "pairs": [
            {"mechanism": rig.name, "drives": list(rig.drives()), "law": law.name}
            for rig, law in pairs
        ],
        "kernels": {"compiled": done.kernels_compiled, "found": done.kernels_found},
        "equations": {"compiled": done.equations_compiled, "found": done.equations_found},
        "seconds": done.seconds,
        "cache": str(done.folder),
    }


def _sentence(done: WarmUp) -> str:
    return (
        f"Compiled in {done.seconds:.1f} s: kernels {done.kernels_compiled}, equations"
        f" {done.equations_compiled}. There already: kernels {done.kernels_found}, equations"
        f" {done.equations_found}. Cache: {done.folder}"
    )
