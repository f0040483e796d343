"""``stickslip sweep campaign.toml``: the file of a campaign, and its runs."""

import dataclasses
import os
import time
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, cast

import typer

from stickslip.cli.console import note, print_json, show_table, stdout
from stickslip.cli.inputs import FILE, friction_of, friction_title, rig_and_friction
from stickslip.cli.options import LawOptions, SweepOptions
from stickslip.cli.progress import Drawing, Interrupts, workers
from stickslip.data import parse, read_bytes, read_number
from stickslip.engine.executors import Inline
from stickslip.engine.solver import (
    EventCount,
    EventTimes,
    Max,
    Mean,
    Min,
    Output,
    Samples,
    Sensitivity,
    path_units,
)
from stickslip.engine.solver import Final as Last
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError, ParameterError, UnknownNameError, concerning
from stickslip.quantities import Quantity, all_paths, full_path, parameters
from stickslip.show.documents import document, write_files
from stickslip.show.formatting import count, number, printable, quantity
from stickslip.study.sweep import (
    Campaign,
    CampaignRuns,
    Case,
    Estimate,
    Factor,
    Levels,
    Normal,
    SensitivityIndices,
    Uniform,
)

CANCELLED: Final = 130
KEYS: Final = ("rigs", "laws", "t_end", "design", "runs", "seed", "part", "factors", "outputs")
KINDS: Final[Mapping[str, type[Output]]] = {
    "final": Last,
    "max": Max,
    "min": Min,
    "mean": Mean,
    "samples": Samples,
    "event-times": EventTimes,
    "event-count": EventCount,
    "sensitivity": Sensitivity,
}
"""Outputs by the key that says of which state or event they are."""
FACTORS: Final[Mapping[str, type[Factor]]] = {"values": Levels, "mean": Normal, "low": Uniform}
"""Factors by the key that only they have, or have to have."""
TIMES: Final = ("since", "last", "times")
TIME: Final = Quantity("t", "s")
SIZE: Final = (700, 320)
CUT_SHORT: Final = (
    "Outputs of runs that ended early are those of the time up to then, or empty: see their status."
)


def run(options: SweepOptions) -> None:
    """Read the file, make the runs that are missing, show what is there."""
    given = {
        "--law": options.law,
        "--law-load": options.law_load,
        "--set": options.changes,
        "--coordinate": options.coordinate,
        "--ensemble": options.draws,
    }
    if unused := [option for option, value in given.items() if value]:
        raise InputError(
            f"{unused[0]} applies to a rig file with --vary PATH=LOW:HIGH:N; a campaign file says"
            " rigs, laws and factors itself."
        )
    if options.rig is None:
        raise InputError("give a campaign file, or a rig file with --vary PATH=LOW:HIGH:N.")
    folder, count = options.output or Path("stickslip-campaign"), options.count
    plans, cases = _read(options.rig, allow_import=options.allow_import)
    if options.dry_run:
        shared = 1 if options.executor else count or os.cpu_count() or 1
        _show_estimate(plans.estimate(), cases, shared, as_json=options.as_json)
        return
    begun = time.perf_counter()
    with (
        Interrupts() as interrupts,
        Drawing("Running", "runs") as bar,
        workers(count or 1, options.executor) as pool,
    ):
        interrupts.promise = "Stopping after the files in work; press Ctrl-C again to cancel."

        def progress(done: int, total: int) -> bool:
            bar(done, total)
            return not interrupts.stopped

        inline = Inline() if count == 1 else None
        found = plans.run(folder, executor=pool or inline, progress=progress, replace=options.force)
    took = time.perf_counter() - begun
    if not found.complete:
        note(f"{len(found)} of {len(plans)} runs are there: the same command goes on.")
        raise typer.Exit(CANCELLED)
    indices = _indices(plans, found, cases)
    if options.as_json:
        rows = {index.output: index.to_dataframe().to_dict("records") for index in indices}
        content = {
            "runs": len(found),
            "certified": found.certified,
            "status": found.status,
            "meaning": {name: Status[name].value for name in found.status},
            "files": len(found.parts),
            "bytes": found.size,
            "made": found.made,
            "seconds": took,
            "sensitivity": rows,
            "folder": str(folder),
        }
        print_json(document("campaign-runs", content))
        return
    _show(found, indices, cases, took)


def _indices(
    plans: Campaign, found: CampaignRuns, cases: Sequence[str]
) -> list[SensitivityIndices]:
    """Return the indices of each output that is one number, and write them beside the runs."""
    if plans.whole.block == 1:
        return []
    if len(cases) > 1:
        note("Sensitivity indices are of one case: make a campaign of each.")
        return []
    import pandas as pd

    from stickslip.show.plots import draw_sensitivity, standalone_svg

    indices = []
    for name in plans.outputs or found.units:
        several = f"{name}.0" in found.units or name in plans.factors or name not in found.columns
        if several:
            continue
        try:
            indices.append(found.sensitivity(name))
        except InputError as error:
            note(str(error))
    if indices:
        table = pd.concat([index.to_dataframe().assign(output=index.output) for index in indices])
        size = (SIZE[0], SIZE[1] * len(indices))
        svg = standalone_svg(draw_sensitivity(indices), size=size, title="Sensitivity indices")
        rows = table[["output", *(column for column in table if column != "output")]]
        files = {"sensitivity.csv": rows.to_csv(index=False), "sensitivity.svg": svg}
        write_files({found.folder / name: content for name, content in files.items()})
    return indices


