"""The verb: what it takes, whose law it is, and files that are written whole or not at all."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, final

import numpy as np
import pytest
from tests.arm_cases import ARM
from typing_extensions import override

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Measurement,
    Rig,
    SpringBlock,
    Stribeck,
    export,
    fit,
    load_rig,
    select,
)
from stickslip.data import KnownLaws, LawEstimates
from stickslip.errors import InputError, UnknownNameError
from stickslip.exports import TARGETS, Target
from stickslip.exports.program import identifier, identifiers
from stickslip.friction import RateState, SetValuedLaw
from stickslip.maths import Scalar
from stickslip.quantities import Quantity

LAW = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.4)
KNOWN = LawEstimates(
    law={"elbow": "coulomb", "shoulder": "coulomb-viscous"},
    intervals={"elbow.kinetic_coefficient": (0.9, 1.1), "shoulder.kinetic_coefficient": (1.9, 2.1)},
    covariance_of=("elbow.kinetic_coefficient", "shoulder.kinetic_coefficient"),
    covariance=((1.0, 0.2), (0.2, 4.0)),
    not_identified={"shoulder.viscous_coefficient": "too slow"},
    levels="torques",
)


def test_every_target_is_registered_under_its_name():
    for name, target in TARGETS.items():
        assert isinstance(target, Target)
        assert target.name == name
    assert list(TARGETS) == ["c", "matlab", "mjcf", "urdf", "csv", "json"]


@pytest.mark.parametrize("target", TARGETS)
def test_each_target_names_law_parameters_units_and_version_and_is_the_same_twice(target):
    first, second = (export(LAW, target, load=5.0, largest_speed=0.5).files for _ in range(2))
    assert first == second
    text = "".join(first.values())
    for words in ("Coulomb + viscous", "coulomb-viscous", "0.25", "0.4", "N s/m", "stickslip"):
        assert words in text, words


def test_a_verdict_exports_the_law_to_use_with_its_interval():
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    verdict = select(block, [Coulomb], Measurement(travel=0.15, uncertainty=0.005))
    source = export(verdict, "c").files["coulomb.c"]
    value = verdict.best.fit.estimate("kinetic_coefficient").value
    assert f"const double mu_k = {value!r}; /* [1] kinetic coefficient, 95 %: " in source


def test_laws_by_contact_are_exported_one_by_one_with_their_own_intervals():
    laws = {
        "elbow": Coulomb(kinetic_coefficient=1.0),
        "shoulder": CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=0.3),
    }
    contacts = {
        name: KnownLaws(laws={law.name: law}, named=(law.name,)) for name, law in laws.items()
    }
    rig = Rig(mechanism=ARM, contacts=contacts, estimates=KNOWN)
    source = export(rig, "c", contact="shoulder").files["coulomb_viscous.c"]
    assert "[N m] kinetic coefficient, 95 %: 1.9 to 2.1" in source
    assert "[N m s/rad] viscous coefficient, not identified: too slow" in source
    with pytest.raises(InputError, match="choose one with --contact"):
        export(rig, "c")
    with pytest.raises(UnknownNameError, match="wrist"):
        export(rig, "c", contact="wrist")
    own = KNOWN.of_contact("shoulder", rotary=True)
    assert own.law == "coulomb-viscous"
    assert own.covariance == ((4.0,),)


def test_levels_that_are_forces_have_no_load_unless_it_is_said():
    rig = Rig(
        mechanism=Axis(inertia=1.0), laws={"coulomb-viscous": LAW}, named=("coulomb-viscous",)
    )
    assert "the load is 1" in export(rig, "c").files["coulomb_viscous.c"]
    with pytest.raises(InputError, match="which have no normal force"):
        export(rig, "csv", load=20.0, largest_speed=1.0)
    divided = export(rig, "csv", law_load=20.0, largest_speed=1.0).files["coulomb_viscous.csv"]
    assert "at a load of 20.0 N" in divided
    assert "Break-away forward: 0.25 N" in divided


def test_a_law_on_the_rig_of_its_use_takes_its_load_and_the_speeds_of_its_motion():
    block = SpringBlock(mass=2.0, stiffness=100.0, compression=0.1)
    rig = Rig(mechanism=block, t_end=2.0)
    text = export(LAW, "csv", rig=rig).files["coulomb_viscous.csv"]
    assert "at a load of 19.62 N" in text
    fastest = float(text.splitlines()[-1].split(",")[0])
    assert 0.2 < fastest < 0.1 * np.sqrt(100.0 / 2.0)


@pytest.mark.parametrize("what", [None, 3.0, "coulomb", RateState(
    reference_coefficient=0.6, direct_effect=0.01, reference_velocity=1e-6, evolution="none"
)])  # fmt: skip
def test_what_is_no_law_is_refused_in_one_sentence(what):
    with pytest.raises(InputError, match="export takes a friction law, a fit, a verdict or a rig"):
        export(what, "c")


def test_unknown_targets_name_the_known_ones():
    with pytest.raises(UnknownNameError, match="unknown target 'simulink'"):
        export(LAW, "simulink")


@pytest.mark.parametrize("name", ["", " ", "+-", "***"])
def test_a_name_without_a_letter_or_digit_is_refused(name):
    with pytest.raises(InputError, match="needs a letter or a digit"):
        export(LAW, "c", name=name)


@pytest.mark.parametrize(
    "name", ["my axis", "../../evil", "C:\\x", "2nd", "double", "ünïcode", "名", "a" * 300, "x.y"]
)
def test_names_of_any_spelling_become_file_names_within_the_folder(name, tmp_path):
    paths = export(LAW, "c", name=name).save(tmp_path)
    assert all(path.parent == tmp_path for path in paths)
    assert all(len(path.name) < 60 for path in paths)
    assert paths[0].stem.isidentifier()
    assert paths[0].stem.isascii()


def test_files_are_replaced_only_by_force_and_all_or_none_are_written(tmp_path):
    found = export(LAW, "c")
    (tmp_path / "coulomb_viscous.c").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match=r"already exists; give --force \(in Python force=True\)"):
        found.save(tmp_path)
    assert not (tmp_path / "coulomb_viscous.h").exists()
    found.save(tmp_path, force=True)
    assert "mine" not in (tmp_path / "coulomb_viscous.c").read_text(encoding="utf-8")
    with pytest.raises(InputError, match="cannot be written"):
        found.save(tmp_path / "coulomb_viscous.c" / "below")


def test_identifiers_differ_even_where_symbols_do_not():
    assert identifiers(["mu", "mu", "μ", "m u"], ["mu_2"]) == ("mu", "mu_3", "mu_4", "m_u")
    assert identifier("λ") == "lambda"
    assert identifier("Σ_+") == "Sigma_plus"


def test_a_rig_with_several_laws_asks_which():
    with pytest.raises(InputError, match="has several laws"):
        export(load_rig(), "c")
    assert "stribeck.c" in export(load_rig(), "c", law="stribeck").files


def test_a_fit_is_exported_as_it_stands():
    v = np.linspace(0.01, 1.0, 50)
    law = Stribeck(kinetic_coefficient=2.0, static_coefficient=2.6, stribeck_velocity=0.05)
    table = Measurement(velocity=v, friction=[law.force(speed, 1.0) for speed in v])
    found = export(fit(Axis(inertia=1.0), law, table), "csv")
    assert "Fitted at speeds up to 1 m/s" in found.files["stribeck.csv"]
    assert found.files["stribeck.csv"].splitlines()[-1].startswith("1.0,")


def test_a_verdict_that_names_no_law_says_so_and_what_to_export():
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    verdict = select(block, [Coulomb], Measurement(travel=0.15, uncertainty=0.005))
    with pytest.raises(InputError, match=r"names no law to export: .* verdict.candidates\[0\].fit"):
        export(replace(verdict, best=None), "c")


@final
@dataclass(frozen=True, kw_only=True)
class Branching(SetValuedLaw):
    """Equations that cannot be written down: an `if`, or a number without end."""

    name: ClassVar[str] = "branching"
    title: ClassVar[str] = "Branching"
    formula: ClassVar[str] = "F"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ()

    knee: float = 0.1
    level: Annotated[float, Quantity("mu", low=0)] = 0.3

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        beyond = self.knee if math.isinf(self.knee) or speed > self.knee else 0.0
        return self.level * load + beyond

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return self.level * load


@pytest.mark.parametrize(
    ("knee", "message"), [(0.1, "no truth value"), (math.inf, "no finite number")]
)
def test_equations_that_cannot_be_written_down_are_refused_with_the_reason(knee, message):
    with pytest.raises(InputError, match=f"Branching cannot be exported: .*{message}"):
        export(Branching(knee=knee), "c")


@final
@dataclass(frozen=True, kw_only=True)
class Steep(SetValuedLaw):
    """Friction that grows with the fourth power of the speed."""

    name: ClassVar[str] = "steep"
    title: ClassVar[str] = "Steep"
    formula: ClassVar[str] = r"F = \mu N + c v^4"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ()

    level: Annotated[float, Quantity("mu", low=0)] = 0.3
    slope: Annotated[float, Quantity("c", "N s^4/m^4", low=0)] = 1.0

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        return self.level * load + self.slope * speed * speed * speed * speed

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return self.level * load


@pytest.mark.parametrize("target", ["csv", "mjcf"])
@pytest.mark.parametrize(("rotary", "unit"), [(False, "m/s"), (True, "rad/s")])
def test_forces_beyond_all_numbers_are_refused(target, rotary, unit):
    load = None if rotary else 1.0
    with pytest.raises(InputError, match=rf"is not finite up to 1e\+90 {unit} at a load of 1:"):
        export(Steep(), target, load=load, largest_speed=1e90, rotary=rotary)


@pytest.mark.parametrize("target", TARGETS)
def test_a_law_without_friction_is_exported_too(target):
    none = Coulomb(kinetic_coefficient=0.0)
    assert export(none, target, load=1.0, largest_speed=1.0).files
