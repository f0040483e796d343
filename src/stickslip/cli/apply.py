"""``stickslip apply``."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip.cli.console import print_json, show_table, stdout
from stickslip.cli.export import by_option, law_source, loads, stated
from stickslip.cli.law_choice import check_named
from stickslip.cli.options import ApplyOptions
from stickslip.documents import document
from stickslip.errors import InputError
from stickslip.experiments import Measurement, Reading, Rig, load_rig, read_data
from stickslip.exports import Applied, AppliedJoint, apply, check_output
from stickslip.formatting import NO_VALUE, quantity
from stickslip.friction import FrictionLaw
from stickslip.quantities import Given, turned

BESIDE = "law.toml"
"""What `select` and `fit` write beside a document about a law."""


def run(
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
    beside = path.with_name(BESIDE)
    if path.name == "verdict.json" and beside.exists():
        return beside
    raise InputError(
        f"{path}: a document about a law does not say all of its mechanism, such as dampers that"
        f" the joint needs; give the {BESIDE} that `stickslip select` writes beside its report, or"
        f" that of `stickslip fit -o {BESIDE}`."
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
