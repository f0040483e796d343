"""Whole selections are judged by what is true: laws, faults, intervals, and what is certain."""

import pytest
from benchmarks.whole_verdicts import accused, false_certainties, named, right

TOLD = {
    "law": "coulomb-viscous",
    "named": "stribeck",
    "closest": "stribeck",
    "equals": [],
    "doubt": "",
    "kinds": [],
    "checks": [],
    "right": [],
    "built_in": False,
    "score": 1.0,
    "fresh": {"stribeck": 2.0, "coulomb-viscous": 1.0},
    "intervals": [],
}
SETTLED = {"path": "friction.a", "value": 1.0, "true": 2.0, "settled": True, "near": False}


@pytest.mark.parametrize(
    ("told", "false"),
    [
        ({}, 1),  # errs by twice what was stated, where the true law does not
        ({"fresh": {"stribeck": 1.1, "coulomb-viscous": 1.0}}, 0),
        ({"doubt": "a is not identified"}, 0),
        ({"equals": ["coulomb-viscous"]}, 0),
        ({"named": "", "kinds": ["unexplained"]}, 0),
        ({"named": "coulomb-viscous", "closest": "coulomb-viscous"}, 0),
        ({"kinds": ["delay"]}, 1),
        ({"kinds": ["delay or presliding"], "right": ["delay"]}, 0),
        ({"doubt": "b is not identified", "intervals": [SETTLED]}, 1),
        ({"doubt": "b is not identified", "intervals": [SETTLED | {"near": True}]}, 0),
    ],
)
def test_what_is_false_and_was_said_without_a_doubt_counts(told, false):
    assert len(false_certainties(TOLD | told)) == false


def test_a_fault_is_named_alone_or_in_a_group_and_nothing_else_may_be():
    row = TOLD | {"kinds": ["spring or delay", "law"], "right": ["delay", "late or elastic"]}
    assert named(row)
    assert accused(row) == []
    assert accused(row | {"right": ["backlash"]}) == ["spring or delay"]


def test_where_no_law_has_the_true_friction_one_is_right_that_errs_as_it_says():
    assert not right(TOLD | {"law": ""})
    assert right(TOLD | {"law": "", "score": 1.5})


def test_an_effect_of_friction_is_named_by_its_parameter_and_a_wrong_column_by_the_data_check():
    assert named(TOLD | {"built_in": True, "parts": ["friction.stribeck_velocity"]})
    assert not named(TOLD | {"built_in": True, "parts": []})
    assert named(
        {
            "refused": "the force acts against the motion",
            "checks": ["drive"],
            "right": ["force sign", "drive"],
            "built_in": True,
        }
    )