def _show_estimate(found: Estimate, cases: Sequence[str], shared: int, *, as_json: bool) -> None:
    if as_json:
        content = {**dataclasses.asdict(found), "workers": shared, "cases": [*cases]}
        print_json(document("campaign-estimate", content))
        return
    console = stdout()
    for case in cases:
        console.print(printable(case))
    console.print(
        f"{count(found.runs, 'run')} in {count(found.files, 'file')}, about {_size(found.size)};"
        f" about {quantity(found.seconds / shared, 's', 2)} on {count(shared, 'core')} like these."
    )


def _size(size: float) -> str:
    return f"{number(size / 1e9)} GB" if size >= 1e9 else f"{number(size / 1e6)} MB"


def _show(
    found: CampaignRuns, indices: Sequence[SensitivityIndices], cases: Sequence[str], took: float
) -> None:
    console = stdout()
    for case in cases:
        console.print(printable(case))
    console.print(
        f"{count(len(found), 'run')}, {found.certified:,} certified, in"
        f" {count(len(found.parts), 'file')}"
        f" ({_size(found.size)})."
    )
    for name, runs in found.status.items():
        console.print(f"  {name}: {runs:,}. {Status[name].value}")
    if any(not Status[name].complete for name in found.status):
        console.print(CUT_SHORT)
    if found.made:
        console.print(
            f"{found.made:,} runs were made in {quantity(took, 's')}, {found.made / took:,.0f} a"
            " second."
        )
    for index in indices:
        console.print(f"\n{index.sentence}")
        rows = [
            [path, *(index.text_of(name, place) for name in index.indices)]
            for place, path in enumerate(index.factors)
        ]
        show_table("", ["factor", *index.indices], rows)
    console.print(f"\nWritten: {found.folder}")


def _read(path: Path, *, allow_import: bool) -> tuple[Campaign, list[str]]:
    """Return the campaign of a file, and its cases in words."""
    file = str(path)
    raw = parse(read_bytes(path), file)
    if "mechanism" in raw:
        raise InputError(
            f"{file} is a rig file: say what varies, as --vary PATH=LOW:HIGH:N, or name it in a"
            ' campaign file, as rigs = "..." beside [factors].'
        )
    _known(raw, KEYS, file)
    rigs = _named(raw, "rigs", file)
    laws = _named(raw, "laws", file) if "laws" in raw else {"": ""}
    cases, titles = [], []
    for rig_name, rig_text in rigs.items():
        for law_name, law_text in laws.items():
            source = None if rig_text == "demo" else path.parent / rig_text
            law = str(path.parent / law_text) if FILE.fullmatch(law_text) else law_text
            options = LawOptions(rig=source, law=law or None, allow_import=allow_import)
            rig, chosen = rig_and_friction(options)
            friction = friction_of(chosen)
            labels = {"rig": rig_name} if len(rigs) > 1 else {}
            labels |= {"law": law_name} if len(laws) > 1 else {}
            last = _read_value(raw, "t_end", TIME, file) if "t_end" in raw else rig.t_end
            start = rig.start(friction)
            cases.append(
                Case(mechanism=rig.mechanism, law=friction, t_end=last, y0=start, labels=labels)
            )
            titles.append(f"{rig.heading}, {friction_title(chosen)} friction")
    campaign = Campaign(
        cases=tuple(cases),
        factors=_factors(raw.get("factors"), cases[0], file),
        outputs=_outputs(raw.get("outputs"), file),
        **{key: raw[key] for key in ("design", "runs", "seed", "part") if key in raw},
    )
    return campaign, titles


def _known(table: object, known: Collection[str], where: str) -> None:
    """Refuse what is no table, and keys that are not known."""
    if not isinstance(table, dict):
        raise InputError(f"{where} must be a table, got {table!r}.")
    for key in table:
        if key not in known:
            raise UnknownNameError(f"key of {where}:", key, known)


def _named(raw: Mapping[str, Any], key: str, file: str) -> dict[str, str]:
    """Return files or names by what they are called: those given, or their own."""
    given = raw.get(key)
    if isinstance(given, str):
        given = [given]
    if isinstance(given, list) and given and all(isinstance(law, str) for law in given):
        given = {Path(law).stem if law.endswith(".toml") else law: law for law in given}
        if len(given) < len(raw[key]) and not isinstance(raw[key], str):
            raise InputError(f'{file}: {key} have equal names: give them as a = "...", b = "...".')
    if not (given and isinstance(given, dict) and all(isinstance(x, str) for x in given.values())):
        raise InputError(
            f"{file}: {key} must be a file or a name, a list of them, or a table of them, got"
            f" {given!r}."
        )
    return given


