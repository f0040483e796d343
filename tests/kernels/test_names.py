"""Kernels are put into one module, where a name can stand for one thing only."""

import ast
from collections import Counter
from pathlib import Path

import stickslip.kernels

FOLDER = Path(stickslip.kernels.__file__).parent


def names(path):
    """Yield what a module defines at its top, for itself alone."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef):
            yield node.name
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        for target in targets:
            if isinstance(target, ast.Name) and target.id != "__all__":
                yield target.id


def test_no_two_kernels_define_the_same_name():
    found = Counter(name for path in FOLDER.rglob("*.py") for name in names(path))
    assert len(found) > 200
    assert [name for name, count in found.items() if count > 1] == []
