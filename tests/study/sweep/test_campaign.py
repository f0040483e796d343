"""Campaigns: designs, files that survive any end, executors, and indices against closed forms."""

import hashlib
import json
import os
import signal
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import duckdb
import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from scipy import stats

from stickslip import Axis, Coulomb, SpringBlock, ensemble
from stickslip.engine import EventTimes, Final, Max, Status
from stickslip.engine.executors import Inline
from stickslip.errors import InputError
from stickslip.study.sweep import Campaign, Case, Design, Levels, Normal, Uniform, campaign
from stickslip.study.sweep.design import indices_of

BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
MU = "friction.kinetic_coefficient"
TWO = {MU: Uniform(low=0.1, high=0.3), "mechanism.mass": Normal(mean=1.0, sd=0.05)}
OUTPUTS = {"travel": Final("x"), "fastest": Max("v"), "rest": EventTimes("stop", -1)}


def asked(**changes):
    """Return a small campaign of several files."""
    settings = {"factors": TWO, "design": "random", "runs": 50, "part": 8, "outputs": OUTPUTS}
    settings["cases"] = (Case(mechanism=BLOCK, law=LAW, t_end=10.0),)
    return Campaign(**(settings | changes))


def files(folder):
    """Return the hash of each file below a folder."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


# Designs.

KINDS = [("random", 40), ("sobol", 40), ("saltelli", 40), ("morris", 39)]


@pytest.mark.parametrize(("kind", "runs"), [("grid", None), *KINDS])
def test_runs_do_not_depend_on_where_a_part_begins(kind, runs):
    factors = {"a": Levels(values=(1.0, 2.0, 5.0)), "b": Uniform(low=0.1, high=9.0, number=4)}
    design = Design(factors=factors, kind=kind, runs=runs, seed=3)
    whole = design.rows(0, len(design))
    for cut in (1, 5, len(design) - 1):
        parts = [design.rows(0, cut), design.rows(cut, len(design))]
        for path, values in whole.items():
            np.testing.assert_array_equal(np.concatenate([part[path] for part in parts]), values)


def test_a_grid_has_all_combinations_the_last_factor_fastest():
    design = Design(factors={"a": Levels(values=[1, 2]), "b": Levels(values=[5, 6, 7])})
    rows = design.rows(0, 6)
    assert rows["a"].tolist() == [1, 1, 1, 2, 2, 2]
    assert rows["b"].tolist() == [5, 6, 7, 5, 6, 7]


def test_factors_have_their_distributions():
    share = np.linspace(0.01, 0.99, 99)
    normal = Normal(mean=2.0, sd=0.3)
    np.testing.assert_allclose(normal.at(share), stats.norm.ppf(share, 2.0, 0.3), rtol=1e-12)
    cut = Normal(mean=2.0, sd=0.3, low=1.9, high=2.5)
    known = stats.truncnorm.ppf(share, -0.1 / 0.3, 0.5 / 0.3, 2.0, 0.3)
    np.testing.assert_allclose(cut.at(share), known, rtol=1e-9)
    log = Uniform(low=1e-3, high=10.0, log=True)
    np.testing.assert_allclose(log.at(share), 10.0 ** (-3.0 + 4.0 * share), rtol=1e-12)
    assert np.isfinite(normal.at(np.array([0.0, 1.0]))).all()


def test_a_factor_may_be_a_multiple_of_another():
    static = Uniform(low=1.0, high=1.5, times=MU)
    design = Design(factors={"static": static, MU: TWO[MU]}, kind="sobol", runs=100)
    rows = design.rows(0, 100)
    ratio = rows["static"] / rows[MU]
    assert ratio.min() >= 1.0
    assert ratio.max() <= 1.5


def test_more_runs_of_a_random_design_are_further_ones():
    few, many = (Design(factors=TWO, kind="random", runs=n) for n in (10, 100))
    np.testing.assert_array_equal(few.rows(0, 10)[MU], many.rows(0, 10)[MU])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"design": "latin"}, "design must be one of grid, random"),
        ({"design": "grid", "runs": None}, "a grid needs the values"),
        ({"design": "grid"}, "leave runs out"),
        ({"runs": 0}, "runs must be a whole number of at least 1, got 0"),
        ({"seed": -1}, "seed must be"),
        ({"part": 0}, "part must be"),
        ({"factors": {}}, "at least one parameter"),
        ({"factors": {MU: Uniform(low=0.1, high=0.2, times="mass")}}, "another factor"),
        ({"design": "morris"}, "need low and high of mechanism.mass"),
        ({"design": "saltelli", "runs": 3}, "at least 4 runs"),
        ({"runs": 2**40}, "exceed the limit"),
    ],
)
def test_what_is_no_design_is_refused(changes, said):
    with pytest.raises(InputError, match=said):
        len(asked(**changes))


# Runs and files.


def test_runs_are_those_of_an_ensemble(tmp_path):
    wanted = asked()
    found = wanted.run(tmp_path / "runs")
    rows = wanted.whole.rows(0, 50)
    known = ensemble(BLOCK, LAW, rows, t_end=10.0, outputs=OUTPUTS)
    table = found.to_dataframe()
    assert table["run"].tolist() == list(range(50))
    for path, values in rows.items():
        np.testing.assert_array_equal(table[path], values)
    for name in ("travel", "fastest"):
        np.testing.assert_array_equal(table[name], known[name])
    np.testing.assert_array_equal(table["rest.0"], known["rest"][:, 0])
    assert table["status"].tolist() == [ending.name for ending in known.status]
    assert (found.certified, found.status, found.made) == (50, {"AT_REST": 50}, 50)
    assert len(found.parts) == 7


def test_files_have_units_and_are_read_by_other_libraries(tmp_path):
    found = asked(cases=cases(), outputs=["x"]).run(tmp_path / "runs")
    field = pq.read_schema(tmp_path / "runs" / found.parts[0].file).field("x")
    assert field.metadata == {b"unit": b"m"}
    table = pd.read_parquet(tmp_path / "runs/runs", columns=["x", "block"])
    assert table["block"].value_counts().to_dict() == {"01": 50, "a/b": 50}
    query = f"select count(*), sum(x) from '{tmp_path}/runs/runs/*/*.parquet'"
    count, total = duckdb.sql(query).fetchall()[0]
    assert (count, total) == (100, pytest.approx(table["x"].sum(), rel=1e-12))
    assert found.to_dataframe(["block"])["block"].tolist() == ["01"] * 50 + ["a/b"] * 50


def cases():
    """Return two cases with names that no folder may have as they are."""
    names = {"a/b": BLOCK, "01": SpringBlock(mass=0.5, stiffness=100.0, compression=0.1)}
    return tuple(
        Case(mechanism=one, law=LAW, t_end=10.0, labels={"block": name})
        for name, one in names.items()
    )


KILLED = """
import os, pathlib, signal, sys
sys.path.insert(0, sys.argv[1])
from test_campaign import asked
seen = []
def progress(done, total):
    seen.append(done)
    if len(seen) > 2:
        os.kill(os.getpid(), signal.SIGKILL)
