"""Travels that are read off films, and the frequency with which a film oscillates."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import Capsule, Coulomb, Measurement, check, select, simulate
from stickslip.data import travels_of_films
from stickslip.data.travels import frequency_of, other_drives
from stickslip.errors import InputError
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Square

PERIOD = "mechanism.drive.drive.period"
LAW = Coulomb(kinetic_coefficient=0.18, static_coefficient=0.24)


def capsule(period: float) -> Capsule:
    wave = Torque(drive=Square(high=6.0, low=-1.0, period=period, duty=0.3))
    return Capsule(capsule_mass=0.8, inner_mass=0.2, stiffness=80.0, damping=0.8, drive=wave)


def film(period: float, rate: float, noise: float, seed: int, stated: float | None = None):
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 4.0, 1.0 / rate)
    time = time[rng.random(time.size) > 0.03]
    x = simulate(capsule(period), LAW, t_end=4.0).at(time)["x"]
    x = 0.3 + x + rng.normal(0.0, noise, time.size)
    return Measurement(time=time, position=x, overrides={PERIOD: stated or period})


@pytest.mark.slow
@pytest.mark.parametrize("rate", [30.0, 60.0, 240.0])
def test_travels_lie_within_their_uncertainty_of_the_true_ones(rate: float) -> None:
    errors = []
    for seed, period in enumerate((0.3, 0.35, 0.4, 0.5) * 3):
        read, t_end = travels_of_films(capsule(0.4), film(period, rate, 2e-4, seed))
        cycles = int(t_end / period + 1e-9)
        run = simulate(capsule(period), LAW, t_end=4.0)
        true = run.at([cycles * period])["x"][0] / cycles
        errors.append((read.travel_per_cycle - true) / read.uncertainty["travel_per_cycle"])
    assert np.sqrt(np.mean(np.square(errors))) < 1.5
    assert np.max(np.abs(errors)) < 4.0


def test_a_film_with_the_frequency_of_another_run_is_refused() -> None:
    films = Measurement(trials=(film(0.3, 60.0, 2e-4, 1), film(0.4, 60.0, 2e-4, 2, stated=0.3)))
    with pytest.raises(InputError, match=r"film 2 oscillates with 2\.5 Hz, and its drive has 3\.3"):
        travels_of_films(capsule(0.4), films)


def test_a_motion_that_repeats_after_three_cycles_is_that_of_its_drive() -> None:
    t = np.arange(0.0, 4.0, 1.0 / 60.0)
    third = 2e-3 * np.sin(2.0 * np.pi * t / 1.2) + 3e-4 * np.sin(2.0 * np.pi * t / 0.4)
    slow = Measurement(time=t, position=0.01 * t + third)
    assert not [*other_drives(capsule(0.4), slow)]
    other = Measurement(time=t, position=0.01 * t + 2e-3 * np.sin(2.0 * np.pi * t / 0.95))
    assert len([*other_drives(capsule(0.4), other)]) == 1


def test_a_slow_film_is_not_that_of_a_fast_drive_whatever_the_ratio() -> None:
    t = np.arange(0.0, 4.0, 1.0 / 60.0)
    for frequency in (0.7, 0.9, 1.25, 2.0, 2.5):
        slow = Measurement(time=t, position=2e-3 * np.sin(2.0 * np.pi * frequency * t))
        assert len([*other_drives(capsule(0.05), slow)]) == 1


def test_a_film_that_begins_after_its_drive_is_refused() -> None:
    late = film(0.4, 60.0, 2e-4, 1)
    later = Measurement(time=late.time + 1.0, position=late.position)
    with pytest.raises(InputError, match="begins 1 s after its drive"):
        travels_of_films(capsule(0.4), later)


def test_films_in_a_plane_count_one_way_whichever_way_each_travels(tmp_path) -> None:
    from stickslip import load_measurement

    signs = []
    for period, sign in ((0.4, 1.0), (0.4, -1.0)):
        one = film(period, 60.0, 1e-4, 3)
        rows = [
            f"{t:.5f},{sign * x:.6f},{0.02 * x:.6f}"
            for t, x in zip(one.time, one.position, strict=True)
        ]
        path = tmp_path / "film.csv"
        path.write_text("\n".join(["t,x,y", *rows]) + "\n")
        read = load_measurement(path, columns={"time": "t", "position": ["x", "y"]})
        signs.append(travels_of_films(capsule(period), read)[0].travel_per_cycle)
    assert signs[0] == pytest.approx(-signs[1], rel=1e-6)


def test_the_frequency_of_a_jerky_motion_is_its_fundamental() -> None:
    time = np.arange(0.0, 3.0, 1 / 60)
    stairs = np.floor(4.3 * time) + np.clip(5.0 * (4.3 * time % 1.0), 0.0, 1.0)
    frequency, share = frequency_of(time, 1e-3 * stairs)
    assert frequency == pytest.approx(4.3, abs=0.03)
    assert share > 0.8


def test_select_reads_films_where_their_route_is_asked_for() -> None:
    films = Measurement(trials=tuple(film(p, 60.0, 1e-4, k) for k, p in enumerate((0.3, 0.4, 0.5))))
    verdict = select(capsule(0.4), ["coulomb"], films, route="travel")
    table = verdict.compared()
    assert list(table["period"]) == [0.3, 0.4, 0.5]
    assert np.allclose(table["measured"], table["predicted"], atol=3e-3)
    assert all(trial.cycles for trial in verdict.trials)
    with pytest.raises(InputError, match="route"):
        select(capsule(0.4), ["coulomb"], Measurement(travel=0.1), route="balance")


def test_check_says_that_a_film_has_another_frequency_than_its_drive() -> None:
    wrong, right = film(0.4, 60.0, 2e-4, 2, stated=0.3), film(0.4, 60.0, 2e-4, 2)
    assert [
        finding.severity for finding in check(wrong, mechanism=capsule(0.4)).of("drive frequency")
    ] == ["error"]
    assert not check(right, mechanism=capsule(0.4)).of("drive frequency")


def test_a_capsule_may_travel_beyond_the_stop_of_what_moves_inside() -> None:
    mechanism = replace(capsule(0.4), upper_stop=0.001)
    assert not check(film(0.4, 60.0, 2e-4, 2), mechanism=mechanism).of("mechanism")
