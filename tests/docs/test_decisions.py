"""Examples in decision records print what they say."""

import contextlib
import importlib
import io
import re
from pathlib import Path

FORMS = "0006-printed-forms-run-with-fixed-steps-only.md"


def test_the_example_of_printed_forms_prints_what_it_says_and_blames_no_form_unfairly():
    root = Path(__file__).parents[2] / "docs" / "decisions"
    text = (root / FORMS).read_text(encoding="utf-8")
    code = re.search(r"```python\n(.*?)```", text, re.DOTALL)[1]
    printed = re.search(r"```text\n(.*?)```", text, re.DOTALL)[1]
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(code, {})
    assert out.getvalue() == printed
    # (1) has no static level: a push above kinetic friction rightly moves it
    pushes = [float(level) for level in re.findall(r"level=([\d.]+)", code)]
    assert pushes == [10.0, 1.2]
    assert pushes[1] < 0.25 * 9.81 < 0.35 * 9.81 < pushes[0]


def test_the_page_of_printed_forms_lists_all_equations_with_typeset_symbols(monkeypatch):
    folder = Path(__file__).parents[2] / "docs" / "_ext"
    monkeypatch.syspath_prepend(str(folder))
    page = "\n".join(importlib.import_module("generated").printed_forms())
    heads = re.findall(r"^## Eq\. \((\d+)\): (.+)$", page, re.MULTILINE)
    assert [int(number) for number, _ in heads] == list(range(1, 12))
    assert page.count("\nRight as printed\n") == 2
    assert page.count("\nDefect\n") == 9
    # Greek names are commands in formulas, and no small markup of the reports is left
    assert re.findall(r"\$(?:mu|sigma|alpha)\b|(?<!\{\})\^\{n\}", page) == []
