"""Results with rows are tables: DataFrames, and Datasets of xarray with units."""

import importlib
import inspect
import sys

import numpy as np
import pandas as pd
import pytest

import stickslip
from stickslip import Axis, Coulomb, Measurement
from stickslip.errors import InputError
from stickslip.show.display import dataset_of
from stickslip.study.control import closed_loop

PLACES = (
    "data", "engine", "engine.solver", "exports", "identify",
    "identify.fits", "study", "study.control", "study.optimisation", "study.sweep",
)  # fmt: skip


def test_each_public_result_with_a_dataframe_is_a_dataset_too():
    found = set()
    for place in PLACES:
        module = importlib.import_module(f"stickslip.{place}")
        found |= {
            one
            for one in (getattr(module, name) for name in module.__all__)
            if inspect.isclass(one)
        }
    framed = {one for one in found if hasattr(one, "to_dataframe")}
    assert len(framed) > 20
    assert [one.__name__ for one in framed if not hasattr(one, "to_xarray")] == []
    assert hasattr(stickslip.Measurement, "to_xarray")


def test_a_measurement_is_a_dataset_over_time_with_the_units_of_its_names():
    measurement = Measurement(time=[0.0, 0.1], force=[2.0, 3.0], turning=True)
    data = measurement.to_xarray()
    assert (data["time"].units, data["force"].units) == ("s", "N m")
    assert data["force"].sel(time=0.1) == 3.0
    trials = Measurement(trials=[Measurement(travel=0.1), Measurement(travel=0.2)]).to_xarray()
    assert dict(trials.sizes) == {"row": 2}
    assert trials["travel"].values.tolist() == [0.1, 0.2]


def test_a_closed_loop_has_the_units_of_its_states():
    loop = closed_loop(
        Axis(inertia=1.0), Coulomb(kinetic_coefficient=0.1), lambda _t, seen: -seen["x"],
        period=0.01, t_end=0.05,
    )  # fmt: skip
    data = loop.to_xarray()
    assert list(data.sizes) == ["t"]
    assert (data["t"].units, data["measured_v"].units) == ("s", "m/s")
    np.testing.assert_array_equal(data["command"], loop.commands)


def test_what_is_missing_is_empty_or_not_a_number():
    table = pd.DataFrame(
        {"law": ["a", "a"], "score": [1.0, None], "why": [None, "x"], "sure": [True, None]}
    )
    data = dataset_of(table, over="law", units={"score": "m"})
    assert dict(data.sizes) == {"row": 2}  # a law stands twice
    assert data["law"].values.tolist() == ["a", "a"]
    assert np.isnan(data["score"].values[1])
    assert data["score"].units == "m"
    assert data["why"].values.tolist() == ["", "x"]
    assert data["sure"].values[0] == 1.0
    empty = dataset_of(pd.DataFrame({"a": [], "b": []}), over="a")
    assert dict(empty.sizes) == {"a": 0}


def test_without_xarray_the_message_says_what_to_do(monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(InputError, match="or use to_dataframe"):
        Measurement(travel=0.2).to_xarray()


def test_columns_that_differ_by_their_unit_alone_are_both_kept():
    data = dataset_of(pd.DataFrame({"time [s]": [1.0], "time [ms]": [1000.0]}))
    assert {name: data[name].units for name in data.data_vars} == {"time": "s", "time [ms]": "ms"}
