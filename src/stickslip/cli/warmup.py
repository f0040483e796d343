"""``stickslip warmup`` and ``stickslip doctor``: what is compiled, and what is installed."""

import dataclasses
import importlib.metadata
import math
import os
import platform
import re
import sys
import time
import typing
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

from stickslip.cli.console import note, print_json, stdout
from stickslip.cli.options import JsonOption, WarmupOptions
from stickslip.cli.progress import Compiling
from stickslip.data import Rig, load_rig
from stickslip.data.catalogue import cache_folder, dataset, names
from stickslip.engine.executors import THREADS, threads
from stickslip.engine.simulation import simulate
from stickslip.engine.solver import EventDriven, WarmUp, warm_up
from stickslip.errors import InputError, SimulationError, StickslipError
from stickslip.friction import Coulomb, FrictionLaw, law_type, listed
from stickslip.friction import laws as known_laws
from stickslip.identify.fits import starting_law
from stickslip.mechanisms import Mechanism, Motor, Prescribed, SpringBlock, Torque
from stickslip.mechanisms import mechanisms as known_mechanisms
from stickslip.mechanisms.drives import Drive, Pulse, ThreePhase
from stickslip.quantities import fields_of, named
from stickslip.show.documents import document
from stickslip.show.formatting import count, joined

# ``stickslip warmup``.

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
    return [known_laws()[name] for name, entry in listed().items() if not entry.on_request]


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
    required = [field.name for field in dataclasses.fields(kind) if _is_required(field)]
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


# ``stickslip doctor``: facts by subject, which a document has as they are and a terminal in words.

Facts = dict[str, Any]
REQUIREMENT: Final = re.compile(r"([\w.-]+)[^;]*(?:;.*extra == ['\"](\w+)['\"])?.*")
FOR_CONTRIBUTORS: Final = {"bench", "dev", "docs"}
"""Extras that no command needs."""
BLOCK: Final = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW: Final = Coulomb(kinetic_coefficient=0.25)
TIERS: Final = {
    "plain Python": EventDriven(tier="python"),
    "machine code": EventDriven(tier="compiled"),
}
CLOSE: Final = 1e-9
"""Largest relative error of the self-test: that to which events are located, with room."""


def run_doctor(options: JsonOption) -> None:
    """Look at everything that commands stand on, and test it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of folders, which are said below
        facts: Facts = {
            "versions": _tried(_versions),
            "system": _tried(_system),
            "extras": _tried(_extras),
            "cache": _tried(_cache),
            "threads": _tried(_threads),
            "compiler": {"for FMUs": _compiler()},
            "data": _tried(_data),
            "self-test": {name: _tried(partial(_self_test, tier)) for name, tier in TIERS.items()},
        }
    facts = _without_home(facts)
    failed = [tier for tier, fact in facts["self-test"].items() if "error" in fact]
    if options.as_json:
        print_json(document("doctor", facts))
    else:
        width = max(map(len, facts)) + 2
        for subject, results in facts.items():
            stdout().print(f"{subject:<{width}}{_in_words(results)}")
    if failed:
        raise SimulationError(f"the self-test failed in {joined(failed)}.")


def _without_home(found: Any) -> Any:
    """Return facts with ~ for the folder of the user, whose name is nobody's business."""
    if isinstance(found, Mapping):
        return {name: _without_home(value) for name, value in found.items()}
    if isinstance(found, list):
        return [*map(_without_home, found)]
    home = re.escape(str(Path.home()))
    return re.sub(rf"(?<!\S){home}(?![^\s/\\;])", "~", found) if isinstance(found, str) else found


def _in_words(found: Any, between: str = "; ") -> str:
    if isinstance(found, Mapping):
        return between.join(f"{name} {_in_words(value, ', ')}" for name, value in found.items())
    if isinstance(found, float):
        return f"{found:.2g}"
    return (", ".join(found) or "none") if isinstance(found, list) else str(found)


def _tried(look: Callable[[], Facts]) -> Facts:
    """Return facts, or the error that stands in their way."""
    try:
        return look()
    except (StickslipError, OSError) as error:
        return {"error": str(error)}
    except Exception as error:  # whatever is wrong with an installation is what is asked for
        return {"error": f"{type(error).__name__}: {error}"}


def _required() -> dict[str, list[str]]:
    """Return the names of packages by extra; those that are always needed are under no name."""
    result: dict[str, list[str]] = {}
    for line in importlib.metadata.requires("stickslip") or ():
        match = REQUIREMENT.fullmatch(line)
        if match is not None:
            result.setdefault(match[2] or "", []).append(match[1])
    return result


def _version_of(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return ""


def _versions() -> Facts:
    packages = ["stickslip", *_required()[""]]
    return {name: _version_of(name) or "missing" for name in packages}


def _system() -> Facts:
    from llvmlite import binding

    return {
        "Python": f"{platform.python_implementation()} {platform.python_version()}",
        "in": sys.prefix,
        "on": platform.platform(),
        "processor": f"{binding.get_host_cpu_name()} ({binding.get_process_triple()})",
    }


def _extras() -> Facts:
    """Tell extras whose packages are all there from others, with what is missing."""
    there: list[str] = []
    absent: list[str] = []
    for extra, packages in sorted(_required().items()):
        missing = [name for name in packages if not _version_of(name)]
        if extra and extra not in FOR_CONTRIBUTORS:
            (absent if missing else there).append(extra)
    return {"present": there, "absent": absent}


def _cache() -> Facts:
    done = warm_up([])  # the kernels
    images = [path.stat().st_size for path in done.folder.glob("*.image")]
    return {
        "folder": str(done.folder),
        "files": len(images),
        "bytes": sum(images),
        "kernels": f"compiled in {done.seconds:.1f} s" if done.kernels_compiled else "there",
    }


def _threads() -> Facts:
    import scipy.linalg  # noqa: F401  # which brings linear algebra of its own
    from threadpoolctl import threadpool_info

    return {
        "cores": os.cpu_count(),
        "used": threads(),
        THREADS: os.environ.get(THREADS, "not set"),
        "linear algebra": [
            f"{pool['internal_api']} {pool['version']} with {count(pool['num_threads'], 'thread')}"
            for pool in threadpool_info()
        ],
    }


def _compiler() -> str:
    from stickslip.cli.export import linker

    return linker()


def _data() -> Facts:
    places = Counter(
        record.place(file).value for record in map(dataset, names()) for file in record.files
    )
    return {
        "STICKSLIP_DATA": os.environ.get("STICKSLIP_DATA", "not set"),
        "cache": str(cache_folder()),
        "files of the catalogue": dict(places),
    }


def _self_test(solver: EventDriven) -> Facts:
    """Simulate a block that a spring pushes; return the errors over its closed forms."""
    friction = LAW.kinetic_coefficient * BLOCK.mass * BLOCK.gravity
    back = friction / BLOCK.stiffness
    travel = 0.5 * BLOCK.stiffness * BLOCK.compression**2 / friction
    leaves = math.acos(-back / (BLOCK.compression - back)) / math.sqrt(BLOCK.stiffness / BLOCK.mass)
    begun = time.perf_counter()
    run = simulate(BLOCK, LAW, t_end=2.0, solver=solver)
    errors = {
        "travel": abs(float(run["x"][-1]) / travel - 1.0),
        "time of leaving": abs(run.events[0].t / leaves - 1.0),
    }
    if not max(errors.values()) < CLOSE:
        raise SimulationError(f"{errors} beside closed forms, where {CLOSE:g} is allowed.")
    return {**errors, "seconds": round(time.perf_counter() - begun, 3)}
