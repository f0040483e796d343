"""Selection for several joints: the law of each is found, and a verdict is for each."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from tests.arm_cases import ARM, GUESSED, JOINTS, LINEAR, QUICK, TRUTH, motion, parts, record

from stickslip import (
    CoulombViscous,
    DirectionDependent,
    Measurement,
    Stribeck,
    fit,
    load_rig,
    select,
    simulate,
    write_report,
)
from stickslip.experiments.rigs.rig_writer import rig_toml
from stickslip.formatting import Scale
from stickslip.formulation import JointTorques
from stickslip.friction import BamM3
from stickslip.kinds.joints.page import posture_section
from stickslip.kinds.joints.selection import joint_specifications
from stickslip.plots import plot_joints

LAWS = {
    "shoulder": DirectionDependent(
        forward_kinetic_coefficient=0.15, backward_kinetic_coefficient=0.25,
        forward_viscous_coefficient=0.02, backward_viscous_coefficient=0.03,
    ),
    "elbow": CoulombViscous(kinetic_coefficient=0.1, viscous_coefficient=0.01),
}  # fmt: skip
TRIED = ["coulomb-viscous", "direction-dependent"]


@pytest.fixture(scope="module")
def verdict():
    return select(GUESSED, TRIED, record(0, LAWS, span=5.0), vary=LINEAR, settings=QUICK)


def test_the_law_of_each_joint_is_named(verdict):
    assert verdict.best.name == "shoulder=direction-dependent,elbow=coulomb-viscous"
    assert verdict.sentence.startswith("Shoulder: use direction-dependent friction")
    assert "Elbow: use Coulomb + viscous friction" in verdict.sentence
    assert (verdict.sweeps, verdict.settled) == (2, True)
    law = verdict.best.fit.law
    assert law["shoulder"].backward_kinetic_coefficient == pytest.approx(0.25, rel=0.05)
    assert law["elbow"].kinetic_coefficient == pytest.approx(0.1, rel=0.05)


def test_each_joint_has_a_ranking_of_all_laws_and_a_control(verdict):
    for name in JOINTS:
        own = verdict.joints[name]
        assert sorted(one.name for one in own.candidates) == TRIED
        assert own.control.score > 3.0 * own.closest.score
        assert own.unit == "N m"
        assert own.closest.score < 0.01  # noise of 0.01 N m, of which the filter leaves a tenth


@pytest.mark.slow
def test_one_multiple_of_a_unit_shows_errors_and_forces_of_all_joints():
    light = replace(ARM, lower_mass=0.01, lower_inertia=4e-4, rotor_inertia=0.0)
    t, q, v, a = motion(0, 4.0)
    forces, _ = JointTorques.of(light, []).along(light, t, q, v, a)
    forces += [15.0, 5e-3] * np.sign(v)
    noise = np.random.default_rng(4).normal(size=forces.shape)
    given = Measurement(
        time=t,
        position=dict(zip(JOINTS, q.T, strict=True)),
        force=dict(zip(JOINTS, (forces + [3.0, 1e-3] * noise).T, strict=True)),
    )
    found = select(light, ["coulomb"], given, settings=QUICK)
    errors = [found.joints[name].closest.score for name in JOINTS]
    assert errors[0] > 100.0 * errors[1] > 0.0
    assert {one.scale for one in (found, *found.joints.values())} == {Scale(1.0, "N m")}
    texts = [found.words.lede, *(one.words.lede for one in found.joints.values())]
    assert all("N m" in text and "mN m" not in text for text in texts)
    assert "mN m" not in str(found.best.fit.score())
    labels = [axes.get_ylabel() for axes in plot_joints(found.best.fit)]
    assert labels == ["torque, N m"] * 2


def test_held_out_errors_of_joints_add_up_to_that_of_their_combination(verdict):
    """Mean squares of blocks, weighted as the fit weighs the rows of the joints."""
    validation, fit = verdict.best.validation, verdict.best.fit
    judged = fit.build(fit.measurement, verdict.plan.horizon)
    seen = judged.linearise(fit.values, slopes=False)
    rows = {name: len(one.residual) for name, one in judged.by_joint(seen).items()}
    per_joint = {name: np.mean(one.losses) for name, one in validation.joints.items()}
    joined = sum(rows[name] * judged.weights[name] ** 2 * per_joint[name] for name in JOINTS)
    # blocks have about as many rows of each joint as their neighbours
    assert joined / sum(rows.values()) == pytest.approx(np.mean(validation.losses), rel=0.1)
    for name in JOINTS:
        chosen = verdict.joints[name].closest
        assert chosen.validation == validation.joints[name]


def test_combinations_on_the_way_are_told_once_each(verdict):
    names = [one.name for one in verdict.candidates]
    assert len(names) == len(set(names))
    assert names[0] == verdict.best.name
    assert "shoulder=coulomb-viscous,elbow=coulomb-viscous" in names
    content = json.loads(json.dumps(verdict.to_dict()))
    assert content["joints"]["elbow"]["best"] == "coulomb-viscous"
    assert content["sweeps"] == 2


@pytest.mark.slow
def test_a_report_has_a_section_for_each_joint_and_the_laws_as_a_rig_file(verdict, tmp_path):
    page = write_report(verdict, tmp_path)
    text = page.read_text()
    for part in ("joint-1", "joint-2", "forces", "mechanism", "combinations", "certificate"):
        assert f'id="{part}"' in text
    assert "could not be produced" not in text
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert len(ids) == len(set(ids))
    rig = load_rig(tmp_path / "law.toml")
    laws = rig.law_by_contact()
    assert laws["elbow"].kinetic_coefficient == pytest.approx(0.1, rel=0.05)
    assert rig.mechanism.upper_inertia == verdict.best.fit.mechanism.upper_inertia


@pytest.mark.slow
def test_residuals_that_follow_the_position_of_another_joint_are_drawn_against_it(
    verdict, sketches
):
    for name in JOINTS:
        sound = posture_section(verdict.joints[name], name, verdict.measurement)
        other = next(one for one in JOINTS if one != name)
        said = f"No test finds a dependence of the residuals on the position of the {other}."
        assert [block.text for block in sound.blocks] == [said]
    t, places, forces = parts(record(0, span=5.0))
    forces["shoulder"] = forces["shoulder"] + 0.05 * np.sin(3.0 * places["elbow"])
    wrong = Measurement(time=t, position=places, force=forces)
    found = select(GUESSED, ["coulomb-viscous"], wrong, vary=LINEAR, settings=QUICK)
    made = posture_section(found.joints["shoulder"], "shoulder", wrong)
    assert made.heading == "The residuals depend on the position of the elbow"
    (figure,) = made.blocks
    assert "an error of the links" in figure.caption
    assert "drawn" not in figure.caption
    alike = dict.fromkeys(("one", "two", "three"), places["elbow"])
    many = replace(wrong, joints={}, position={**places, **alike}, force=forces)
    made = posture_section(found.joints["shoulder"], "shoulder", many)
    assert made.heading.endswith("the elbow, one, two and three")
    assert made.blocks[0].caption.endswith("The first 3 of these 4 joints are drawn.")


@pytest.mark.slow
def test_exchanged_joints_are_said_in_the_verdict_and_among_the_checks():
    t, places, forces = parts(record(0, span=4.0))
    swapped = {"shoulder": forces["elbow"], "elbow": forces["shoulder"]}
    wrong = Measurement(time=t, position=places, force=swapped)
    found = select(GUESSED, ["coulomb"], wrong, vary=LINEAR, settings=QUICK)
    assert found.best is None
    assert "The forces of shoulder and elbow seem to be exchanged" in found.sentence
    assert found.checks.findings[0].severity == "warning"
    assert "exchanged" in found.words.measure_next[0]


@pytest.mark.parametrize(
    ("what", "factor", "said"),
    [
        ("position", 180.0 / np.pi, "The positions of elbow seem to be in degrees"),
        ("force", 1e3, "The forces of elbow seem to be in mN m"),
        ("force", -1.0, "The forces of elbow seem to have the opposite sign"),
    ],
)
def test_a_column_of_another_unit_or_sign_is_named(what, factor, said):
    t, places, forces = parts(record(0, span=4.0))
    columns = {"position": dict(places), "force": dict(forces)}
    columns[what]["elbow"] = factor * np.asarray(columns[what]["elbow"])
    found = fit(GUESSED, "coulomb", Measurement(time=t, **columns), vary=LINEAR, settings=QUICK)
    assert any(one.startswith(said) for one in found.sentences)


@pytest.mark.slow
def test_a_search_that_is_stopped_names_what_it_has():
    told = []

    def stop(name, residual):
        told.append(name)
        return False

    found = select(GUESSED, TRIED, record(1, span=4.0), vary=LINEAR, settings=QUICK, progress=stop)
    assert not found.settled
    assert "had not settled" in found.words.lede
    assert found.closest.name == "shoulder=coulomb-viscous,elbow=coulomb-viscous"
    assert {name.partition(":")[0] for name in told} <= {*JOINTS, "held-out blocks"}


def test_bristles_are_compared_only_where_they_are_asked_for():
    usual = [one.name for one in joint_specifications(None)]
    assert "stribeck" in usual
    assert not {"lugre", "dahl", "dahl-exponent"} & {*usual}
    assert [one.name for one in joint_specifications(["lugre"])] == ["lugre"]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 12])
def test_laws_of_different_kinds_are_named_among_all(seed):
    stribeck = Stribeck(
        kinetic_coefficient=0.15, static_coefficient=0.4, stribeck_velocity=0.8,
        viscous_coefficient=0.02,
    )  # fmt: skip
    several = [record(10 * seed + k, {**TRUTH, "shoulder": stribeck}) for k in range(2)]
    both = Measurement(trials=tuple(several))
    found = select(GUESSED, None, both, vary=LINEAR, settings=QUICK)
    assert found.best.name == "shoulder=stribeck,elbow=coulomb-viscous"


def changed(one, joint, of):
    """Return a record in which the force of a joint is another one."""
    t, places, forces = parts(one)
    return Measurement(time=t, position=places, force={**forces, joint: of(t, places, forces)})


@pytest.mark.slow
def test_a_level_that_changes_along_the_way_of_one_joint_is_a_law_of_that_joint():
    """By 30 % from the middle to either end; without force balances it got Coulomb + viscous."""
    level, _, v, _ = TRUTH["shoulder"].kinetic_coefficient, *motion(3)[1:]

    def along(_, places, forces):
        place = places["shoulder"]
        return forces["shoulder"] + level * 0.3 * place / np.ptp(place) * 2.0 * np.sign(v[:, 0])

    given = changed(record(3), "shoulder", along)
    found = select(GUESSED, None, given, vary=LINEAR, settings=QUICK)
    assert found.best.name == "shoulder=level * linear[position] + viscous,elbow=coulomb-viscous"
    law = found.best.fit.law["shoulder"]
    slope = 0.6 / np.ptp(parts(given)[1]["shoulder"])
    assert law.level_position_slope == pytest.approx(slope, rel=0.05)
    assert law.kinetic_coefficient == pytest.approx(level, rel=0.03)
    assert not found.best.fit.model_errors
    assert "coulomb-viscous" in [one.name for one in found.joints["shoulder"].candidates]


@pytest.mark.slow
def test_a_late_force_of_one_joint_is_a_finding_of_that_joint():
    def late(t, _, forces):
        return np.interp(t - 0.01, t, forces["elbow"])

    given = changed(record(4), "elbow", late)
    found = select(GUESSED, None, given, vary=LINEAR, settings=QUICK)
    assert found.sentence.startswith("Shoulder: use")
    (error,) = found.joints["elbow"].model_errors
    assert "delay" in error.finding or "late" in error.finding
    assert error.effect == pytest.approx(-0.01, abs=1e-3)
    assert not found.joints["shoulder"].model_errors
    (whole,) = found.closest.fit.model_errors
    assert whole.finding.startswith("At the elbow: ")
    alone = fit(GUESSED, "coulomb-viscous", given, vary=["friction.*", *LINEAR], settings=QUICK)
    assert [one.finding[:14] for one in alone.model_errors] == ["At the elbow: "]


@pytest.mark.slow
def test_what_no_law_of_a_joint_explains_is_said_without_a_cause():
    noise = np.random.default_rng(8).normal(size=5000)
    slow = np.convolve(noise, np.ones(100) / 10.0, mode="same")

    given = changed(record(5), "elbow", lambda *_: parts(record(5))[2]["elbow"] + 0.2 * slow)
    found = select(GUESSED, None, given, vary=LINEAR, settings=QUICK)
    (error,) = found.joints["elbow"].model_errors
    assert error.kind == "unexplained"
    assert "of the friction" in error.finding


def geared(seed, share):
    """Return a record of an arm whose elbow has a gear that loses a share of what it transmits."""
    t, q, v, a = motion(seed)
    takes = JointTorques.of(ARM, [])
    forces, _ = takes.along(ARM, t, q, v, a)
    weight, _ = takes.along(ARM, t, q, 0.0 * v, 0.0 * a)
    forces[:, 0] += 0.2 * np.sign(v[:, 0]) + 0.02 * v[:, 0]
    # F = sign(v) (level + share |T|) + viscous v, where T = F + what is left
    left, way = forces[:, 1] + weight[:, 1], np.sign(v[:, 1])
    plain = 0.05 * way + 0.01 * v[:, 1]
    side = np.sign(left + plain)  # the share is below 1: it does not turn the torque
    forces[:, 1] += (plain + share * side * way * left) / (1.0 - share * side * way)
    random = np.random.default_rng(seed)
    return Measurement(
        time=t,
        position=dict(zip(JOINTS, (q + random.normal(0.0, 1e-4, q.shape)).T, strict=True)),
        force=dict(zip(JOINTS, (forces + random.normal(0.0, 0.01, q.shape)).T, strict=True)),
    )


@pytest.fixture(scope="module")
def gear():
    return select(GUESSED, None, geared(3, 0.15), vary=LINEAR, settings=QUICK)


@pytest.mark.slow
def test_a_gear_that_loses_a_share_of_its_torque_is_found_where_masses_are_fitted(gear):
    assert gear.best is not None
    assert {name: one.closest.name for name, one in gear.joints.items()} == {
        "shoulder": "coulomb-viscous",
        "elbow": "bam-m3",
    }
    assert not gear.joints["elbow"].model_errors
    found = gear.best.fit
    for field, true in (("transmitted_coefficient", 0.15), ("kinetic_coefficient", 0.05)):
        one = found.estimate(f"friction.elbow.{field}")
        assert one.low <= true <= one.high
        assert one.high - one.low < 0.2 * true


@pytest.mark.slow
def test_the_law_of_a_gear_that_was_found_is_written_as_a_rig_file(gear, tmp_path):
    fit = gear.best.fit
    path = tmp_path / "law.toml"
    path.write_text(rig_toml(fit.mechanism, fit.law))
    assert load_rig(path).law_by_contact()["elbow"] == fit.law["elbow"]


def test_the_law_of_a_gear_is_written_as_a_rig_file_and_runs(tmp_path):
    laws = LAWS | {
        "elbow": BamM3(
            kinetic_coefficient=0.05, viscous_coefficient=0.01, transmitted_coefficient=0.15
        )
    }
    path = tmp_path / "law.toml"
    path.write_text(rig_toml(GUESSED, laws))
    rig = load_rig(path)
    assert rig.law_by_contact() == laws
    run = simulate(rig.mechanism, rig.law_by_contact(), t_end=0.5, y0={"elbow": 1.0})
    assert run.certificate.certified
