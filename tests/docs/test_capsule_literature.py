"""The table of the page on published results shows what its cells compute."""

import contextlib
import io
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "explanation/capsule-literature.md").read_text("utf-8")
CELLS = (DOCS / "howto/files/capsule_literature.py").read_text("utf-8").split("\n# %% ")[1:]
LONG = ("ensemble(", "progression(")
"""What cells call that take longer than all others together."""


def computed(cells: list[str]) -> dict[tuple[str, str, str], tuple[float, float, float]]:
    """Theirs, ours and error of each row, by source, whose values and quantity."""
    names: dict[str, Any] = {}
    with contextlib.redirect_stdout(io.StringIO()):
        for cell in cells:
            exec(compile(cell.partition("\n")[2], "capsule_literature.py", "exec"), names)
    plt.close("all")
    return {
        (source, whose, quantity): (theirs, ours, error)
        for source, whose, _, quantity, theirs, ours, error in names["rows"]
    }


def shown() -> dict[tuple[str, str, str], list[str]]:
    """The table at the top of the page."""
    _, _, table = PAGE.partition("| source | values | quantity | theirs | ours | error |\n")
    lines, _, _ = table.partition("\n\n")
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines.splitlines()[1:]]
    return {(source, whose, quantity): rest for source, whose, quantity, *rest in rows}


def check(text: str, value: float) -> None:
    """Compare a number with its text: five digits, a percentage of two, or a bound."""
    if text.startswith("< "):
        assert abs(value) < float(text[2:])
    elif text.endswith(" %"):
        assert 100.0 * value == pytest.approx(float(text[:-2]), rel=0.06)
    else:
        assert value == pytest.approx(float(text), rel=1e-4)


def test_the_table_shows_what_short_cells_compute() -> None:
    rows = computed([cell for cell in CELLS[:-1] if not any(name in cell for name in LONG)])
    both = [key for key in shown() if key in rows]
    assert len(both) >= 20
    for key in both:
        for text, value in zip(shown()[key], rows[key], strict=True):
            check(text, value)


@pytest.mark.slow
def test_the_table_shows_what_the_page_computes() -> None:
    rows = computed(CELLS)
    for key, texts in shown().items():
        for text, value in zip(texts, rows[key], strict=True):
            check(text, value)
