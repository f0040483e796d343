"""``stickslip export`` and ``stickslip apply``: laws handed over to other programs."""

import contextlib
import tomllib
from collections.abc import Iterator, Mapping, Sequence, Set
from pathlib import Path
from typing import Any

from stickslip.cli.console import print_json, refuse_overwriting, show_table, stdout
from stickslip.cli.inputs import check_named, friction_of, friction_title, rig_and_friction
from stickslip.cli.options import ApplyOptions, ExportOptions, LawOptions
from stickslip.data import LOAD, Measurement, Reading, Rig, load_rig, read_data, read_number
from stickslip.errors import InputError, ParameterError
from stickslip.exports import (
    TARGETS,
    Applied,
    AppliedJoint,
    apply,
    check_output,
    compiler_here,
    export,
    export_fmu,
    identifier,
)
from stickslip.friction import FrictionLaw
from stickslip.quantities import Given, Quantity, named, turned
from stickslip.show.documents import document, regular_bytes
from stickslip.show.formatting import NO_VALUE, quantity

# ``stickslip export``.


def linker() -> str:
    """Return the C compiler that links FMUs, or why there is none."""
    try:
        return compiler_here()
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


def run_export(
    path: Path,
    to: str,
    wanted: ExportOptions,
    output: Path,
    *,
    allow_import: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Export the law of a file, and write what its target takes."""
    known = named({**TARGETS, FMU: None}, to, "target")
    if path.suffix.lower() in RESULT_FILES:
        raise InputError(
            f"export takes a TOML file with a law, got {path}: give the law.toml that `stickslip"
            f" select` writes beside its report, as {path.with_name('law.toml')}."
        )
    check_named(path)
    _refuse_foreign(to, wanted)
    if known is None:
        _export_fmu(path, wanted, output, allow_import=allow_import, force=force, as_json=as_json)
        return
    target = known
    refuse_overwriting(output, output, force=force)
    source = law_source(path, wanted.law, allow_import=allow_import)
    rig = None if wanted.rig is None else load_rig(wanted.rig, allow_import=allow_import)
    load, law_load = loads(wanted.load, wanted.law_load)
    with by_option():
        found = export(
            source,
            to,
            name=wanted.name,
            law=wanted.law if isinstance(source, Rig) else None,
            contact=wanted.contact,
            load=load,
            law_load=law_load,
            largest_speed=wanted.largest_speed,
            rig=rig,
            at=stated(wanted.at or ()),
        )
    files = found.save(output, force=force)
    if as_json:
        content = {"target": to, "files": list(map(str, files)), "remarks": list(found.remarks)}
        print_json(document("export", content))
        return
    console = stdout()
    console.print(f"{target.title}: {', '.join(map(str, files))}", markup=False)
    for remark in found.remarks:
        console.print(f"  {remark}", markup=False)


def law_source(path: Path, law: str | None, *, allow_import: bool) -> Rig | FrictionLaw:
    """Return the rig of a file, or the law itself of one with laws alone."""
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
    found: FrictionLaw = named(laws, law or next(iter(laws)), "law")
    return found


def _refuse_foreign(to: str, wanted: ExportOptions) -> None:
    """Refuse options that the target has no use for."""
    if to == FMU:
        named_alone: dict[str, object] = {
            "--contact": wanted.contact,
            "--load": wanted.load,
            "--largest-speed": wanted.largest_speed,
            "--at": wanted.at or None,
        }
        cure = "such options are of targets for a law alone."
    else:
        named_alone = {
            "--input": wanted.inputs or None,
            "--t-end": wanted.t_end,
            "--fmi": None if wanted.fmi == ExportOptions.fmi else wanted.fmi,
        }
        cure = "such options are of --to fmu."
    given = [option for option, value in named_alone.items() if value is not None]
    if given:
        raise InputError(f"--to {to} does not take {', '.join(given)}: {cure}")


def _export_fmu(
    path: Path,
    wanted: ExportOptions,
    output: Path,
    *,
    allow_import: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Export a rig with its law as an FMU: into a file, or into a folder."""
    of, law_named = path, wanted.law
    if wanted.rig is not None:
        of, law_named = wanted.rig, str(path) if wanted.law is None else f"{path}:{wanted.law}"
    name = wanted.name if wanted.name is not None else of.stem
    file = output if output.suffix == ".fmu" else output / f"{identifier(name)}.fmu"
    refuse_overwriting(output, file.parent, force=force)
    asked = LawOptions(law=law_named, load=wanted.law_load)
    rig, chosen = rig_and_friction(of, (), asked, allow_import=allow_import)
    law = friction_of(chosen)
    export_fmu(
        rig.mechanism,
        law,
        file,
        t_end=rig.t_end if wanted.t_end is None else wanted.t_end,
        y0=rig.start(law),
        inputs=tuple(wanted.inputs or ()),
        fmi=2 if wanted.fmi == 2 else 3,
        name=name,
        title=f"{rig.heading}: {friction_title(chosen)}",
        force=force,
    )
    if as_json:
        print_json(document("export", {"target": FMU, "files": [str(file)], "remarks": []}))
        return
    stdout().print(f"FMU for FMI {wanted.fmi}.0: {file}", markup=False)


def stated(given: Sequence[str]) -> dict[str, Given]:
    """Return contact inputs by name: numbers, or texts with a unit."""
    found: dict[str, Given] = {}
    for one in given:
        name, equals, value = one.partition("=")
        if not equals or not value.strip():
            raise InputError(
                f"--at takes a contact input and its value, such as"
                f' --at "temperature=35 degC", got {one!r}.'
            )
        try:
            found[name.strip()] = float(value)
        except ValueError:
            found[name.strip()] = value.strip()
    return found


@contextlib.contextmanager
def by_option() -> Iterator[None]:
    """Let errors of arguments of `export` name the options of the command."""
    try:
        yield
    except ParameterError as error:
        said = f"{error}".replace("export.largest_speed", "--largest-speed")
        raise ParameterError(said.replace("export.at.", "--at ")) from None


def loads(load: str | None, law_load: str | None) -> tuple[float | None, float | None]:
    """Return the normal forces of the options `--load` and `--law-load`."""
    return _number("--load", load, LOAD), _number("--law-load", law_load, LOAD)


def _number(option: str, text: str | None, quantity: Quantity) -> float | None:
    if text is None:
        return None
    try:
        return read_number(text, quantity)
    except ParameterError as error:
        raise ParameterError(f"{option} {error}") from None


# ``stickslip apply``.

LAW_FILE = "law.toml"
"""What `select` and `fit` write beside a document about a law."""


def run_apply(
    path: Path,
    model: Path,
    wanted: ApplyOptions,
    output: Path,
    *,
    allow_import: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Write the laws of a file into a model, and print what that leaves of them."""
    path = _law_file(path)
    check_named(path)
    check_output(model, output, force=force)
    source = law_source(path, wanted.law, allow_import=allow_import)
    load, law_load = loads(wanted.load, wanted.law_load)
    with by_option():
        found = apply(
            source,
            model,
            joints=_paired(wanted.joints or ()),
            law=wanted.law if isinstance(source, Rig) else None,
            load=load,
            largest_speed=wanted.largest_speed,
            law_load=law_load,
            at=_by_contact(stated(wanted.at or ())),
            to=wanted.to,
            polynomial=wanted.polynomial,
            holds=wanted.holds,
            run=wanted.run,
            record=_record(wanted.record, source, allow_import=allow_import),
        )
    found.save(output, force=force)
    if as_json:
        print_json(document("apply", {"file": str(output), **found.to_dict()}))
        return
    _show(found, output)


def _by_contact(given: Mapping[str, Given]) -> dict[str, Given | dict[str, Given]]:
    """Return contact inputs by name; those of one contact, ``elbow.transmitted``, as a table."""
    found: dict[str, Any] = {}
    for key, value in given.items():
        contact, dot, name = key.partition(".")
        if dot:
            found.setdefault(contact, {})[name] = value
        else:
            found[key] = value
    return found


def _record(
    path: Path | None, source: Rig | FrictionLaw, *, allow_import: bool
) -> Measurement | None:
    """Return the record of a data file, or of a rig file."""
    if path is None:
        return None
    if path.suffix.lower() != ".toml":
        mechanism = source.mechanism if isinstance(source, Rig) else None
        return read_data([path], Reading(), mechanism=mechanism)
    found = load_rig(path, allow_import=allow_import).measurement
    if found is None:
        raise InputError(f"--record {path}: this rig file has no [data] with a file.")
    return found


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
    pairs = dict(one.split("=", 1) for one in given if "=" in one)
    if not pairs:
        return given
    if len(pairs) != len(given):
        raise InputError(
            f"--joint takes contacts with joints or joints alone, got both: {', '.join(given)}."
        )
    return pairs


def _show(found: Applied, output: Path) -> None:
    console = stdout()
    names = ", ".join(one.joint for one in found.joints)
    console.print(f"{output}: {found.path.name} with friction in {names}", markup=False)
    for one in found.joints:
        console.print(f"{one.joint}: {one.law}", markup=False)
        for line in one.sentences:
            console.print(f"  {line}", markup=False)
    rows = [row for one in found.joints for row in _rows(one)]
    if rows:
        heads = ("joint", "motion", "settings", "travel", "error in MuJoCo", "simplified alone")
        show_table("", heads, rows)
    replays = [row for one in found.joints for row in _replay_rows(one)]
    if replays:
        heads = (
            "joint", "on the record", "error of the force", "from the law", "error of the position",
            "from the law",
        )  # fmt: skip
        show_table("", heads, replays)
    for remark in found.remarks:
        console.print(remark, markup=False)


def _rows(joint: AppliedJoint) -> list[Sequence[str]]:
    length = turned("m", joint.rotary)
    return [
        (
            joint.joint,
            one.said,
            one.settings or "of the file",
            *(quantity(x, length) for x in (one.travel, one.error, one.simplification)),
        )
        for one in joint.motions
    ]


def _replay_rows(joint: AppliedJoint) -> list[Sequence[str]]:
    if joint.replay is None:
        return []
    force, length = turned("N", joint.rotary), turned("m", joint.rotary)
    return [
        (
            joint.joint,
            one.model,
            quantity(one.force, force),
            NO_VALUE if one.model == "law" else quantity(one.cost, force),
            quantity(one.position, length),
            NO_VALUE if one.model == "law" else quantity(one.drift, length),
        )
        for one in joint.replay.models
    ]
