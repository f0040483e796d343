"""What is compiled before laws are fitted."""

import pytest

from stickslip import Coulomb, Dahl, LuGre, Measurement, SpringBlock, select
from stickslip.errors import CompilationError
from stickslip.identification import starting_law
from stickslip.identification.travels import fit as travels_fit
from stickslip.identification.travels.model import trials_of
from stickslip.selection import travels

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
ONE = Measurement(travel=0.2, uncertainty=0.01)
SEVERAL = Measurement(
    trials=[
        Measurement(travel=0.2, uncertainty=0.01),
        Measurement(travel=0.07, uncertainty=0.01, overrides={"mechanism.compression": 0.06}),
    ]
)
LAWS = [starting_law(law) for law in (Coulomb, Dahl, LuGre)]


@pytest.fixture
def asked(monkeypatch):
    """Compile nothing; return what was asked for."""
    seen = {"processes": [], "here": []}

    def remembered(pairs, *, ensembles, progress):
        seen["processes"] += [law.name for _, law in pairs]

    monkeypatch.setattr(travels_fit, "is_writable", lambda: True)
    monkeypatch.setattr(travels_fit, "warm_up", remembered)
    monkeypatch.setattr(travels_fit, "prepare", lambda rig, law: seen["here"].append(law.name))
    return seen


def test_laws_with_bristles_are_compiled_together_if_there_are_several_trials(asked):
    travels_fit.compile_for(trials_of(RIG, SEVERAL, 10.0), LAWS)
    assert set(asked["processes"]) == {"dahl", "lugre"}
    assert set(asked["here"]) == {"dahl", "lugre"}


def test_a_single_trial_is_not_worth_compiling(asked):
    travels_fit.compile_for(trials_of(RIG, ONE, 10.0), LAWS)
    assert asked == {"processes": [], "here": []}


def test_a_single_law_takes_no_process(asked):
    travels_fit.compile_for(trials_of(RIG, SEVERAL, 10.0), LAWS[:2])
    assert asked["processes"] == []
    assert set(asked["here"]) == {"dahl"}


def test_a_cache_that_cannot_be_written_to_is_no_obstacle(asked, monkeypatch):
    monkeypatch.setattr(travels_fit, "is_writable", lambda: False)
    travels_fit.compile_for(trials_of(RIG, SEVERAL, 10.0), LAWS)
    assert asked["processes"] == []
    assert set(asked["here"]) == {"dahl", "lugre"}


def test_processes_that_fail_are_logged_and_done_without(asked, monkeypatch, caplog):
    def failing(*_arguments, **_settings):
        raise CompilationError("a process died")

    monkeypatch.setattr(travels_fit, "warm_up", failing)
    travels_fit.compile_for(trials_of(RIG, SEVERAL, 10.0), LAWS)
    assert set(asked["here"]) == {"dahl", "lugre"}
    assert caplog.messages == ["a process died; going on without processes"]


def test_a_selection_passes_on_how_far_compiling_is(monkeypatch):
    told = []
    monkeypatch.setattr(
        travels, "compile_for", lambda trials, laws, *, progress: progress(1, 2, "a pair")
    )
    select(RIG, [Coulomb], ONE, progress=lambda *news: told.append(news))
    assert told[0] == ("compiling: a pair", 0.5)
    assert {name for name, _ in told[1:]} == {"coulomb"}
