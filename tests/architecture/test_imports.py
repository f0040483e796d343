import importlib
import re
import subprocess
import sys

import pytest

import stickslip
from stickslip.errors import RenamedError

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


@pytest.mark.parametrize("name", stickslip.MOVED)
def test_a_name_that_was_moved_says_where_it_is_now(name):
    home = f"stickslip.{stickslip.MOVED[name]}"
    with pytest.raises(RenamedError, match=rf"from {re.escape(home)} import {name}\."):
        getattr(stickslip, name)
    assert getattr(importlib.import_module(home), name) is not None


def test_an_import_of_a_moved_name_says_where_it_is_now():
    with pytest.raises(RenamedError, match=r"from stickslip\.drives import Sine\."):
        exec("from stickslip import Sine", {})


def test_few_names_stand_at_the_top():
    assert len(stickslip.__all__) <= 45


def test_public_names_are_listed_once():
    assert len(stickslip.__all__) == len(set(stickslip.__all__))