def _factors(table: object, case: Case, file: str) -> dict[str, Factor]:
    """Return what varies, by full path."""
    where = f"[factors] of {file}"
    if not isinstance(table, dict) or not table:
        raise InputError(
            f'{where} is missing: say what varies, such as "friction.kinetic_coefficient" ='
            " {low = 0.2, high = 0.3}."
        )
    varying = _varying(case)
    found = {}
    for name, given in _leaves(table):
        path = full_path(name, varying)
        known = varying[path]
        own: Any = given if isinstance(given, dict) else {"values": given}
        kind = next((FACTORS[key] for key in FACTORS if key in own), None)
        at = f"{name} in {where}"
        if kind is None:
            raise InputError(f"{at} needs values, or low and high, or mean and sd.")
        fields = {field.name for field in dataclasses.fields(kind)}
        _known(own, fields, at)
        for key, kinds, said in (("times", str, "the path of a factor"), ("log", bool, "a bool")):
            if key in own and not isinstance(own[key], kinds):
                raise InputError(f"{at}: {key} must be {said}, got {own[key]!r}.")
        needed = [field.name for field in dataclasses.fields(kind) if _needed(field)]
        if lacking := [key for key in needed if key not in own]:
            raise InputError(f"{at} lacks {' and '.join(lacking)}.")
        if own.get("times"):
            known = Quantity(known.symbol)
            own = {**own, "times": full_path(own["times"], varying)}
        read: dict[str, Any] = {}
        for key, value in own.items():
            wanted = Quantity(known.symbol, known.unit) if key == "sd" else known
            if key in ("number", "log", "times"):
                read[key] = value
            elif key == "values" and isinstance(value, list):
                read[key] = [_number(text, wanted, f"{at}: {key}") for text in value]
            else:
                read[key] = _number(value, wanted, f"{at}: {key}")
        try:
            found[path] = cast("Any", kind)(**read)
        except (ParameterError, TypeError) as error:
            raise ParameterError(f"{at}: {error}") from None
    return found


def _varying(case: Case) -> dict[str, Quantity]:
    """Return what may vary, by full path; what was not given as well, as in `ensemble`."""
    roots = ((cast("Any", case.mechanism), "mechanism"), (cast("Any", case.law), "friction"))
    declared = {path: measured for root in roots for path, measured in all_paths(*root).items()}
    ranges = {path: known for root in roots for path, known, _ in parameters(*root)}
    units = path_units(case.mechanism, cast("Any", case.law))
    return declared | {
        path: ranges.get(path, Quantity(path.rpartition(".")[2], unit))
        for path, unit in units.items()
    }


def _needed(field: "dataclasses.Field[Any]") -> bool:
    return field.default is dataclasses.MISSING


def _leaves(table: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Return what stands at each dotted path, of which TOML makes tables without quotes."""
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        inner = (
            isinstance(value, dict) and value and all(isinstance(x, dict) for x in value.values())
        )
        found += _leaves(value, f"{prefix}{key}.") if inner else [(f"{prefix}{key}", value)]
    return found


def _number(value: object, known: Quantity, where: str) -> float:
    with concerning(where):
        return read_number(value, known)


def _read_value(raw: Mapping[str, Any], key: str, known: Quantity, file: str) -> float:
    return _number(raw[key], known, f"{file}: {key}")


def _outputs(table: object, file: str) -> dict[str, Output] | None:
    """Return what is kept of each run, by name."""
    if table is None:
        return None
    where = f"[outputs] of {file}"
    _known(table, [*cast("dict[str, Any]", table)] if isinstance(table, dict) else [], where)
    found: dict[str, Output] = {}
    for name, own in cast("dict[str, Any]", table).items():
        at = f"{name} in {where}"
        kind = next((key for key in KINDS if isinstance(own, dict) and key in own), None)
        if kind is None:
            raise InputError(f'{at} needs one of {", ".join(KINDS)}, such as {{final = "x"}}.')
        first, *others = [field.name for field in dataclasses.fields(cast("Any", KINDS[kind]))]
        _known(own, [kind, *others], at)
        if "times" in own and not isinstance(own["times"], list):
            raise InputError(f"{at}: times must be a list, got {own['times']!r}.")
        read = {
            key: [_number(text, TIME, f"{at}: {key}") for text in value]
            if isinstance(value, list)
            else _number(value, TIME, f"{at}: {key}")
            if key in TIMES
            else value
            for key, value in own.items()
            if key != kind
        }
        try:
            found[name] = cast("Any", KINDS[kind])(**{first: own[kind], **read})
        except TypeError:
            raise InputError(f"{at} needs {', '.join([kind, *others])}.") from None
    return found
