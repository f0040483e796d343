"""``stickslip warmup``."""

import dataclasses
import typing
from collections.abc import Iterator, Sequence
from typing import Any

from stickslip.cli.console import note, print_json, stdout
from stickslip.cli.options import WarmupOptions
from stickslip.cli.progress import Compiling
from stickslip.data import Rig, load_rig
from stickslip.engine.solver import WarmUp, warm_up
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, law_type, listed
from stickslip.friction import laws as known_laws
from stickslip.identify.fits import starting_law
from stickslip.mechanisms import Mechanism, Motor, Prescribed, Torque
from stickslip.mechanisms import mechanisms as known_mechanisms
from stickslip.mechanisms.drives import Drive, Pulse, ThreePhase
from stickslip.quantities import fields_of, named
from stickslip.show.documents import document

PULSE = Pulse(level=1.0, duration=1.0)
SWING = ThreePhase(amplitude=1.0, fast=2.0, slow=1.0)
MOTORS = (Torque(drive=PULSE), Prescribed(profile=SWING))
"""A pulse for all drives: the equations of another one are compiled when it is first run."""


def run(options: WarmupOptions) -> None:
    """Compile, and say what was done."""
    if options.rig is not None and options.mechanisms:
        raise InputError("give --rig or --mechanism, not both: a rig file names its own mechanism.")
    if options.rig is not None:
        pairs = _of_rig(load_rig(options.rig, allow_import=options.allow_import), options.laws)
    else:
        pairs = _of_registry(options.mechanisms, options.laws)
    with Compiling() as progress:
        try:
            done = warm_up(pairs, progress=progress)
        except KeyboardInterrupt:
            note("Equations compiled so far stay in the cache.")
            raise
    if options.as_json:
        print_json(document("warmup", _content(pairs, done)))
    else:
        stdout().print(_sentence(done))


def _names(laws: str | None) -> list[str]:
    return [] if laws is None else [name.strip() for name in laws.split(",")]


def _of_rig(rig: Rig, laws: str | None) -> list[tuple[Mechanism, FrictionLaw]]:
    """Return the mechanism of a rig with the laws that `stickslip select` would try."""
    if rig.contacts:
        raise InputError(
            f"warmup compiles one law, but {rig.heading} has laws of {', '.join(rig.contacts)}:"
            " their equations are compiled when they are first needed."
        )
    if laws is None:
        own = list(rig.laws.values()) or [starting_law(law) for law in _unasked()]
        return [(rig.mechanism, law) for law in own]
    return [
        (rig.mechanism, rig.laws.get(name) or starting_law(law_type(name)))
        for name in map(rig.name_of, _names(laws))
    ]


def _unasked() -> list[type[FrictionLaw]]:
    """Return the laws that are tried where none is named."""
    return [known_laws()[name] for name, one in listed().items() if not one.on_request]


def _of_registry(names: Sequence[str], laws: str | None) -> list[tuple[Mechanism, FrictionLaw]]:
    """Return mechanisms by name, without and with a drive, with laws; all if none are named."""
    known = known_mechanisms()
    kinds = [named(known, name, "mechanism") for name in names] or list(known.values())
    for kind in kinds if names else ():
        if not any(_variants(kind)):
            raise InputError(
                f"{kind.name} is made of parts, of which there are no usual ones: give a rig file"
                " with --rig."
            )
    chosen = [law_type(name) for name in _names(laws)] or _unasked()
    starts = [starting_law(law) for law in chosen]
    return [(rig, law) for kind in kinds for rig in _variants(kind) for law in starts]


def _variants(kind: type[Mechanism]) -> Iterator[Mechanism]:
    """Yield a mechanism with ordinary numbers, without and, if it takes any, with drives."""
    quantities = fields_of(kind)
    values: dict[str, Any] = {
        field.name: min(max(1.0, quantities[field.name].low), quantities[field.name].high)
        for field in dataclasses.fields(kind)
        if field.name in quantities and field.default is dataclasses.MISSING
    }
    required = [one.name for one in dataclasses.fields(kind) if _is_required(one)]
    if set(required) - values.keys():  # parts, of which there are no ordinary ones
        return
    yield kind(**values)
    hints = typing.get_type_hints(kind)
    for name, hint in hints.items():
        if hint is Motor:
            yield from (kind(**values, **{name: motor}) for motor in MOTORS)
    drives = [
        name
        for name, hint in hints.items()
        if name.endswith("drive") and Drive in typing.get_args(hint)
    ]
    if drives:
        yield kind(**values, **dict.fromkeys(drives, PULSE))


def _is_required(field: "dataclasses.Field[Any]") -> bool:
    absent = dataclasses.MISSING
    return field.default is absent and field.default_factory is absent


def _content(pairs: Sequence[tuple[Mechanism, FrictionLaw]], done: WarmUp) -> dict[str, Any]:
    return {
        "pairs": [
            {"mechanism": rig.name, "drives": list(rig.drives()), "law": law.name}
            for rig, law in pairs
        ],
        "kernels": {"compiled": done.kernels_compiled},
        "equations": {"compiled": done.equations_compiled, "found": done.equations_found},
        "seconds": done.seconds,
        "cache": str(done.folder),
    }


def _sentence(done: WarmUp) -> str:
    kernels = "compiled" if done.kernels_compiled else "in the cache"
    return (
        f"Kernels: {kernels}. Equations: {done.equations_compiled} compiled,"
        f" {done.equations_found} in the cache. Time: {done.seconds:.1f} s. Cache: {done.folder}"
    )
