"""What `help` shows of public classes can be read."""

import dataclasses
import inspect
import pydoc
import re
import sys
import types

import pytest
from tests.docs.test_reference import ENTRIES
from tests.support import for_all

import stickslip
from stickslip.quantities import fields_of
from stickslip.show.described import texts_below


def _public_classes():
    for module, name in ENTRIES:
        found = getattr(__import__(module, fromlist=["_"]), name.partition(".")[0])
        for part in name.split(".")[1:]:
            found = getattr(found, part)
        if dataclasses.is_dataclass(found):
            yield found


@for_all(_public_classes())
def test_each_parameter_is_explained_and_no_type_fills_a_page(kind):
    assert "Annotated" not in str(inspect.signature(kind))
    text = inspect.getdoc(kind)
    assert text.count("\nParameters\n---") <= 1
    for field in dataclasses.fields(kind):
        if field.init and not field.name.startswith("_"):
            assert re.search(rf"^([\w ]+, )*{field.name}(, [\w ]+)* : ", text, re.MULTILINE)


def test_help_on_a_capsule_gives_symbol_unit_and_range():
    shown = pydoc.plain(pydoc.render_doc(stickslip.Capsule)).partition("__annotations__")[0]
    assert "Annotated" not in shown
    assert "Capsule(*, capsule_mass: float, inner_mass: float, drive: " in shown
    assert "capsule_mass : float\n |      Mass of the capsule.\n |      M: above 0 kg." in shown
    assert "lower_stop : float, optional\n" in shown
    assert shown.index("Parameters") < shown.index("Examples")


@pytest.mark.parametrize(
    "kind", [stickslip.LuGre, stickslip.Robot, stickslip.mechanisms.drives.Sine]
)
def test_ranges_in_help_are_those_that_are_checked(kind):
    lines = [line.strip() for line in inspect.getdoc(kind).splitlines()]
    for name, quantity in fields_of(kind).items():
        assert any(line.startswith(f"{name} : float") for line in lines)
        assert f"{quantity}." in lines


MINE = """
from dataclasses import dataclass
from typing import Annotated
from stickslip.quantities import Parametrised, Quantity

@dataclass(frozen=True, kw_only=True)
class Mine(Parametrised):
    \'\'\'A law.\'\'\'
    level: Annotated[float, Quantity("c", "N", above=0)]
    slope: Annotated[float, Quantity("d", "N s/m")] | None = None

@dataclass(frozen=True, kw_only=True)
class Silent(Parametrised):
    level: Annotated[float, Quantity("c", "N", above=0)]
"""


@pytest.mark.parametrize("annotations", ["", "from __future__ import annotations\n"])
def test_a_class_of_a_user_without_source_has_units_and_ranges(annotations, monkeypatch):
    module = types.ModuleType("module_of_a_user")
    monkeypatch.setitem(sys.modules, module.__name__, module)
    exec(annotations + MINE, vars(module))
    assert "level" not in texts_below(module.Mine)
    assert inspect.getdoc(module.Mine).endswith(
        "level : float\n    c: above 0 N.\n"
        "slope : float, optional\n    d: a finite number in N s/m."
    )
    assert str(inspect.signature(module.Mine)).startswith(
        "(*, level: float, slope: float | None = None)"
    )
    assert "Annotated" not in inspect.getdoc(module.Silent)
