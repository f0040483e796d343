"""``stickslip export`` and ``stickslip apply``: laws handed over to other programs."""

import contextlib
import tomllib
from collections.abc import Iterator, Mapping, Sequence, Set
from pathlib import Path
from typing import Any

from stickslip import exports
from stickslip.cli import console as terminal
from stickslip.cli.inputs import check_named, friction_title, rig_and_friction
from stickslip.cli.options import (
    ApplyOptions,
    ExportOptions,
    LawOfFileOptions,
    LawOptions,
    typed,
)
from stickslip.data import LOAD, Rig, load_rig
from stickslip.errors import InputError, ParameterError
from stickslip.friction import FrictionLaw
from stickslip.quantities import Given, named
from stickslip.show.documents import document, regular_bytes

# ``stickslip export``.


def linker() -> str:
    """Return the C compiler that links FMUs, or why there is none."""
    try:
        return exports.compiler_here()
    except InputError as error:
        return str(error)


FMU = "fmu"
"""The target that takes a rig with its law."""
ALONE = frozenset({"title", "friction"})
"""Tables of a file with laws and no mechanism."""
ANY_AXIS: dict[str, str | float | bool] = {"mechanism.type": "axis", "mechanism.inertia": 1.0}
"""What such a file is read with, and laws do not depend on."""
RESULT_FILES = (".json", ".html", ".csv")
"""Of a report, none of which is a rig file."""


def run_export(options: ExportOptions) -> None:
    """Export the law of a file, and write what its target takes."""
    path, to, output = options.file, options.to, options.output
    known = named({**exports.TARGETS, FMU: None}, to, "target")
    if path.suffix.lower() in RESULT_FILES:
        raise InputError(
            f"export takes a TOML file with a law, got {path}: give the law.toml that `stickslip"
            f" select` writes beside its report, as {path.with_name('law.toml')}."
        )
    check_named(path)
    _refuse_foreign(options)
    if known is None:
        _export_fmu(options)
        return
    target = known
    terminal.refuse_overwriting(output, output, force=options.force)
    source = law_source(options, path)
    rig = None
    if options.rig is not None:
        rig = load_rig(options.rig, allow_import=options.allow_import)
    load, law_load = loads(options)
    with by_option():
        result = exports.export(
            source,
            to,
            name=options.name,
            law=options.law if isinstance(source, Rig) else None,
            contact=options.contact,
            load=load,
            law_load=law_load,
            largest_speed=options.largest_speed,
            rig=rig,
            at=stated(options.at),
        )
    files = result.save(output, force=options.force)
    if options.as_json:
        content = {"target": to, "files": list(map(str, files)), "remarks": list(result.remarks)}
        terminal.print_json(document("export", content))
        return
    console = terminal.stdout()
    console.print(f"{target.title}: {', '.join(map(str, files))}")
    for remark in result.remarks:
        console.print(f"  {remark}")


def law_source(options: LawOfFileOptions, path: Path) -> Rig | FrictionLaw:
    """Return the rig of a file, or the law itself of one with laws alone."""
    law, allow_import = options.law, options.allow_import
    tables: Set[str] = frozenset()
    with contextlib.suppress(OSError, ValueError):  # said with its place when the rig is read
        tables = tomllib.loads(regular_bytes(path).decode("utf-8")).keys()
    if "friction" not in tables or not tables <= ALONE:
        return load_rig(path, allow_import=allow_import)
    rig = load_rig(path, overrides=ANY_AXIS, allow_import=allow_import)
    laws = {name: rig.laws[name] for name in rig.named or rig.laws}
    if law is None and len(laws) != 1:
        listed = ", ".join(laws) or "no law"
        raise InputError(f"{path} has {listed}: choose one law with --law.")
    result: FrictionLaw = named(laws, law or next(iter(laws)), "law")
    return result


def _refuse_foreign(options: ExportOptions) -> None:
    """Refuse options that the target has no use for."""
    names: tuple[str, ...]
    if options.to == FMU:
        names, cure = ("contact", "load", "largest_speed", "at"), "of targets for a law alone"
    else:
        names, cure = ("inputs", "t_end", "fmi"), "of --to fmu"
    if given := typed(options, *names):
        raise InputError(
            f"--to {options.to} does not take {', '.join(given)}: such options are {cure}."
        )


