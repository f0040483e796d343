"""What commands share: consoles, JSON documents, pages, folders written whole, numbers."""

import contextlib
import re
import shlex
import sys
import tempfile
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

from stickslip.cli import CANCELLED, QUIET, ToldExit
from stickslip.cli.options import ColumnOptions, ReadingOptions
from stickslip.data import (
    Column,
    Reading,
    column_of,
    motor_constants,
    read_gain,
    read_number,
    regular_times,
)
from stickslip.errors import InputError, ParameterError, concerning
from stickslip.quantities import Quantity
from stickslip.show import report as page
from stickslip.show.display import Summary, cell_text, is_numeric
from stickslip.show.documents import check_replaceable, is_earlier, json_text, unwritable
from stickslip.show.formatting import printable

# What commands share: consoles, JSON documents, folders that are written whole or not at all.

GAP = 2
"""Spaces between columns."""
MARKS = {"none": ("", ""), "ok": ("", ""), "warn": ("! ", "yellow"), "bad": ("✗ ", "red")}
"""What stands before the outcome of a check, and its style."""
FOLDED = 16
"""Width down to which a column of words is folded before a table outgrows its terminal."""


class _Printable(Console):
    """A console to which no text of a file can give commands, be it codes or markup."""

    def print(self, *objects: Any, **settings: Any) -> None:
        super().print(*map(_made_printable, objects), **settings)


def _made_printable(item: Any) -> Any:
    return printable(item, lines=True) if isinstance(item, str) else item


def stdout() -> Console:
    """Return the console for results."""
    return _Printable(markup=False, highlight=False, soft_wrap=True, emoji=False)


def stderr() -> Console:
    """Return the console for progress and remarks."""
    return _Printable(stderr=True, markup=False, highlight=False, emoji=False)


def say(text: str) -> None:
    """Say what a file that was written holds."""
    if not QUIET.get():
        stdout().print(text)


def note(text: str) -> None:
    """Say something beside the result, in whole lines, as the result itself is."""
    if not QUIET.get():
        stderr().print(text, soft_wrap=True)


def show_table(
    title: str, heads: Sequence[str], rows: Sequence[Sequence[str]], *, whole: Collection[str] = ()
) -> None:
    """Print a table; what looks like markup of the console is text.

    Numbers are never broken, nor are cells below the heads in `whole`, so that they can be copied.
    Words are folded where a terminal is narrow; a file or a pipe gets rows of any length.
    """
    title, heads = printable(title), [printable(head) for head in heads]
    rows = [[printable(cell) for cell in row] for row in rows]
    table = Table(
        title=Text(title) if title else None,
        title_justify="left",
        box=None,
        pad_edge=False,
        header_style="dim",
    )
    widths, least = [], 0
    for i, head in enumerate(heads):
        numeric = all(is_numeric(row[i]) for row in rows)
        table.add_column(
            Text(head),
            justify="right" if numeric else "left",
            overflow="fold",
            no_wrap=numeric or head in whole,
        )
        width = max(cell_len(text) for text in (head, *(row[i] for row in rows)))
        widths.append(width)
        least += GAP + (width if numeric or head in whole else min(width, FOLDED))
    for row in rows:
        table.add_row(*map(Text, row))
    console = stdout()
    wide = sum(widths) + GAP * len(widths)
    # As wide as it has to be: what is cut off a number is another number.
    if console.is_terminal:
        console.width = max(console.width, least)
        console.print(table)
        return
    console.width = wide
    with console.capture() as lines:
        console.print(table)
    for line in lines.get().splitlines():
        console.print(line.rstrip())


def show_summary(summary: Summary) -> None:
    """Print a result in short: its sentence, its table, its notes."""
    console = stdout()
    if summary.sentence:
        console.print(plain(summary.sentence))
    rows = [[plain(cell_text(value)) for value in row] for row in summary.rows]
    if summary.head and rows:
        show_table("", summary.head, rows)
    for row in rows if not summary.head else ():
        console.print(": ".join([row[0].rstrip("."), *row[1:]]))
    for line in summary.notes:
        console.print(plain(line))


def show_sections(sections: Iterable[page.Section]) -> None:
    """Print sections of a page, as far as they are text."""
    for place, section in enumerate(sections):
        if place:
            stdout().print()
        if section.heading:
            stdout().print(page.plain(section.heading), style="bold")
        show_blocks(section.blocks)


def show_blocks(blocks: Iterable[page.Block]) -> None:
    """Print blocks of a page, as far as they are text: figures are on the page alone."""
    for block in blocks:
        match block:
            case page.Table():
                _show_rows(block)
            case page.Columns():
                show_blocks((*block.left, *block.right))
            case page.Opening():
                verdict = block.verdict if block.verdict.endswith(".") else f"{block.verdict}."
                lines = [page.Paragraph(text=text) for text in (verdict, block.lede)]
                facts = page.Facts(facts=block.facts)
                show_blocks([page.Subheading(text=block.kicker), *lines, facts])
            case _:
                for text, style in _said(block):
                    stdout().print(page.plain(text), style=style)


