"""What users read is written once: two copies of a sentence drift apart."""

import ast
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

import stickslip

ROOT = Path(stickslip.__file__).parent
LEAST = 24
"""Characters of a sentence at least, and three blanks; shorter strings are keys, units or names."""
AGREE = {}
"""Strings that stand in two places, with the reason."""


def sentences(source: str) -> Iterator[tuple[str, int]]:
    """Yield strings that users may read, with their lines; braces stand for what is inserted."""
    nodes = [*ast.walk(ast.parse(source))]
    passed = {id(n.value) for n in nodes if isinstance(n, ast.Expr)}  # docstrings
    for node in nodes:
        if isinstance(node, ast.JoinedStr):
            passed |= {id(part) for part in node.values}
    for node in nodes:
        if isinstance(node, ast.JoinedStr):
            said = "".join(
                str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values
            )
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            said = node.value
        else:
            continue
        if id(node) not in passed and len(said) >= LEAST and said.count(" ") >= 3:
            yield said.strip(), node.lineno


def written_twice(sources: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the sentences that stand in several places, with the places."""
    places: dict[str, list[str]] = defaultdict(list)
    for name, source in sources.items():
        for said, line in sentences(source):
            places[said].append(f"{name}:{line}")
    return {said: found for said, found in places.items() if len(found) > 1}


@pytest.fixture(scope="module")
def twice() -> dict[str, list[str]]:
    # Text of kernels is of numbers alone.
    files = [path for path in sorted(ROOT.rglob("*.py")) if "kernels" not in path.parts]
    return written_twice(
        {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for path in files}
    )


def test_no_sentence_is_written_twice(twice: dict[str, list[str]]) -> None:
    found = {said: places for said, places in twice.items() if said not in AGREE}
    assert not found, "give each of these one home:\n" + "\n".join(
        f"{said!r}: {', '.join(places)}" for said, places in found.items()
    )


def test_a_sentence_is_found_whatever_it_inserts_and_however_it_is_broken() -> None:
    one = 'raise ValueError(f"{path} cannot be read, for {reason}.")'
    other = 'text = (\n    f"{file} cannot be"\n    f" read, for {error.strerror}."\n)'
    found = written_twice({"one.py": one, "other.py": other})
    assert found == {"{} cannot be read, for {}.": ["one.py:1", "other.py:2"]}
