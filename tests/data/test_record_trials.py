"""Trials of a rig file that are records, each with settings of its own."""

import pytest

from stickslip import load_rig
from stickslip.errors import InputError

RIG = """
[mechanism]
type = "axis"
inertia = "5 kg"
[data]
columns = { position = "q" }
units = { position = "mm" }
offset = { position = "1 mm" }
"""
TRIALS = """
[[trial]]
file = "empty.csv"
[[trial]]
name = "loaded"
file = "loaded.csv"
set = { inertia = "6.2 kg" }
initial = { v = "20 mm/s" }
offset = { force = "0.4 N" }
columns = { force = "u" }
"""


@pytest.fixture
def rig(tmp_path):
    """Write two records and a rig that names them; return the rig as it is read."""
    (tmp_path / "empty.csv").write_text("time,q,force\n0,1,2\n1,2,2\n2,4,2\n")
    (tmp_path / "loaded.csv").write_text("time,q,u\n0,1,10.4\n1,2,10.4\n2,4,10.4\n")
    (tmp_path / "travels.csv").write_text("travel [mm]\n72\n")

    def build(text=RIG + TRIALS, **overrides):
        (tmp_path / "axis.toml").write_text(text)
        return load_rig(tmp_path / "axis.toml", overrides=overrides)

    return build


def test_each_record_has_its_own_overrides_start_and_offset(rig):
    empty, loaded = rig().measurement.records()
    assert (empty.name, loaded.name) == ("empty", "loaded")
    assert (empty.overrides, loaded.overrides) == ({}, {"mechanism.inertia": 6.2})
    assert (empty.initial, loaded.initial) == ({}, {"v": 0.02})
    assert loaded.values("force").tolist() == pytest.approx([10.0] * 3, rel=1e-12)


def test_what_data_say_of_columns_holds_for_the_files_of_trials(rig):
    for record in rig().measurement.records():  # mm less an offset of one
        assert record.values("position").tolist() == pytest.approx([0.0, 0.001, 0.003], abs=1e-12)


def test_a_trial_s_settings_can_be_set_from_outside(rig):
    changed = rig(**{"trial.1.set.inertia": "7 kg"})
    assert changed.measurement.records()[1].overrides == {"mechanism.inertia": 7.0}


def test_the_digest_is_that_of_the_files_of_trials_too(rig, tmp_path):
    before = rig().digest
    with (tmp_path / "loaded.csv").open("a") as file:
        file.write("3,6,10.4\n")
    assert rig().digest != before


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (RIG + TRIALS.replace("loaded.csv", "no.csv"), "trial.1: "),
        (RIG + TRIALS + 'travel = "1 mm"\n', "trial.1: travel applies to a travel"),
        (RIG + TRIALS + "uncertainty = 1\n", "trial.1: uncertainty applies to a travel"),
        (RIG + TRIALS.replace("inertia =", "inertja ="), "trial.1.set: "),
        (RIG + TRIALS.replace("v =", "w ="), "trial.1.initial"),
        (RIG + TRIALS.replace('"0.4 N"', '"1 kg"'), "trial.1.offset.force"),
        (RIG + "[[trial]]\ntravel = 1\ngain = { force = 1 }\n", "trial.0: gain applies to the"),
        (RIG + TRIALS + "[[trial]]\ntravel = 1\n", "Trials must be of one kind"),
        (
            RIG + TRIALS + '[[trial]]\nname = "loaded"\nfile = "empty.csv"\n',
            "have the same name, 'loaded'",
        ),
        (RIG + TRIALS.replace("columns = { force", "columns = { forse"), "trial.1: "),
    ],
)
def test_mistakes_name_the_rig_file_and_the_trial(rig, text, message):
    with pytest.raises(InputError) as caught:
        rig(text)
    assert "axis.toml" in str(caught.value)
    assert message in str(caught.value)
