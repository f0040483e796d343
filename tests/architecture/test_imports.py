import importlib
import subprocess
import sys

import pytest

import stickslip

HEAVY = {"matplotlib", "numba", "pandas", "pydantic", "scipy", "symengine"}


def test_importing_the_package_loads_no_heavy_library():
    code = "import stickslip, sys; print(*sys.modules)"
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert HEAVY.isdisjoint(run.stdout.split())


@pytest.mark.parametrize("name", stickslip.__all__)
def test_every_public_name_can_be_imported(name):
    assert getattr(importlib.import_module("stickslip"), name) is not None


def test_public_names_are_listed_once():
    assert len(stickslip.__all__) == len(set(stickslip.__all__))
