"""``stickslip plan``."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from stickslip.cli.console import (
    command_line,
    note,
    overrides,
    plain,
    print_json,
    refuse_overwriting,
    show_table,
    stdout,
)
from stickslip.cli.law_choice import rig_with
from stickslip.cli.numbers import number_of, range_of
from stickslip.cli.select import laws_of
from stickslip.documents import document, regular_bytes, write_files
from stickslip.errors import InputError, ParameterError
from stickslip.experiments import Rig
from stickslip.kinds import TRAVEL_COLUMN, Plan, known_by, plan, setting_of, tables_of
from stickslip.quantities import Quantity, parameters


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
    _refuse_filled_in(files[1:])
    rig = rig_with(path, overrides(changes), allow_import=allow_import)
    measured = rig.measurement
    if measured is not None and not measured.travelled:
        measured = None
    range_asked = _between(setting_of(rig.mechanism, measured, rig.t_end), rig, between)
    if not as_json:
        note("Simulating the predictions of the laws ...")
    found = plan(
        rig.mechanism,
        laws_of(rig, laws),
        measurement=measured,
        parameter_uncertainties=rig.parameter_uncertainties,
        between=range_asked,
        settings=settings,
        uncertainty=_uncertainty(uncertainty),
        t_end=rig.t_end,
    )
    if files:
        _write(found, rig, path, files)
    if as_json:
        head = {"rig": rig.heading, "digest": rig.digest}
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
            "the lab sheet must be an .html file (its table is written beside it as .csv), got"
            f" {output}."
        )
    return [output, output.with_suffix(".csv")]


def _refuse_filled_in(tables: Sequence[Path]) -> None:
    """Refuse to replace a table with measured travels, or another one."""
    for table in filter(Path.exists, tables):
        try:
            text = regular_bytes(table).decode("utf-8", "replace")
            head, *rows = list(csv.reader(text.splitlines())) or [[]]
        except OSError as error:
            raise InputError(f"{table} cannot be read: {error.strerror or error}.") from None
        except csv.Error:  # a cell of megabytes is nobody's empty table
            head, rows = [], []
        if head[-1:] != [TRAVEL_COLUMN] or any(cell.strip() for row in rows for cell in row[2:]):
            raise InputError(
                f"{table} is no empty table of a lab sheet, so it is not replaced: move it, or give"
                " another -o."
            )


def _between(path: str, rig: Rig, text: str | None) -> tuple[float, float] | None:
    """Return the ends of a range, in the unit of what is set."""
    if text is None:
        return None
    known: Mapping[str, Quantity] = {p: q for p, q, _ in parameters(rig.mechanism, "mechanism")}
    return range_of("--between", text, known[path])


def _uncertainty(text: str | None) -> float | None:
    if text is None:
        return None
    try:
        return number_of(text, Quantity("u_s", "m", above=0))
    except ParameterError as error:
        raise ParameterError(f"--uncertainty {error}") from None


def _write(found: Plan, rig: Rig, path: Path | None, files: Sequence[Path]) -> None:
    from stickslip.kinds import plan_page
    from stickslip.report import render, versions

    sheet, table = files
    name = "" if path is None else f" {path}"
    page = plan_page(
        found,
        title=rig.heading,
        subject=rig.subject or rig.path,
        save_as=f"stickslip select{name} --data {table.name}",
        reproduce=[command_line()],
        versions=versions(),
        digest=rig.digest,
    )
    write_files({sheet: render(page), table: found.csv()})


def _show(found: Plan) -> None:
    console = stdout()
    console.print(found.sentence, markup=False, style="bold")
    if found.assumed:
        console.print(
            "The uncertainty of 2 % of the longest travel is an assumption: repeat one setting and"
            " give the scatter as --uncertainty.",
            markup=False,
        )
    if found.repeated:
        console.print(f"The uncertainty is {known_by(found)}.", markup=False)
    for line in filter(None, (found.range_source, found.band_sentence)):
        console.print(plain(line), markup=False)
    for line in found.remarks:
        console.print(f"! {plain(line)}", markup=False, style="yellow")
    title = ""
    for table in tables_of(found):
        console.print()
        if table.title != title:
            title = table.title
            console.print(plain(title), markup=False, style="bold")
        if table.rows:
            rows = [[plain(cell) for cell in row.cells] for row in table.rows]
            show_table("", table.heads, rows, whole=table.heads)
        for head, text in table.lines.items():
            console.print(f"  {plain(head)}: {plain(text)}", markup=False)
    head, *_ = found.csv().splitlines()
    console.print("\nSave the travels as a CSV file with these columns", markup=False, style="bold")
    console.print(f"  {head}", markup=False)