def _said(block: page.Block) -> list[tuple[str, str]]:
    """Return the lines of a block of text, with their styles."""
    match block:
        case page.Paragraph() | page.Caption() | page.Code():
            return [(block.text, "")]
        case page.Subheading():
            return [(block.text, "bold")]
        case page.Math():
            return [(page.formula_text(block.latex), "")]
        case page.Note():
            return [(f"! {block.title} {block.text}", "yellow" if block.kind == "warn" else "")]
        case page.KeyValues():
            marked = [(*MARKS[item.mark], item) for item in block.items]
            return [(f"{mark}{item.key}: {item.value}", style) for mark, style, item in marked]
        case page.Facts():
            asides = [f" ({fact.aside})" if fact.aside else "" for fact in block.facts]
            pairs = zip(block.facts, asides, strict=True)
            return [(f"{fact.what}: {fact.value}{aside}", "") for fact, aside in pairs]
    return []


def _show_rows(table: page.Table) -> None:
    """Print a table of a page without its plots."""
    places = [place for place, column in enumerate(table.columns) if not column.axis]
    # the unit stands in a line of its own
    heads = [re.sub(r"\n(?=\S+$)", ", ", table.columns[place].head) for place in places]
    heads = [page.plain(" ".join(head.split())) for head in heads]
    rows = [[_text(row.cells[place]) for place in places] for row in table.rows]
    show_table("", heads, rows)
    if table.caption:
        stdout().print(page.plain(table.caption))


def _text(cell: page.Cell) -> str:
    """Return a cell of a page as text."""
    match cell:
        case page.Number():
            return page.plain(" ".join(filter(None, [cell.value, cell.doubt, cell.unit])))
        case page.Name():
            return page.plain(f"{cell.text} ({cell.aside})" if cell.aside else cell.text)
        case str():
            return page.plain(cell)
    return ""


def print_json(content: Mapping[str, Any]) -> None:
    """Print one JSON document on stdout."""
    sys.stdout.write(printable(json_text(content), lines=True))


def command_line() -> str:
    """Return the command that was given, as a shell takes it."""
    return shlex.join(["stickslip", *sys.argv[1:]])


def plain(text: str) -> str:
    """Return a text without the marks that reports typeset."""
    return text.replace("$", "")


def check_rig_file(output: Path) -> None:
    """Refuse what is no rig file by its ending, before it is written."""
    if output.suffix != ".toml":
        raise InputError(f"--output takes a .toml file, got {output}.")


def folder_of(output: Path | None, default: str, *, as_json: bool) -> Path | None:
    """Return the folder to write: the one given or the default, none for a document alone."""
    return output if output is not None or as_json else Path(default)


def refuse_inputs(output: Path, inputs: Iterable[str | Path]) -> None:
    """Refuse to replace what the command reads, whatever may be replaced."""
    for path in map(Path, inputs):
        if output.exists() and path.exists() and output.samefile(path):
            raise InputError(
                f"{output} is read by this command, so it is not replaced: choose another -o."
            )


