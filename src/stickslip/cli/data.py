"""``stickslip data``."""

import re
import warnings
from typing import Any

from rich.console import Console

from stickslip.cli.console import note, print_json, show_table, stdout
from stickslip.cli.options import PathOptions, RecordOptions
from stickslip.data.catalogue import Column, DataFile, Dataset, dataset, names
from stickslip.show.documents import document


def run_list(*, as_json: bool) -> None:
    """List the records."""
    records = [dataset(name) for name in names()]
    if as_json:
        print_json(document("data", {"records": [_record(record) for record in records]}))
        return
    rows = [[file.name, file.title, _short(file.licence), _places(file)] for file in records]
    show_table("", ["name", "title", "licence", "where"], rows, whole=["name", "where"])
    stdout().print(
        "\nDetails of a record: stickslip data show NAME. Its table: stickslip data path NAME"
    )


def run_show(options: RecordOptions) -> None:
    """Show a record in full."""
    record = dataset(options.name)
    if options.as_json:
        print_json(document("data", _record(record)))
        return
    console = stdout()
    console.print(record.title, style="bold")
    for label, text in _head(record).items():
        if text:
            console.print(f"{label:<11}{text}")
    console.print()
    rows = [[c.name, c.unit, c.quantity, _number(c), c.meaning] for c in record.columns]
    show_table("", ["column", "unit", "quantity", "gain", "meaning"], rows)
    for file in record.files.values():
        _show_file(console, record, file)
    for title, known in {"known": record.known, **record.published}.items():
        if known:
            console.print(f"\n{title}", style="bold")
        for key, value in known.items():
            console.print(f"  {key} = {value}")
    if record.notes:
        console.print(f"\n{record.notes}")


def run_path(options: PathOptions) -> None:
    """Print the path of a table; what is downloaded for it is said on stderr."""
    record, file = dataset(options.name), options.file
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always", UserWarning)
        path = record.path(file, report=note)
    for warning in warned:
        note(f"stickslip: {warning.message}")
    if options.as_json:
        content = {"name": options.name, "file": record.file(file).name, "path": str(path)}
        print_json(document("data", content))
    else:
        print(path)


def _places(record: Dataset) -> str:
    """Return where the files of a record are, each place once."""
    return ", ".join(dict.fromkeys(record.place(file).value for file in record.files))


def _short(licence: str) -> str:
    """Return a licence without what is said about it."""
    return re.split(r"[:(]", licence)[0].strip()


def _head(record: Dataset) -> dict[str, str]:
    return {
        "kind": record.kind,
        "citation": record.citation,
        "licence": record.licence,
        "source": f"https://github.com/{record.repository}",
        "commit": record.commit,
        "format": record.format,
        "sampling": record.sampling,
    }


def _number(column: Column) -> str:
    return f"{column.gain:.12g}" if column.quantity else ""


def _show_file(console: Console, record: Dataset, file: DataFile) -> None:
    place = record.place(file.name).value
    console.print(f"\nfile {file.name} ({place})", style="bold")
    about = {
        "about": file.about,
        "rows": "" if file.rows is None else str(file.rows),
        "sha256": file.sha256,
        "upstream": file.source,
        "its sha256": file.source_sha256,
        **file.known,
    }
    for key, value in about.items():
        if value != "":
            text = f"  {key} = {value}" if key in file.known else f"  {key:<11}{value}"
            console.print(text)


def _record(record: Dataset) -> dict[str, Any]:
    return {
        **vars(record),
        "columns": [_column(column) for column in record.columns],
        "files": {name: _file(record, file) for name, file in record.files.items()},
    }


def _column(column: Column) -> dict[str, Any]:
    about = {"name": column.name, "unit": column.unit, "meaning": column.meaning}
    if not column.quantity:
        return about
    return {**about, "quantity": column.quantity, "gain": column.gain}


def _file(record: Dataset, file: DataFile) -> dict[str, Any]:
    own = {key: value for key, value in vars(file).items() if key not in ("name", "ending")}
    return {**own, "where": record.place(file.name).value}
