"""``python -m benchmarks``: which cases and parts it prints, and when it writes its page."""

import sys
from types import SimpleNamespace

import pytest
from benchmarks import __main__ as command


@pytest.fixture
def page(monkeypatch, tmp_path):
    """Return a function that runs a command with made-up cases, and its page."""
    modules = {
        "benchmarks.first": SimpleNamespace(run=lambda: None),
        "benchmarks.second": SimpleNamespace(run=lambda *_: None, PARTS=("left", "right")),
    }
    file = tmp_path / "results.md"
    monkeypatch.setattr(command, "CASES", ("first", "second"))
    monkeypatch.setattr(command, "PAGE", file)
    monkeypatch.setattr(command.importlib, "import_module", modules.__getitem__)

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["benchmarks", *words])
        command.main()
        return file

    return run


@pytest.mark.parametrize(
    ("words", "complete"),
    [
        ((), True),
        (("first", "second"), True),
        (("second",), False),
        (("first", "second:left"), False),
    ],
)
def test_only_all_parts_of_all_cases_write_the_page(page, words, complete):
    assert page(*words).exists() == complete


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("third", "no case third; there are first, second"),
        ("second:up", "no part up of second; there are left, right"),
        ("first:up", "no part up of first; it has none"),
    ],
)
def test_what_is_unknown_is_answered_with_what_there_is(page, capsys, word, message):
    with pytest.raises(SystemExit):
        page(word)
    assert message in capsys.readouterr().err
