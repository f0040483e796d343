import importlib
import inspect
import pickle
import re
import subprocess
import sys
import traceback
import types

import pytest

import stickslip
from stickslip.errors import InputError, MovedError, RenamedError

HEAVY = {"matplotlib", "llvmlite", "pandas", "pydantic", "scipy", "symengine"}


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
    with pytest.raises(ImportError, match=r"from stickslip\.drives import Sine\.$") as caught:
        exec("from stickslip import Coulomb, Sine", {})
    assert isinstance(caught.value, RenamedError)


def test_a_moved_name_is_missing_for_whoever_asks_whether_it_is_there():
    assert not hasattr(stickslip, "Sine")
    assert getattr(stickslip, "Sine", None) is None
    assert inspect.getattr_static(stickslip, "Sine", None) is None
    assert not {*stickslip.MOVED} & {*dir(stickslip)}
    assert not {*stickslip.MOVED} & {name for name, _ in inspect.getmembers(stickslip)}
    with pytest.raises(AttributeError):
        pickle.loads(b"cstickslip\nSine\n.")


def test_pickle_may_look_for_a_function_in_every_module():
    function = types.FunctionType((lambda: 0).__code__, {})
    function.__qualname__ = "Sine"
    function.__module__ = None  # so that pickle asks each module for a Sine
    with pytest.raises((pickle.PicklingError, AttributeError)) as caught:
        pickle.dumps(function)
    assert not isinstance(caught.value, InputError)


def test_python_adds_no_guess_to_the_message_on_a_moved_name():
    with pytest.raises(MovedError) as caught:
        stickslip.Fit  # noqa: B018  # near `fit`
    shown = "".join(traceback.format_exception_only(caught.value))
    assert shown.endswith("from stickslip.results import Fit.\n")
    assert caught.value.name == "Fit"
    copy = pickle.loads(pickle.dumps(caught.value))
    assert type(copy) is MovedError
    assert str(copy) == str(caught.value)


def test_few_names_stand_at_the_top():
    assert len(stickslip.__all__) <= 48


def test_public_names_are_listed_once():
    assert len(stickslip.__all__) == len(set(stickslip.__all__))
