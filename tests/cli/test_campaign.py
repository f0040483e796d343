"""`stickslip sweep campaign.toml`: its keys, what is written, one message for bad input."""

import json

import pandas as pd
import pytest
from tests.commands import commands

RIG = """
[mechanism]
type = "spring-block"
mass = "1 kg"
stiffness = "100 N/m"
compression = "100 mm"

[friction.coulomb]
kinetic_coefficient = 0.25
static_coefficient = 0.35

[friction.stribeck]
kinetic_coefficient = 0.25
static_coefficient = 0.35
stribeck_velocity = "0.05 m/s"
"""
CAMPAIGN = """
rigs = "block.toml"
laws = ["coulomb", "stribeck"]
t_end = "5 s"
design = "sobol"
runs = 100
part = 40

[factors]
friction.kinetic_coefficient = {low = 0.1, high = 0.3}
"friction.static_coefficient" = {low = 1.0, high = 1.5, times = "kinetic_coefficient"}
compression = {mean = "80 mm", sd = "5 mm", low = "5 cm", high = "10 cm"}

[outputs]
travel = {final = "x"}
fastest = {max = "v", since = "10 ms"}
record = {samples = "x", times = ["0.1 s", 0.2]}
rest = {event-times = "stop"}
stops = {event-count = "stop"}
"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "block.toml").write_text(RIG)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    return tmp_path


@pytest.fixture
def called(here, capsys):
    """Run a command; return exit code, stdout and stderr."""
    return commands(capsys)


def test_a_campaign_is_made_once(called, here):
    code, shown, _ = called("sweep", "campaign.toml")
    assert code == 0
    assert "200 runs, 200 certified, in 6 files" in shown
    table = pd.read_parquet(here / "stickslip-campaign/runs")
    assert {*table.columns[:2]} == {"law", "run"}
    assert len(table) == 200
    assert set(table["law"]) == {"coulomb", "stribeck"}
    assert table["mechanism.compression"].between(0.05, 0.1).all()
    ratio = table["friction.static_coefficient"] / table["friction.kinetic_coefficient"]
    assert ratio.between(1.0, 1.5).all()
    assert {"travel", "fastest", "record.0", "record.1", "rest.0", "stops"} < set(table)
    code, shown, _ = called("sweep", "campaign.toml", "--json")
    told = json.loads(shown)
    assert (code, told["runs"], told["made"]) == (0, 200, 0)


def test_a_dry_run_writes_nothing(called, here):
    code, shown, _ = called("sweep", "campaign.toml", "--dry-run", "--workers", "4")
    assert code == 0
    assert "200 runs in 6 files" in shown
    assert "on 4 cores" in shown
    assert not (here / "stickslip-campaign").exists()


def test_indices_stand_beside_the_runs(called, here):
    text = CAMPAIGN.replace('"sobol"', '"saltelli"').replace('["coulomb", "stribeck"]', '"coulomb"')
    (here / "campaign.toml").write_text(text)
    code, shown, _ = called("sweep", "campaign.toml", "-o", "runs")
    assert code == 0
    assert "Sobol indices of travel from 16 base points." in shown
    table = pd.read_csv(here / "runs/sensitivity.csv")
    assert set(table["output"]) == {"travel", "fastest"}
    assert (here / "runs/sensitivity.svg").read_text().startswith("<svg")


def test_a_factor_may_be_a_parameter_without_a_value(called, here):
    (here / "block.toml").write_text(RIG.replace("static_coefficient = 0.35\n", "", 1))
    text = CAMPAIGN.replace('["coulomb", "stribeck"]', '"coulomb"')
    (here / "campaign.toml").write_text(text.replace('"friction.static_coefficient"', "mu_s"))
    code, shown, told = called("sweep", "campaign.toml")
    assert code == 0, told
    assert "100 runs, 100 certified" in shown


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("design =", "desing =", "Did you mean 'design'"),
        ("block.toml", "blok.toml", "blok.toml"),
        ('"stribeck"]', '"stribek"]', "stribek"),
        ("runs = 100", 'runs = "many"', "runs must be a whole number"),
        ("high = 0.3", "hihg = 0.3", "Did you mean 'high'"),
        (", high = 0.3}", "}", "kinetic_coefficient in [factors] of campaign.toml lacks"),
        ("low = 0.1, high = 0.3", "level = 2", "needs values, or low and high, or mean and sd"),
        ("low = 0.1", "low = 0.5", "low must be below high, got 0.5 and 0.3"),
        ('"5 mm"', '"5 kg"', "kg"),
        ('"10 cm"', '"-10 cm"', "high"),
        ("compression =", "compresion =", "Did you mean"),
        ('times = "kinetic_coefficient"', 'times = "mass"', "must be another factor"),
        ("{final =", "{last =", "travel in [outputs] of campaign.toml needs one of final"),
        ('"10 ms"', '"10 mm"', "mm"),
        ('{event-times = "stop"}', '{event-times = "halt"}', "halt"),
        ('rigs = "block.toml"', "rigs = {}", "rigs must be a file or a name"),
        ('times = "kinetic_coefficient"', "times = 3", "times must be the path of a factor, got 3"),
        ("low = 0.1,", "low = [0.1],", "low"),
        ("low = 0.1,", 'log = "yes", low = 0.1,', "log must be a bool"),
        ('["0.1 s", 0.2]', '"3 s"', "times must be a list"),
        ("travel =", "run =", "'run' is a column of a campaign already"),
        ("[factors]", "[outputs.x]", "[factors] of campaign.toml is missing"),
    ],
)
def test_what_is_no_campaign_is_refused_in_one_sentence(called, here, old, new, said):
    assert old in CAMPAIGN
    (here / "campaign.toml").write_text(CAMPAIGN.replace(old, new))
    code, shown, told = called("sweep", "campaign.toml")
    assert (code, shown) == (2, "")
    assert said in " ".join(told.split())
    assert "Traceback" not in told
    assert not (here / "stickslip-campaign").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("campaign.toml", "--law", "coulomb"), "--law applies to a rig file with --vary"),
        (("block.toml",), "block.toml is a rig file: say what varies"),
        (("demo",), "give a campaign file"),
        (("block.toml", "--vary", "mass=1:2:3", "--dry-run"), "--dry-run applies to campaign"),
        (("campaign.toml", "--executor", "localhost:1"), "--executor takes dask://HOST:PORT"),
        (("campaign.toml", "--executor", "dask://x"), "--executor takes dask://HOST:PORT"),
    ],
)
def test_options_that_do_not_apply_are_refused(called, here, arguments, said):
    code, _, told = called("sweep", *arguments)
    assert code == 2
    assert said in " ".join(told.split())


def test_a_folder_with_another_campaign_is_kept(called, here):
    called("sweep", "campaign.toml")
    (here / "campaign.toml").write_text(CAMPAIGN.replace("runs = 100", "runs = 50"))
    code, _, told = called("sweep", "campaign.toml")
    assert code == 2
    assert "holds the runs of another campaign" in " ".join(told.split())
    code, shown, _ = called("sweep", "campaign.toml", "--force")
    assert code == 0
    assert "100 runs, 100 certified" in shown


def test_a_cluster_takes_the_runs(called, here):
    from distributed import LocalCluster

    whole = called("sweep", "campaign.toml", "-o", "here")
    with LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, dashboard_address=":0", protocol="tcp"
    ) as cluster:
        address = cluster.scheduler_address.replace("tcp://", "dask://")
        code, _, told = called("sweep", "campaign.toml", "-o", "far", "--executor", address)
    assert (whole[0], code) == (0, 0), told
    near, far = (
        json.loads((here / name / "manifest.json").read_text()) for name in ("here", "far")
    )
    assert near == far