for _ in range(3):
    if not (copy := os.fork()):
        asked().run(sys.argv[2], progress=progress)
        os._exit(0)
    _, status = os.waitpid(copy, 0)
    parts = len([*pathlib.Path(sys.argv[2]).rglob("*.parquet")])
    print(os.waitstatus_to_exitcode(status), parts, flush=True)
"""


@pytest.mark.slow
def test_a_campaign_that_is_killed_three_times_ends_with_the_same_files(tmp_path):
    asked().run(tmp_path / "whole")
    command = [sys.executable, "-c", KILLED, str(Path(__file__).parent), str(tmp_path / "own")]
    done = subprocess.run(command, check=False, capture_output=True)
    ends, there = zip(*(map(int, line.split()) for line in done.stdout.splitlines()), strict=True)
    assert ends == (-signal.SIGKILL,) * 3, done.stderr
    assert 0 < there[0] < there[1] < there[2]
    found = asked().run(tmp_path / "own")
    assert found.made < 50
    assert files(tmp_path / "own") == files(tmp_path / "whole")


def test_what_is_cut_off_or_changed_is_made_again(tmp_path):
    whole = files(asked().run(tmp_path / "whole").folder)
    asked().run(tmp_path / "own", progress=lambda done, _: done < 20)
    journal = tmp_path / "own/parts.jsonl"
    lines = journal.read_text()
    journal.write_text(lines[:-30])
    first = next((tmp_path / "own/runs").glob("*.parquet"))
    first.write_bytes(first.read_bytes()[:-1])
    assert asked().run(tmp_path / "own").complete
    assert files(tmp_path / "own") == whole
    last = sorted((tmp_path / "own/runs").glob("*.parquet"))[-1]
    last.unlink()
    assert asked().run(tmp_path / "own").made == 2
    assert files(tmp_path / "own") == whole
    assert asked().run(tmp_path / "own").made == 0


def test_a_folder_holds_one_campaign(tmp_path):
    asked().run(tmp_path / "own")
    with pytest.raises(InputError, match="another campaign"):
        asked(seed=1).run(tmp_path / "own")
    found = asked(seed=1).run(tmp_path / "own", replace=True)
    assert files(found.folder) == files(asked(seed=1).run(tmp_path / "new").folder)
    (tmp_path / "other").mkdir()
    (tmp_path / "other/thesis.tex").write_text("mine")
    for over in (False, True):
        with pytest.raises(InputError, match="holds other files"):
            asked().run(tmp_path / "other", replace=over)
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match="is a file, but a folder is needed"):
        asked().run(tmp_path / "file")
    mine = tmp_path / "web/runs/thesis.txt"
    mine.parent.mkdir(parents=True)
    mine.write_text("precious")
    (tmp_path / "web/manifest.json").write_text('{"name": "my app"}')
    for over in (False, True):
        with pytest.raises(InputError, match="is of no campaign"):
            asked().run(tmp_path / "web", replace=over)
    assert mine.read_text() == "precious"
    (tmp_path / "own/manifest.json").write_text("{")
    with pytest.raises(InputError, match=r"manifest\.json cannot be read"):
        asked().run(tmp_path / "own")


def test_entries_that_are_not_whole_are_made_again(tmp_path):
    folder = asked().run(tmp_path / "own").folder
    whole = files(folder)
    told = json.loads((folder / "manifest.json").read_text())
    del told["parts"][0]["rows"]
    told["parts"][1]["file"] = "../other"
    (folder / "manifest.json").write_text(json.dumps(told))
    assert asked().run(folder).made == 16
    assert files(folder) == whole


def small(**changes):
    """Return a campaign of two files."""
    return asked(**({"runs": 4, "part": 2} | changes))


def refusal(campaign, folder):
    """Run a campaign, and return why it was refused."""
    try:
        assert campaign.run(folder, replace=True).complete
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    "name",
    [
        "runs/../../victim.parquet",
        "runs/../../part-000000.parquet",
        "runs/a/../../../part-000000.parquet",
        "runs/out/part-000000.parquet",
        "../part-000000.parquet",
        "{parent}/part-000000.parquet",
        "runs/\0part-000000.parquet",
        "runs/..",
        "runs",
        5,
        None,
        ["runs"],
    ],
)
def test_a_manifest_names_no_file_outside_its_folder(name, tmp_path):
    own = small().run(tmp_path / "own").folder
    victims = [tmp_path / "victim.parquet", tmp_path / "part-000000.parquet"]
    victims.append(tmp_path / "out/part-000000.parquet")
    victims[-1].parent.mkdir()
    for victim in victims:
        victim.write_text("precious")
    (own / "runs/out").symlink_to(tmp_path / "out")
    told = json.loads((own / "manifest.json").read_text())
    told["parts"][0]["file"] = name.format(parent=tmp_path) if isinstance(name, str) else name
    (own / "manifest.json").write_text(json.dumps(told))
    said = refusal(small(seed=1), own)
    assert bool(said) == (name == "runs/out/part-000000.parquet"), said
    assert not said or "reached by a symbolic link" in said
    assert [path.read_text() for path in victims] == ["precious"] * 3


@pytest.mark.skipif(sys.platform == "win32", reason="no symbolic links, no pipes")
@pytest.mark.parametrize("place", ["runs", ".lock"])
def test_a_campaign_follows_no_symbolic_link(place, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "own").mkdir()
    target = tmp_path / ("out" if place == "runs" else "out/new")
    (tmp_path / "own" / place).symlink_to(target)
    if place == "runs":
        (tmp_path / "own/manifest.json").write_text('{"schema": "stickslip/campaign/1"}')
    with pytest.raises(InputError, match="symbolic link"):
        small().run(tmp_path / "own", replace=True)
    assert not [*(tmp_path / "out").iterdir()]


DAMAGES = {
    "manifest-cut": ("manifest.json", lambda data: data[:-40]),
    "manifest-of-bytes": ("manifest.json", lambda _: b"\xff\xfe\x00"),
    "manifest-empty": ("manifest.json", lambda _: b""),
    "manifest-deep": ("manifest.json", lambda _: b"[" * 100_000),
    "manifest-a-list": ("manifest.json", lambda _: b"[]"),
    "parts-a-number": (
        "manifest.json",
        lambda _: b'{"schema": "stickslip/campaign/1", "parts": 5}',
    ),
    "parts-null": ("manifest.json", lambda _: b'{"schema": "stickslip/campaign/1", "parts": null}'),
    "parts-mixed": ("manifest.json", lambda _: b'{"schema": "stickslip/campaign/1", "parts": [5]}'),
    "digest-wrong": ("manifest.json", lambda data: data.replace(b'"sha256": "', b'"sha256": "0')),
    "rows-text": ("manifest.json", lambda data: data.replace(b'"rows": 2', b'"rows": "2"')),
    "rows-wrong": ("manifest.json", lambda data: data.replace(b'"rows": 2', b'"rows": 200')),
    "status-a-list": (
        "manifest.json",
        lambda data: data.replace(b'"AT_REST": 2', b'"AT_REST": []'),
    ),
    "part-cut": ("runs/part-000000.parquet", lambda data: data[:-10]),
    "part-empty": ("runs/part-000001.parquet", lambda _: b""),
    "journal-of-bytes": ("parts.jsonl", lambda _: b"\xff\xfe\n"),
    "journal-half-a-line": ("parts.jsonl", lambda _: b'{"file": "runs/part-0'),
    "journal-deep": ("parts.jsonl", lambda _: b"[" * 100_000),
    "journal-of-numbers": ("parts.jsonl", lambda _: b"5\nnull\n[]\n"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damages_are_mended_or_refused_in_a_sentence(damage, tmp_path):
    whole = files(small().run(tmp_path / "own").folder)
    name, change = DAMAGES[damage]
    path = tmp_path / "own" / name
    data = path.read_bytes() if path.exists() else b""
    path.write_bytes(change(data))
    assert path.read_bytes() != data
    said = refusal(small(), tmp_path / "own")
    assert bool(said) == damage.startswith("manifest"), said
    assert "\n" not in said
    assert said or files(tmp_path / "own") == whole


@pytest.mark.skipif(sys.platform == "win32", reason="no pipes")
@pytest.mark.parametrize("name", [".lock", "manifest.json", "parts.jsonl"])
def test_a_pipe_in_the_folder_blocks_nothing(name, tmp_path):
    small().run(tmp_path / "own")
    (tmp_path / "own" / name).unlink(missing_ok=True)
    os.mkfifo(tmp_path / "own" / name)
    with pytest.raises(InputError, match="is not a regular file"):
        small().run(tmp_path / "own")


def test_a_part_that_cannot_be_read_is_named(tmp_path):
    found = small().run(tmp_path / "own")
    path = tmp_path / "own/runs/part-000001.parquet"
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(InputError, match=r"part-000001\.parquet is missing or damaged .*again"):
        found.to_dataframe()
    (tmp_path / "own/runs/part-000000.parquet").unlink()
    with pytest.raises(InputError, match=r"part-000000\.parquet is missing or damaged"):
        found.to_dataframe(["travel"])


def test_what_was_being_written_when_a_campaign_was_killed_is_removed(tmp_path):
    left = [".manifest.json", ".parts.jsonl", "runs/.part-000001.parquet", ".sensitivity.csv"]
    own = tmp_path / "own"
    own.mkdir()
    (own / ".manifest.json.tmp-0123abcd").write_text("{")
    whole = files(small().run(own).folder)  # killed before its first file was whole
    for name in left:
        (own / f"{name}.tmp-0123abcd").write_text("{")
    kept = [own / ".mine.tmp-0123abcd", own / "runs/.part-000001.parquet.tmp-mine"]
    for path in kept:
        path.write_text("mine")
    small().run(own)
    assert files(own).keys() - whole.keys() == {str(path.relative_to(own)) for path in kept}


@pytest.mark.skipif(sys.platform == "win32", reason="no locks of files")
def test_two_campaigns_at_once_in_a_folder_are_refused(tmp_path):
    def second(done, total):
        with pytest.raises(InputError, match="another process is running"):
            asked().run(tmp_path / "own")
        return True

    assert asked().run(tmp_path / "own", progress=second).complete
    assert asked().run(tmp_path / "own").made == 0


def test_what_results_depend_on_is_told_apart():
    known = asked().digest
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1 + 1e-17)
    assert asked().digest == known
    close = np.nextafter(block.compression, 1.0)
    for changes in (
        {"seed": 1},
        {"outputs": {**OUTPUTS, "travel": Final("v")}},
        {"part": 9},
        {"cases": (Case(mechanism=BLOCK, law=LAW, t_end=10.0, y0={"v": 1e-300}),)},
        {"cases": (Case(mechanism=replace(block, compression=close), law=LAW, t_end=10.0),)},
    ):
        assert asked(**changes).digest != known


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"outputs": {"run": Final("x")}}, "'run' is a column"),
        ({"outputs": {"block": Final("x")}, "cases": "two"}, "'block' is a column"),
    ],
)
def test_columns_have_names_of_their_own(changes, said):
    if "cases" in changes:
        changes = changes | {"cases": cases()}
    with pytest.raises(InputError, match=said):
        asked(**changes)


@pytest.mark.parametrize(
    ("factors", "said"),
    [
        ({MU: Levels(values=[0.2, 0.3, 0.4])}, "run 2: .*static_coefficient.*at least"),
        ({"mechanism.mass": Levels(values=[1.0, -1.0])}, "mass.* above 0.* got -1"),
        ({"friction.stribeck_velocity": Levels(values=[1.0])}, "unknown parameter"),
    ],
)
def test_values_are_checked_before_anything_is_written(factors, said, tmp_path):
    with pytest.raises(InputError, match=said):
        asked(factors=factors, design="grid", runs=None).run(tmp_path / "runs")
    assert not (tmp_path / "runs").exists()


def test_an_estimate_is_near_what_the_files_take(tmp_path):
    wanted = asked(runs=20_000, part=4096)
    told, found = wanted.estimate(), wanted.run(tmp_path / "runs")
    assert (told.runs, told.files) == (20_000, len(found.parts))
    assert told.size == pytest.approx(found.size, rel=0.3)
    assert told.seconds > 0.0


def test_the_verb_takes_arrays(tmp_path):
    found = campaign(
        BLOCK, LAW, {MU: [0.2, 0.3]}, t_end=10.0, folder=tmp_path / "runs", y0={"v": 0.1}
    )
    known = ensemble(BLOCK, LAW, {MU: [0.2, 0.3]}, t_end=10.0, y0={"v": 0.1})
    assert found.to_dataframe()["x"].tolist() == known["x"].tolist()
    assert "2 runs, 2 certified" in repr(found)


# Executors.


@pytest.mark.slow
@pytest.mark.parametrize("name", ["inline", "processes", "loky"])
def test_any_executor_makes_the_same_files(name, tmp_path):
    whole = files(asked().run(tmp_path / "threads").folder)
    if name == "inline":
        found = asked().run(tmp_path / name, executor=Inline())
    elif name == "processes":
        with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
            found = asked().run(tmp_path / name, executor=pool)
    else:
        from loky import get_reusable_executor

        pool = get_reusable_executor(2)
        found = asked().run(tmp_path / name, executor=pool)
        pool.shutdown()
    assert files(found.folder) == whole


@pytest.mark.slow
def test_a_worker_of_dask_that_is_killed_changes_nothing(tmp_path):
    from distributed import Client, LocalCluster

    runs = {"runs": 400}
    whole = files(asked(**runs).run(tmp_path / "whole").folder)
    killed = []
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster,
        Client(cluster) as client,
    ):
        workers = [*client.run(os.getpid).values()]

        def progress(done, total):
            if done and not killed:
                os.kill(workers[0], signal.SIGKILL)
                killed.append(done)

        executor = client.get_executor()
        found = asked(**runs).run(tmp_path / "dask", executor=executor, progress=progress)
        columns = {MU: np.linspace(0.1, 0.3, 5000)}
        far = ensemble(BLOCK, LAW, columns, t_end=10.0, executor=executor)
    near = ensemble(BLOCK, LAW, columns, t_end=10.0)
    assert killed
    assert files(found.folder) == whole
    np.testing.assert_array_equal(far["x"], near["x"])


def test_what_is_no_executor_is_refused_before_anything_is_written(tmp_path):
    with pytest.raises(InputError, match=r"must be a concurrent\.futures\.Executor, got 2"):
        asked().run(tmp_path / "runs", executor=2)
    assert not (tmp_path / "runs").exists()


# Sensitivity indices: an axis slides to x0 + m v0^2 / (2 F), so the shares of x0 and v0 are known.


def slid(design, runs, folder):
    """Return the indices of where an axis comes to rest."""
    axis, law = Axis(inertia=2.0), Coulomb(kinetic_coefficient=5.0)
    factors = {"initial.x": Uniform(low=0.0, high=0.5), "initial.v": Uniform(low=1.0, high=2.0)}
    case = Case(mechanism=axis, law=law, t_end=10.0)
    asked = Campaign(cases=(case,), factors=factors, design=design, runs=runs, outputs=["x"])
    return asked.run(folder).sensitivity("x")


def test_sobol_indices_are_the_shares_of_the_variance(tmp_path):
    found = slid("saltelli", 4096, tmp_path / "runs")
    of_x = 0.5**2 / 12.0
    of_v = (2.0 / 10.0) ** 2 * (31.0 / 5.0 - (7.0 / 3.0) ** 2)
    known = np.array([of_x, of_v]) / (of_x + of_v)
    for name in ("first", "total"):
        np.testing.assert_allclose(found.indices[name], known, atol=0.02)
        assert (np.abs(found.indices[name] - known) < 2.0 * found.half_widths[name]).all()
    assert found.used == 1024
    assert found.sentence == "Sobol indices of x from 1024 base points."


def test_runs_that_ended_early_have_no_share_in_indices_and_a_reason(tmp_path):
    axis, law = Axis(inertia=2.0), Coulomb(kinetic_coefficient=5.0)
    factors = {"initial.x": Uniform(low=0.0, high=0.5), "initial.v": Uniform(low=1.0, high=2.0)}
    case = Case(mechanism=axis, law=law, t_end=10.0)
    settings = {"design": "morris", "runs": 60, "outputs": ["x"]}
    found = Campaign(cases=(case,), factors=factors, **settings).run(tmp_path / "runs")
    part = tmp_path / "runs" / found.parts[0].file
    table = pd.read_parquet(part)
    table.loc[4, "status"] = "ZENO"  # what a run had where it stopped is still there
    table.to_parquet(part, index=False)
    indices = found.sensitivity("x")
    assert (indices.used, indices.left_out) == (19, 1)
    assert indices.sentence.endswith(
        "1 left out, with runs that have no value. At 1 of 60 runs the run stopped:"
        f" {Status.ZENO.value} They are left out."
    )


@pytest.mark.slow
def test_sobol_indices_of_a_published_function():
    """Ishigami and Homma 1990, with a = 7 and b = 0.1."""
    factors = {name: Uniform(low=-np.pi, high=np.pi) for name in "abc"}
    design = Design(factors=factors, kind="saltelli", runs=5 * 4096, seed=1)
    rows = design.rows(0, len(design))
    own = np.sin(rows["a"])
    values = own + 7 * np.sin(rows["b"]) ** 2 + 0.1 * rows["c"] ** 4 * own
    found = indices_of(design, "y", "1", values)
    np.testing.assert_allclose(found.indices["first"], [0.3139, 0.4424, 0.0], atol=0.01)
    np.testing.assert_allclose(found.indices["total"], [0.5576, 0.4424, 0.2437], atol=0.01)


def test_morris_indices_of_what_adds_up_are_its_changes(tmp_path):
    found = slid("morris", 300, tmp_path / "runs")
    assert found.indices["mu_star"][0] == pytest.approx(0.5, rel=1e-9)
    assert found.indices["sigma"][0] == pytest.approx(0.0, abs=1e-9)
    assert found.indices["mu_star"][1] == pytest.approx(0.6, rel=0.1)  # m (2^2 - 1^2) / (2 F)
    assert found.to_dataframe()["factor"].tolist() == ["initial.x", "initial.v"]
    assert found.plot().get_xlabel() == "x, m"


@pytest.mark.parametrize(
    ("changes", "output", "said"),
    [
        ({}, "travel", "need the design saltelli or morris, got random"),
        ({"design": "saltelli", "runs": 16}, "travel", "8 are needed"),
        ({"design": "saltelli", "runs": 64}, "distance", "unknown column .* 'distance'"),
        ({"design": "saltelli", "runs": 64, "cases": cases()}, "travel", "of one case"),
    ],
)
def test_indices_without_a_design_or_values_are_refused(changes, output, said, tmp_path):
    found = asked(**changes).run(tmp_path / "runs")
    with pytest.raises(InputError, match=said):
        found.sensitivity(output)


def test_the_manifest_lists_what_is_there(tmp_path):
    found = asked().run(tmp_path / "runs")
    told = json.loads((tmp_path / "runs/manifest.json").read_text())
    assert told["schema"] == "stickslip/campaign/1"
    assert told["runs"] == 50
    assert {entry["file"]: entry["sha256"] for entry in told["parts"]} == {
        name: digest for name, digest in files(found.folder).items() if name.startswith("runs/")
    }


@pytest.mark.parametrize("name", ["mu_s", "static_coefficient", "friction.static_coefficient"])
def test_what_was_not_given_varies_in_a_campaign_as_in_an_ensemble(tmp_path, name):
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    case = Case(mechanism=rig, law=Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    factors = {name: Levels(values=(0.3, 2.0))}
    runs = Campaign(cases=(case,), factors=factors).run(tmp_path, executor=Inline())
    assert runs.units["friction.static_coefficient"] == "1"
    table = runs.to_dataframe()
    assert table["friction.static_coefficient"].tolist() == [0.3, 2.0]
    assert table["x"].iloc[0] > 0.0 == table["x"].iloc[1]  # which friction at rest holds
