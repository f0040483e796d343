import ast
import importlib
import subprocess
import sys

import pytest
from tests.support import for_all

import stickslip
from stickslip.friction import LAW_MODULES
from stickslip.lazy import Door

HEAVY = {"matplotlib", "llvmlite", "pandas", "pydantic", "scipy", "symengine"}


def test_importing_the_package_loads_no_heavy_library():
    code = "import stickslip, sys; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert HEAVY.isdisjoint(run.stdout.split())


@for_all(stickslip.__all__)
def test_every_public_name_can_be_imported(name):
    assert getattr(importlib.import_module("stickslip"), name) is not None


LISTED = """
import os, stickslip as ss
from stickslip.lazy import Door
for name in Door("stickslip").namespaces:
    if os.fork() == 0:  # a copy in which no other has been loaded
        assert name in dir(ss)
        print([name, *dir(getattr(ss, name))], flush=True)
        os._exit(0)
    assert os.wait()[1] == 0
"""


def test_a_public_module_needs_no_import_of_its_own():
    run = subprocess.run([sys.executable, "-c", LISTED], capture_output=True, text=True, check=True)
    lines = map(ast.literal_eval, run.stdout.splitlines())
    listed = {name: set(names) for name, *names in lines}
    assert listed.keys() == {*Door("stickslip").namespaces}
    for name, names in listed.items():
        public = set(importlib.import_module(f"stickslip.{name}").__all__)
        assert public
        assert public <= names


def test_a_name_of_a_public_module_is_found_by_its_name_alone():
    with pytest.raises(AttributeError, match=r"'Sine'; it is stickslip\.mechanisms\.drives\.Sine$"):
        _ = stickslip.Sine
    assert not hasattr(stickslip, "nothing_of_this_name")


def test_listing_names_loads_nothing():
    code = (
        "import stickslip, sys; old = {*sys.modules}; dir(stickslip); print({*sys.modules} - old)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "set()"


@pytest.mark.parametrize("name", Door("stickslip").namespaces)
def test_a_public_module_lists_its_public_names_only(name):
    door = importlib.import_module(f"stickslip.{name}")
    assert dir(door) == sorted(door.__all__)


def test_few_names_but_those_of_laws_stand_at_the_top():
    assert len({*stickslip.__all__} - {*LAW_MODULES}) <= 39


def test_a_module_that_is_imported_by_name_loads_no_others():
    code = "import sys; from stickslip.show import documents; print('matplotlib' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
