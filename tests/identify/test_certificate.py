"""Certificates: a run of what a verdict hands over, under the recorded force."""

import json
from dataclasses import replace

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from stickslip import (
    Axis,
    CoulombViscous,
    Measurement,
    Pendulum,
    select,
    simulate,
    write_report,
)
from stickslip.identify import BandVerdict
from stickslip.identify.certificate import NOT_RUN, certificate_of
from stickslip.identify.selection import certified
from stickslip.mechanisms.drives import Sampled

RIG = Axis(inertia=0.05, rotary=True)
LAW = CoulombViscous(kinetic_coefficient=0.6, viscous_coefficient=0.25)


def driven(side=1.0):
    """Return the record of an axis under two sines, or of its mirror."""
    t = np.arange(0.0, 4.0, 0.004)
    force = 3.0 * np.sin(2.0 * np.pi * 0.7 * t) + 2.0 * np.sin(2.0 * np.pi * 1.9 * t)
    drive = Sampled(times=tuple(t), values=tuple(force), hold="first")
    run = simulate(replace(RIG, drive=drive, offset=0.1), LAW, t_end=float(t[-1]))
    place = run.at(t)["x"] + 1e-5 * np.random.default_rng(1).normal(size=len(t))
    return Measurement(time=t, position=side * place, force=side * force, turning=True)


def judged(record, laws=None):
    return select(RIG, laws, record, vary=["mechanism.inertia", "friction.*"])


@pytest.fixture(scope="module")
def verdict():
    return judged(driven(), [CoulombViscous])


def test_a_sound_axis_is_followed_and_friction_takes_all_the_work(verdict):
    seen = verdict.certificate
    assert seen.run_error < 0.01
    assert seen.run_error < seen.expected_error < 0.05
    assert 0.97 < seen.friction_work < 1.03
    assert not seen.is_beaten


def test_an_inertia_doubled_by_hand_is_not_followed_and_the_verdict_says_so_first(verdict):
    wrong = replace(verdict.mechanism, inertia=2.0 * verdict.mechanism.inertia)
    found = certified(replace(verdict, mechanism=wrong))
    assert found.certificate.run_error > 0.3
    assert found.sentence.startswith("! Run with the recorded force, Coulomb + viscous friction by")
    assert found.to_dict()["certificate"]["plain_is_better"]


def test_a_level_halved_by_hand_leaves_half_the_work(verdict):
    rung = verdict.judgement.named
    names = [name for name, _ in rung.structure]
    halved = np.where(np.isin(names, ["level", "viscous"]), 0.5, 1.0) * rung.coefficients
    judgement = replace(verdict.judgement)
    judgement.__dict__["named"] = replace(rung, coefficients=halved)
    seen = certificate_of(judgement, verdict.mechanism)
    assert seen.friction_work == pytest.approx(0.5 * verdict.certificate.friction_work, rel=1e-6)
    assert seen.is_beaten


@pytest.mark.slow
def test_the_mirrored_record_has_the_same_certificate(verdict):
    seen, other = verdict.certificate, judged(driven(-1.0), [CoulombViscous]).certificate
    assert other.plain_error == pytest.approx(seen.plain_error, rel=1e-6)
    assert other.friction_work == pytest.approx(seen.friction_work, rel=1e-3)
    # draws of the posterior are not mirrored: they move the law by a part of its uncertainty
    assert other.run_error == pytest.approx(seen.run_error, abs=seen.expected_error)
    assert other.duration == pytest.approx(seen.duration)


def test_the_lede_the_notebook_and_the_document_have_the_certificate(verdict, tmp_path):
    line = str(verdict.certificate)
    assert "this law and mechanism follow the motion to" in line
    assert line in str(verdict)
    assert "least squares" in verdict._repr_html_()
    assert verdict.words.lede.endswith(line)
    told = json.loads(json.dumps(verdict.to_dict()))
    assert told["certificate"]["run_error"] == verdict.certificate.run_error
    Draft202012Validator(BandVerdict.schema()["properties"]["certificate"]).validate(
        told["certificate"]
    )


@pytest.mark.slow
def test_the_first_figure_of_a_report_is_the_motion(verdict, tmp_path):
    page = write_report(verdict, tmp_path / "out").read_text(encoding="utf-8")
    first = page.index('aria-label="Measured and simulated motion over time')
    assert first < page.index('aria-label="Friction against velocity')


def test_a_run_that_fails_has_no_number(verdict):
    lost = replace(verdict.certificate, run_error=np.inf, expected_error=np.nan)
    assert lost.to_dict()["run_error"] is None
    assert "more than 100 %" in str(lost)


@pytest.mark.slow
def test_a_swing_is_run_whole_and_followed():
    t = np.arange(0.0, 15.0, 0.02)
    rig = Pendulum(mass=0.2, length=0.5)
    law = CoulombViscous(kinetic_coefficient=0.002, viscous_coefficient=0.002)
    angle = simulate(rig, law, t_end=15.0, y0={"theta": 0.6}).at(t)["theta"]
    noise = 1e-4 * np.random.default_rng(1).normal(size=len(t))
    found = select(rig, [CoulombViscous], Measurement(time=t, position=angle + noise, turning=True))
    seen = found.certificate
    assert seen.is_whole
    assert seen.run_error < 1.1 * seen.expected_error < 0.01
    assert 0.97 < seen.friction_work < 1.03
    assert str(seen).startswith("Run from its start")


def test_what_no_force_moves_has_no_certificate():
    v = np.linspace(0.1, 1.0, 20)
    noise = 0.01 * np.random.default_rng(1).normal(size=20)
    table = Measurement(velocity=v, friction=1.0 + 0.3 * v + noise)
    assert select(Axis(inertia=1.0), [CoulombViscous], table).certificate is None


def test_what_cannot_be_run_says_why(verdict):
    judgement = replace(verdict.judgement)
    judgement.__dict__["composition"] = replace(judgement.composition, load=np.array([-1.0]))
    said = certificate_of(judgement, verdict.mechanism)
    assert said.startswith(NOT_RUN.format(""))
    assert "must be at least 0" in said


def test_a_swing_with_a_spring_that_nobody_gave_is_said_to_lack_something():
    inertia, step, angle, speed, angles = 0.6 * 0.35**2 + 0.003, 2e-4, 1.1, 0.0, []
    for n in range(90_000):
        if n % 50 == 0:
            angles.append(angle)
        force = -0.6 * 9.81 * 0.35 * np.sin(angle) - 0.15 * (angle - 0.1) - 0.003 * speed
        free, most = speed + step * force / inertia, step * 0.011 / inertia
        speed = 0.0 if abs(free) <= most else free - np.copysign(most, free)
        angle += step * speed
    noise = 6e-4 * np.random.default_rng(1).normal(size=len(angles))
    swing = Measurement(
        time=0.01 * np.arange(len(angles)), position=np.array(angles) + noise, turning=True
    )
    found = select(Pendulum(mass=0.6, length=0.35, inertia=0.003), None, swing)
    assert found.certificate.is_incomplete
    assert not found.certificate.is_beaten
    assert "something of the mechanism is missing" in found.words.verdict
    assert found.to_dict()["certificate"]["reading_error"] < 0.002
