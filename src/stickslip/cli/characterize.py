"""``stickslip characterize``."""

from collections.abc import Sequence
from pathlib import Path

from stickslip.cli.console import (
    command_line,
    number_of,
    plain,
    print_json,
    refuse_overwriting,
    show_table,
    stdout,
)
from stickslip.cli.progress import Drawing
from stickslip.data import load_rig
from stickslip.errors import InputError, ParameterError
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity
from stickslip.show.documents import document, write_files
from stickslip.study.characterization import TESTS, Characterization, characterize


def run(
    laws: Sequence[str],
    rig: Path | None,
    load: str | None,
    tests: str | None,
    inputs: Sequence[str],
    report: Path | None,
    *,
    match: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Try the laws, write the page, show."""
    if report is not None:
        if report.suffix.lower() not in (".html", ".htm"):
            raise InputError(f"--report must be an .html file, got {report}.")
        refuse_overwriting(report, report.parent, force=force)
    mechanism = None if rig is None else load_rig(rig).mechanism
    given = [_law(text) for text in laws]
    chosen = None if tests is None else [name.strip() for name in tests.split(",")]
    with Drawing("Testing") as progress:
        found = characterize(
            given[0],
            *given[1:],
            load=_load(load, mechanism),
            rig=mechanism,
            tests=chosen,
            match=match,
            inputs=_inputs(inputs),
            progress=progress,
        )
    if report is not None:
        _write(found, report)
    if as_json:
        files = [] if report is None else [str(report)]
        print_json(document("characterize", {**found.to_dict(), "files": files}))
        return
    _show(found)
    if report is not None:
        stdout().print(f"\nReport: {report}", markup=False)


def _law(text: str) -> FrictionLaw | str:
    """Return the law of a file, or the name or composition as it is."""
    if not text.lower().endswith(".toml"):
        return text
    found = load_rig(text).laws
    if len(found) != 1:
        names = ", ".join(found) or "none"
        raise InputError(
            f"{text} must have one law with all its values to be tested, it has {names}: give a"
            " file with one, such as the law.toml of a fit."
        )
    (law,) = found.values()
    return law


def _load(text: str | None, mechanism: Mechanism | None) -> float:
    if text is not None:
        try:
            return number_of(text, Quantity("N", "N", above=0))
        except ParameterError as error:
            raise ParameterError(f"--load {error}") from None
    (contact,) = mechanism.contacts()[:1] if mechanism is not None else (None,)
    prescribed = None if contact is None else contact.load
    return 1.0 if prescribed is None else float(prescribed)


def _inputs(texts: Sequence[str]) -> dict[str, list[float]]:
    """Return values by name, of ``temperature=20,40``."""
    found = {}
    for text in texts:
        name, equals, values = text.partition("=")
        try:
            found[name.strip()] = [float(one) for one in values.split(",")]
        except ValueError:
            equals = ""
        if not equals:
            raise InputError(
                f"--input takes NAME=VALUE,... such as temperature=20,40, got {text!r}."
            )
    return found


def _write(found: Characterization, report: Path) -> None:
    from stickslip.show.report import characterization_page, render, versions

    page = characterization_page(found, reproduce=[command_line()], versions=versions())
    write_files({report: render(page)})


def _show(found: Characterization) -> None:
    for i, one in enumerate(found.all):
        if i:
            stdout().print()
        stdout().print(one.title, markup=False, style="bold")
        stdout().print(f"{one.law}", markup=False)
        if one.matched:
            stdout().print(one.matched, markup=False)
        names = [name for name in TESTS if name in one.results or name in one.failed]
        show_table("", ["test", "result"], [[name, plain(one.told(name))] for name in names])
        for name, why in one.failed.items():
            stdout().print(f"{name}: {why}", markup=False)
