import ast
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src" / "stickslip"
LONGEST_MODULE = 400
LONGEST_FUNCTION = 40

ALLOWED: dict[str, str] = {}
"""What may be longer, as "room/module.py" or "room/module.py:function", and why."""


def length(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Lines of a function from its def on, without its docstring."""
    lines = function.end_lineno - function.lineno + 1
    if ast.get_docstring(function, clean=False) is None:
        return lines
    docstring = function.body[0]
    return lines - (docstring.end_lineno - docstring.lineno + 1)


def too_long() -> Iterator[str]:
    for path in sorted(SOURCE.rglob("*.py")):
        name = path.relative_to(SOURCE).as_posix()
        text = path.read_text(encoding="utf-8")
        if len(text.splitlines()) > LONGEST_MODULE:
            yield name
        for node in ast.walk(ast.parse(text)):
            is_function = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
            if is_function and length(node) > LONGEST_FUNCTION:
                yield f"{name}:{node.name}"


def test_modules_and_functions_are_short_unless_a_reason_is_given():
    assert sorted(set(too_long()) - set(ALLOWED)) == []


def test_every_exception_is_still_needed_and_has_a_reason():
    assert sorted(set(ALLOWED) - set(too_long())) == []
    assert all(ALLOWED.values())