def refuse_overwriting(
    path: Path, folder: Path, *, force: bool, option: str = "-o", files: Collection[str] = ()
) -> None:
    """Refuse early what could not be written into a folder in the end; leave no trace.

    A folder that holds nothing but `files` of an earlier run may be replaced. `option` is the one
    that names the file or the folder.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file, but a folder is needed: give another {option}.")
    earlier = path == folder and folder.is_dir() and is_earlier(folder, files)
    if path.exists() and not (force or earlier):
        what = "files in it" if path.is_dir() else "it"
        raise InputError(
            f"{path} already exists; give --force to replace {what}, or another {option}."
        )
    check_replaceable(folder, files)
    new = [part for part in (folder, *folder.parents) if not part.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise unwritable(path, error) from error
    finally:
        for part in new:
            with contextlib.suppress(OSError):
                part.rmdir()


# Values of options: pairs, numbers, and how files are read.


def pair_of(text: str, wants: str) -> tuple[str, str]:
    """Return both sides of ``NAME=VALUE``; an option that has none says what it wants.

    Examples
    --------
    >>> pair_of("mass = 2 kg", "--set takes PATH=VALUE")
    ('mass', '2 kg')
    """
    name, _, value = (part.strip() for part in text.partition("="))
    if not (name and value):
        raise InputError(f"{wants}, got {text!r}.")
    return name, value


def overrides(changes: Sequence[str]) -> dict[str, str]:
    """Split ``path=value`` pairs."""
    wants = "--set takes PATH=VALUE such as static_coefficient=0.4"
    return dict(pair_of(change, wants) for change in changes)


def with_unit(option: str, text: str | None, quantity: Quantity) -> float | None:
    """Return a number with a unit in SI, if there is one; what is refused names the option."""
    with concerning(option):
        return None if text is None else read_number(text, quantity)


def number_of(text: str, quantity: Quantity) -> float:
    """Return a number in SI, given plainly or with a unit.

    Examples
    --------
    >>> number_of("2 mm", Quantity("x", "m")), number_of("0.002", Quantity("x", "m"))
    (0.002, 0.002)
    """
    try:
        plain: str | float = float(text)
    except ValueError:
        plain = text
    return read_number(plain, quantity)


def range_of(option: str, text: str, quantity: Quantity) -> tuple[float, float]:
    """Return both ends of ``LOW..HIGH`` in SI.

    Examples
    --------
    >>> range_of("--between", "40 mm..0.1 m", Quantity("x_0", "m"))
    (0.04, 0.1)
    """
    low, dots, high = text.partition("..")
    if not (dots and low.strip() and high.strip()):
        raise InputError(f"{option} takes LOW..HIGH such as 40mm..100mm, got {text!r}.")
    with concerning(option):
        return number_of(low.strip(), quantity), number_of(high.strip(), quantity)


def columns_of(options: ColumnOptions) -> Reading:
    """Return what the options of that name say together."""
    constant, columns = options.motor_constant, _columns(options.columns)
    if options.rate is not None:
        rates = (
            rate
            for rate in (options.rate, f"{options.rate} Hz")
            if regular_times(rate, 1) is not None
        )
        rate = next(rates, None)
        if rate is None or "time" in columns:
            raise InputError(
                "--rate takes a rate such as 50Hz or a time between rows such as 0.5ms, and no"
                f" --columns time=... beside it, got {options.rate!r}."
            )
        columns["time"] = rate
    return Reading(
        columns=columns,
        units=_pairs("--unit", "position=mm", options.units),
        gain=_gains(_pairs("--gain", "force=35.15", options.gain)),
        motor_constant={} if constant is None else motor_constants(constant),
        by="options",
    )


def reading_of(options: ReadingOptions) -> Reading:
    """Return what the options of that name say together."""
    repair = [part.strip() for given in options.repair for part in given.split(",")]
    names = [part.strip() for given in options.conditions for part in given.split(",")]
    return replace(columns_of(options), repair=tuple(repair), conditions=tuple(names))  # type: ignore[arg-type]  # checked by Reading itself


def _columns(given: Sequence[str]) -> dict[str, Column]:
    """Split ``name=column`` pairs; what has no name is the second column of the one before."""
    result: dict[str, list[str]] = {}
    name = ""
    for part in (part for text in given for part in text.split(",")):
        if "=" in part or not name or not part.strip():
            ((name, column),) = _pairs("--columns", "position=q_m", [part]).items()
            result[name] = [column]
        else:
            result[name].append(part.strip())
    return {name: column_of(name, row[0] if len(row) == 1 else row) for name, row in result.items()}


def _pairs(option: str, example: str, given: Sequence[str]) -> dict[str, str]:
    """Split ``name=value`` pairs, parted by commas."""
    wants = f"{option} takes NAME=VALUE such as {example}"
    return dict(pair_of(part, wants) for text in given for part in text.split(","))


def _gains(pairs: Mapping[str, str]) -> dict[str, float | str]:
    """Return gains as numbers, or as texts with their unit."""
    result: dict[str, float | str] = {}
    for name, value in pairs.items():
        try:
            result[name] = read_gain(value)
        except ParameterError:
            raise InputError(
                "--gain takes numbers such as force=35.15, perhaps with a unit as in"
                f' "position=0.5 um/count", got {name}={value}.'
            ) from None
    return result


# The page of a command: what was found stands, whether its page can be drawn or not.

PAGE_FAILED = 1
"""Exit code where the result stands and its page could not be drawn."""
DRAWN = 0


def draw_page(
    folder: Path,
    page: Callable[[], str],
    write: Callable[[str | None], None],
    *,
    kept: str,
    quiet: bool = False,
) -> int:
    """Draw a page and write it; return 0, or the exit code where it failed or was cancelled.

    What goes with it is written in either case. An older page does not stay where a new one fails:
    it would be read as that of this result. `kept` says where the result is.
    """
    note("Drawing the report ...")
    code, text, failed = DRAWN, None, ""
    try:
        text = page()
    except KeyboardInterrupt:
        code, failed = CANCELLED, "Cancelled while the report was drawn."
    except Exception as error:  # whatever a page fails with, the result stands
        code, failed = (
            PAGE_FAILED,
            f"The report could not be drawn ({type(error).__name__}: {error}).",
        )
    write(text)
    if failed:
        note(f"{failed} {kept}")
    elif not quiet:
        from stickslip.identify.kinds import PAGE

        stdout().print(f"\nReport: {folder / PAGE}")
    return code


def leave_unless_drawn(code: int) -> None:
    """Leave with the exit code of a page that was not drawn."""
    if code != DRAWN:
        raise ToldExit(code)
