"""Slips of a caller: one message each, or what was plainly meant."""

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    Measurement,
    RecordSettings,
    SpringBlock,
    fit,
    load_rig,
    select,
)
from stickslip.errors import InputError

AXIS = Axis(inertia=5.0)
SPEED = np.concatenate([-np.linspace(0.1, 1.0, 40), np.linspace(0.1, 1.0, 40)])
MAP = Measurement(velocity=SPEED, friction=3.0 * np.sign(SPEED) + 0.01 * np.cos(20.0 * SPEED))


@pytest.mark.parametrize("verb", [fit, select])
@pytest.mark.parametrize(
    ("mechanism", "measurement", "words"),
    [
        (
            load_rig(),
            MAP,
            "takes a mechanism and .* got a Rig: give rig.mechanism and rig.measurement",
        ),
        ("axis.toml", MAP, "takes a mechanism such as .*, got 'axis.toml'"),
        (Axis, MAP, "takes a mechanism such as .*, got the class Axis"),
        (
            AXIS,
            "ax1.csv",
            r"takes a Measurement, got 'ax1.csv': read the file with load_measurement\('ax1.csv'\)",
        ),
        (AXIS, load_rig(), "takes a Measurement, got Rig: give rig.measurement"),
        (AXIS, {"time": [0.0]}, "takes a Measurement, got dict"),
        (AXIS, None, "takes a Measurement, got NoneType"),
        (AXIS, Coulomb, "takes a Measurement, got the class Coulomb: the order is mechanism, law"),
    ],
)
def test_what_is_no_mechanism_or_no_measurement_is_said_to_be_so(
    verb, mechanism, measurement, words
):
    given = (["coulomb"] if verb is select else "coulomb", measurement)
    with pytest.raises(InputError, match=f"^{verb.__name__} {words}"):
        verb(mechanism, *given)


def test_a_single_name_needs_no_list_around_it():
    with pytest.raises(InputError, match=r"tells nothing of mechanism\.inertia:"):
        fit(AXIS, "coulomb", MAP, vary=["friction.*", "mechanism.inertia"])
    with pytest.raises(InputError, match=r"^vary applies to `fit`.*, got mechanism\.inertia:"):
        select(AXIS, ["coulomb"], MAP, vary=["friction.*", "mechanism.inertia"])
    held = {"viscous_coefficient": 0.5}
    free = fit(AXIS, "coulomb-viscous", MAP, vary="kinetic_coefficient", fixed=held)
    paths = [estimate.path for estimate in free.estimates if estimate.path.startswith("friction.")]
    assert paths == ["friction.kinetic_coefficient"]


@pytest.mark.parametrize("verb", [fit, select])
@pytest.mark.parametrize(
    "unused",
    [{"route": "balance"}, {"route": "features"}, {"settings": RecordSettings(starts=2)}],
    ids=lambda given: "-".join(map(str, given)),
)
def test_travels_refuse_what_only_records_use(verb, unused):
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    reading = Measurement(travel=0.20, uncertainty=0.005)
    (name,) = unused
    with pytest.raises(InputError, match=rf"^{name} applies to .*it has no effect on travels"):
        verb(rig, "coulomb", reading, **unused)