def _export_fmu(options: ExportOptions) -> None:
    """Export a rig with its law as an FMU: into a file, or into a folder."""
    of, law_named, output = options.file, options.law, options.output
    if options.rig is not None:
        of = options.rig
        law_named = f"{options.file}" + (f":{options.law}" if options.law is not None else "")
    name = options.name if options.name is not None else of.stem
    file = output if output.suffix == ".fmu" else output / f"{exports.identifier(name)}.fmu"
    terminal.refuse_overwriting(output, file.parent, force=options.force)
    rig, chosen = rig_and_friction(
        LawOptions(
            rig=of, law=law_named, law_load=options.law_load, allow_import=options.allow_import
        )
    )
    law = chosen.law
    exports.export_fmu(
        rig.mechanism,
        law,
        file,
        t_end=rig.t_end if options.t_end is None else options.t_end,
        y0=rig.start(law),
        inputs=tuple(options.inputs),
        fmi=2 if options.fmi == 2 else 3,
        name=name,
        title=f"{rig.heading}: {friction_title(chosen)}",
        force=options.force,
    )
    if options.as_json:
        terminal.print_json(
            document("export", {"target": FMU, "files": [str(file)], "remarks": []})
        )
        return
    terminal.stdout().print(f"FMU for FMI {options.fmi}.0: {file}")


def stated(given: Sequence[str]) -> dict[str, Given]:
    """Return contact inputs by name: numbers, or texts with a unit."""
    result: dict[str, Given] = {}
    for text in given:
        name, value = terminal.pair_of(
            text, '--at takes a contact input and its value, such as --at "temperature=35 degC"'
        )
        try:
            result[name] = float(value)
        except ValueError:
            result[name] = value
    return result


@contextlib.contextmanager
def by_option() -> Iterator[None]:
    """Let errors of arguments of `export` name the options of the command."""
    try:
        yield
    except ParameterError as error:
        said = f"{error}".replace("export.largest_speed", "--largest-speed")
        raise ParameterError(said.replace("export.at.", "--at ")) from None


def loads(options: ExportOptions | ApplyOptions) -> tuple[float | None, float | None]:
    """Return the normal forces of the options `--load` and `--law-load`."""
    pairs = (("--load", options.load), ("--law-load", options.law_load))
    load, law_load = (terminal.with_unit(option, text, LOAD) for option, text in pairs)
    return load, law_load


# ``stickslip apply``.

LAW_FILE = "law.toml"
"""What `select` and `fit` write beside a document about a law."""


def run_apply(options: ApplyOptions) -> None:
    """Write the laws of a file into a model, and print what that leaves of them."""
    path, model, output = _law_file(options.file), options.model, options.output
    check_named(path)
    exports.check_output(model, output, force=options.force)
    source = law_source(options, path)
    load, law_load = loads(options)
    with by_option():
        result = exports.apply(
            source,
            model,
            joints=_paired(options.joints),
            law=options.law if isinstance(source, Rig) else None,
            load=load,
            largest_speed=options.largest_speed,
            law_load=law_load,
            at=_by_contact(stated(options.at)),
            to=options.to,
            polynomial=options.polynomial,
            holds=options.holds,
        )
    result.save(output, force=options.force)
    if options.as_json:
        terminal.print_json(document("apply", {"file": str(output), **result.to_dict()}))
        return
    _show(result, output)


def _by_contact(given: Mapping[str, Given]) -> dict[str, Given | dict[str, Given]]:
    """Return contact inputs by name; those of one contact, ``elbow.transmitted``, as a table."""
    result: dict[str, Any] = {}
    for key, value in given.items():
        contact, dot, name = key.partition(".")
        if dot:
            result.setdefault(contact, {})[name] = value
        else:
            result[key] = value
    return result


def _law_file(path: Path) -> Path:
    """Return the file with the law: of a verdict that of the same folder."""
    if path.suffix.lower() != ".json":
        return path
    beside = path.with_name(LAW_FILE)
    if path.name == "verdict.json" and beside.exists():
        return beside
    raise InputError(
        f"{path}: a document about a law does not say all of its mechanism, such as dampers that"
        f" the joint needs; give the {LAW_FILE} that `stickslip select` writes beside its report,"
        f" or that of `stickslip fit -o {LAW_FILE}`."
    )


def _paired(given: Sequence[str]) -> Sequence[str] | Mapping[str, str] | None:
    """Return joints, or joints by contact."""
    if not given:
        return None
    pairs = dict(text.split("=", 1) for text in given if "=" in text)
    if not pairs:
        return given
    if len(pairs) != len(given):
        raise InputError(
            f"--joint takes contacts with joints or joints alone, got both: {', '.join(given)}."
        )
    return pairs


def _show(found: exports.Applied, output: Path) -> None:
    console = terminal.stdout()
    names = ", ".join(made.joint for made in found.joints)
    console.print(f"{output}: {found.path.name} with friction in {names}")
    for joint in found.joints:
        console.print(f"{joint.joint}: {joint.law}")
        for line in joint.sentences:
            console.print(f"  {line}")
    for remark in found.remarks:
        console.print(remark)
