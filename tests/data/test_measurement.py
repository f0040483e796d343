"""Measurements: what makes one, and what does not."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Measurement
from stickslip.errors import InputError, ParameterError, UnknownNameError

T = [0.0, 0.1, 0.2]
X = [0.0, 0.01, 0.03]


def test_one_number_is_a_measurement():
    measurement = Measurement(travel=0.2)
    assert measurement.kind == "scalars"
    assert measurement.records() == (measurement,)
    assert measurement.quantities() == ("travel",)


@pytest.mark.parametrize(
    ("parts", "kind"),
    [
        ({"travel": 0.2}, "scalars"),
        ({"travel": [0.20, 0.21]}, "scalars"),
        ({"velocity": 0.1, "friction": 2.0}, "scalars"),
        ({"time": T, "position": X}, "series"),
        ({"time": T, "velocity": X, "friction": X}, "series"),
        ({"time": T, "position": X, "travel": 0.03}, "series"),
        ({"velocity": X, "friction": X}, "friction-map"),
        ({"velocity": X, "friction": X, "position": X}, "friction-map"),
    ],
)
def test_the_kind_follows_from_what_is_given(parts, kind):
    assert Measurement(**parts).kind == kind


def test_trials_are_the_records():
    trials = (Measurement(travel=0.1, name="a"), Measurement(travel=0.2, name="b"))
    whole = Measurement(trials=trials)
    assert whole.records() == trials
    assert whole.kind == "scalars"
    assert whole.quantities() == ("travel",)


def test_arrays_are_copied_and_read_only():
    source = np.array(X)
    record = Measurement(time=T, position=source)
    source[0] = 1.0
    assert record.position[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        record.position[0] = 1.0


def test_a_plain_uncertainty_belongs_to_the_only_quantity():
    record = Measurement(time=T, position=X, uncertainty=0.001)
    assert record.uncertainty == {"position": 0.001}


def test_offsets_are_subtracted_when_values_are_asked_for_and_not_twice():
    record = Measurement(time=T, position=X, offset={"position": 0.01})
    again = replace(record, name="copy")
    # Differences of decimal numbers round in the last digit.
    np.testing.assert_allclose(again.values("position"), [-0.01, 0.0, 0.02], atol=1e-16)
    np.testing.assert_array_equal(again.position, X)


def test_a_measurement_survives_pickling():
    record = Measurement(time=T, position=X, uncertainty=0.001, overrides={"mechanism.mass": 1.0})
    twin = pickle.loads(pickle.dumps(record))
    np.testing.assert_array_equal(twin.position, record.position)
    assert twin.overrides == record.overrides


ONE = Measurement(travel=0.1)
BAD = {
    "nothing": ({}, InputError, "at least one quantity"),
    "time alone": ({"time": T}, InputError, "at least one quantity"),
    "both": ({"travel": 0.1, "trials": (ONE,)}, InputError, "travel is given beside trials"),
    "settings beside trials": ({"trials": (ONE,), "offset": {"x": 1.0}}, InputError, "offset"),
    "nested trials": ({"trials": (Measurement(trials=(ONE,)),)}, InputError, "must be one record"),
    "trial of another type": ({"trials": (0.2,)}, InputError, "must be one record, got 0.2"),
    "mixed kinds": (
        {"trials": (ONE, Measurement(time=T, position=X))},
        InputError,
        "one kind, got scalars and series",
    ),
    "same name twice": (
        {"trials": (replace(ONE, name="a"), replace(ONE, name="b"), replace(ONE, name="a"))},
        InputError,
        "Trials 1 and 3 have the same name, 'a'",
    ),
    "unequal lengths": (
        {"time": T, "position": X[:2]},
        InputError,
        r"as long as time \(3\), got position 2",
    ),
    "time not increasing": (
        {"time": [0.0, 0.1, 0.1], "position": X},
        InputError,
        "must increase strictly, got 0.1 before 0.1 at index 2",
    ),
    "one sample": ({"time": [0.0], "position": [1.0]}, InputError, "at least 2 times"),
    "scalar time": ({"time": 1.0, "position": X}, InputError, "at least 2 times"),
    "time without arrays": ({"time": T, "travel": 0.1}, InputError, "is given without samples"),
    "scalar in a series": ({"time": T, "position": X, "force": 1.0}, InputError, "give an array"),
    "array without times": ({"position": X}, InputError, "array without times"),
    "map of unequal lengths": (
        {"velocity": X, "friction": X[:2]},
        InputError,
        "velocity 3, friction 2",
    ),
    "hole": (
        {"time": T, "position": [0.0, float("nan"), 1.0]},
        ParameterError,
        r"position \(x\) \[m\] must be finite, got nan at index 1",
    ),
    "infinite": ({"travel": float("inf")}, ParameterError, r"travel \(s\).*got inf"),
    "text": (
        {"travel": "far"},
        ParameterError,
        r"travel \(s\) \[m\] must be a number or text with a unit",
    ),
    "texts": ({"time": T, "position": ["1", "2", "3"]}, ParameterError, "must be real numbers"),
    "truth": ({"travel": True}, ParameterError, "got True"),
    "truths": ({"velocity": [True], "friction": [1.0]}, ParameterError, "must be real numbers"),
    "complex": ({"travel": 1j}, ParameterError, "must be"),
    "matrix": ({"time": T, "position": [X, X]}, ParameterError, r"shape \(n,\)"),
    "empty array": ({"time": [], "position": []}, ParameterError, r"shape \(n,\)"),
    "ragged": ({"travel": [[1.0], [1.0, 2.0]]}, ParameterError, "must be real numbers"),
    "zero uncertainty": ({"travel": 0.1, "uncertainty": 0}, ParameterError, "above 0 m, got 0"),
    "negative uncertainty": (
        {"travel": 0.1, "uncertainty": {"travel": -1.0}},
        ParameterError,
        "above 0 m, got -1",
    ),
    "uncertainty of nothing": (
        {"travel": 0.1, "uncertainty": {"travle": 1.0}},
        UnknownNameError,
        "Did you mean 'travel'",
    ),
    "uncertainty of which": (
        {"velocity": 0.1, "friction": 1.0, "uncertainty": 0.1},
        InputError,
        r"several \(velocity, friction\)",
    ),
    "kind of uncertainty": (
        {"travel": 0.1, "uncertainty_kind": "guess"},
        InputError,
        "rounding, standard, interval",
    ),
    "override that is no number": (
        {"travel": 0.1, "overrides": {"mechanism.mass": "1 kg"}},
        ParameterError,
        "overrides of 'mechanism.mass' must be a finite number",
    ),
    "initial state that is no number": (
        {"travel": 0.1, "initial": {"x": float("nan")}},
        ParameterError,
        "initial of 'x'",
    ),
    "overrides that are no mapping": ({"travel": 0.1, "overrides": 3}, InputError, "mapping"),
    "offset of nothing": (
        {"travel": 0.1, "offset": {"position": 1.0}},
        UnknownNameError,
        "quantity in offset",
    ),
}


@pytest.mark.parametrize(("parts", "error", "message"), BAD.values(), ids=BAD)
def test_what_is_no_measurement_is_refused_with_a_reason(parts, error, message):
    with pytest.raises(error, match=message):
        Measurement(**parts)


def test_values_of_an_absent_quantity_name_those_present():
    with pytest.raises(UnknownNameError, match="Known: travel"):
        ONE.values("friction")


def test_values_are_asked_of_records_and_not_of_trials():
    with pytest.raises(InputError, match="records"):
        Measurement(trials=(ONE,)).values("travel")
