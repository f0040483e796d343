"""``stickslip plan``."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from stickslip.cli.numbers import number_of, range_of
from stickslip.cli.output import (
    command_line,
    document,
    note,
    overrides,
    plain,
    print_json,
    refuse_overwriting,
    show_table,
    stdout,
    write_folder,
)
from stickslip.cli.selected import laws_of
from stickslip.errors import InputError, ParameterError
from stickslip.experiments import Rig, load_rig
from stickslip.experiments.measurement import QUANTITIES
from stickslip.identification.travel import trials_of
from stickslip.quantities import Quantity, parameters
from stickslip.report.numbers import fixed, significant
from stickslip.selection import Plan, plan
from stickslip.selection.lab_sheet import in_unit, unit_of
from stickslip.selection.separation import knob_of, setting_text

__all__ = ["run"]


def run(
    path: Path | None,
    changes: Sequence[str],
    laws: str | None,
    between: str | None,
    settings: int,
    uncertainty: str | None,
    output: Path | None,
    *,
    allow_import: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Plan, write the sheet, show."""
    files = _files(output)
    for file in files:
        refuse_overwriting(file, file.parent, force=force)
    rig = load_rig(path, overrides=overrides(changes), allow_import=allow_import)
    measured = rig.measurement
    if measured is not None and not measured.travelled:
        measured = None
    if not as_json:
        note("Simulating what the laws predict ...")
    found = plan(
        rig.mechanism,
        laws_of(rig, laws),
        measurement=measured,
        doubts=rig.doubts,
        between=_between(rig, between),
        settings=settings,
        uncertainty=_uncertainty(uncertainty),
        t_end=rig.t_end,
    )
    if files:
        _write(found, rig, path, files)
    if as_json:
        head = {"rig": rig.title, "digest": rig.digest}
        print_json(document("plan", {**head, **found.to_dict(), "files": [*map(str, files)]}))
        return
    _show(found)
    if files:
        stdout().print(f"\nWritten: {', '.join(map(str, files))}", markup=False)


def _files(output: Path | None) -> list[Path]:
    """Return the sheet and the table beside it."""
    if output is None:
        return []
    if output.suffix.lower() not in (".html", ".htm"):
        raise InputError(
            f"a sheet is written as .html, with its table as .csv beside it, got {output}."
        )
    return [output, output.with_suffix(".csv")]


def _between(rig: Rig, text: str | None) -> tuple[float, float] | None:
    """Return the ends of a range, in the unit of what is set."""
    if text is None:
        return None
    travels = rig.measurement is not None and rig.measurement.travelled
    done = (
        trials_of(rig.mechanism, rig.measurement, rig.t_end) if travels and rig.measurement else ()
    )
    knob = knob_of(rig.mechanism, done)
    known: Mapping[str, Quantity] = {p: q for p, q, _ in parameters(rig.mechanism, "mechanism")}
    quantity = QUANTITIES["travel"] if knob is None else known[knob[0]]
    return range_of("--between", text, quantity)


def _uncertainty(text: str | None) -> float | None:
    if text is None:
        return None
    try:
        return number_of(text, Quantity("u_s", "m", above=0))
    except ParameterError as error:
        raise ParameterError(f"--uncertainty {error}") from None


def _write(found: Plan, rig: Rig, path: Path | None, files: Sequence[Path]) -> None:
    from stickslip.report.page import render
    from stickslip.report.plans import plan_page
    from stickslip.report.versions import versions

    sheet, table = files
    name = "" if path is None else f" {path}"
    page = plan_page(
        found,
        title=rig.title,
        subject=rig.subject or rig.path,
        save_as=f"stickslip select{name} --data {table.name}",
        reproduce=[command_line()],
        versions=versions(),
        digest=rig.digest,
    )
    write_folder(sheet.parent, {sheet.name: render(page), table.name: found.csv()})


def _show(found: Plan) -> None:
    console = stdout()
    titles = {name: law.title for name, law in found.laws.items()}
    console.print(found.sentence, markup=False, style="bold")
    if found.assumed:
        console.print(
            "That uncertainty, 2 % of the longest travel, is assumed: repeat one setting and give"
            " the scatter as --uncertainty.",
            markup=False,
        )
    for line in found.remarks:
        console.print(f"! {plain(line)}", markup=False, style="yellow")
    console.print()
    rows = [
        [
            f"{one.name} {one.quantity.symbol}",
            in_unit(one.value, one.quantity.unit, 4),
            in_unit(one.needed, one.quantity.unit),
            one.verdict,
            one.how,
        ]
        for one in found.preparations
    ]
    heads = ["before the runs", "in the rig", "know it to", "stated", "how"]
    show_table("", heads, rows, whole=heads[:3])
    for head, text in found.rest.items():
        console.print(f"  {plain(head)}: {plain(text)}", markup=False)
    _show_settings(found, titles)
    _show_laws(found, titles)
    head, *_ = found.csv().splitlines()
    console.print("\nSave the travels as a CSV file with these columns", markup=False, style="bold")
    console.print(f"  {head}", markup=False)


def _show_settings(found: Plan, titles: Mapping[str, str]) -> None:
    unit, factor = unit_of(found.settings[0].unit)
    rows = [
        [
            f"{factor * row.value:.10g}",
            *(fixed(1e3 * row.predicted[name], 1) for name in found.laws),
        ]
        for row in found.settings
    ]
    title = f"\nTravel predicted [mm], {found.repeats} runs each"
    stdout().print(title, markup=False, style="bold")
    show_table("", [f"{found.knob} [{unit}]", *titles.values()], rows)


def _show_laws(found: Plan, titles: Mapping[str, str]) -> None:
    console = stdout()
    if found.tellings:
        console.print("\nWhich laws they tell apart", style="bold")
        rows = [
            [
                titles[one.holds],
                titles[one.rival],
                in_unit(one.gap, "m"),
                setting_text(one.setting),
                one.effort,
            ]
            for one in found.tellings
        ]
        heads = ["if this holds", "this is ruled out", "difference", "at", "by"]
        show_table("", heads, rows, whole=heads[2:4])
    console.print("\nWhat they will tell of each law", style="bold")
    rows = [
        [
            titles[one.law],
            one.estimate.quantity.symbol,
            significant(one.estimate.value, 3),
            "" if one.estimate.quantity.unit == "1" else one.estimate.quantity.unit,
            one.estimate.range,
            "" if one.identified else "not identified",
        ]
        for one in found.expectations
    ]
    heads = ["law", "", "if it is", "unit", "expected interval (95 %)", ""]
    show_table("", heads, rows, whole=heads[1:])
    for line in dict.fromkeys(one.advice for one in found.expectations if one.advice):
        console.print(f"  {plain(line)}", markup=False)
