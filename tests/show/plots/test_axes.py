"""Plots on axes: those of the user, or new ones; settings of matplotlib stay as they are."""

import inspect
import itertools
import sys
import threading
import warnings
from dataclasses import dataclass, replace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    Measurement,
    Pendulum,
    SpringBlock,
    Stribeck,
    TowedBlock,
    ensemble,
    fit,
    select,
    simulate,
)
from stickslip.data import LawEstimates
from stickslip.engine.solver import Max, Samples
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError, UnknownNameError
from stickslip.identify import kinds
from stickslip.identify.candidates import Candidate, Verdict, Wording
from stickslip.identify.fits import Fit
from stickslip.mechanisms.drives import Sine
from stickslip.show import plots
from stickslip.show.display import MOST_ROWS, InPanels, Summary, html_of
from stickslip.study import presliding_loop
from stickslip.study.sweep import band_of, basins
from stickslip.study.sweep.mean_velocity import VelocityMap

plt.switch_backend("Agg")

BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)
DAHL = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1000.0)
V = np.linspace(-1.0, 1.0, 400)
TABLE = Measurement(velocity=V, friction=2.0 * np.sign(V) + 0.5 * V + 0.1 * np.cos(50.0 * V))
TIME = np.linspace(0.0, 12.0, 240, endpoint=False)
SPEED = np.sin(2.0 * TIME + 0.3)
RUBBED = Measurement(
    time=TIME,
    position=-0.5 * np.cos(2.0 * TIME + 0.3),
    velocity=SPEED,
    friction=2.0 * np.sign(SPEED)
    + 0.5 * SPEED
    + 0.1 * np.random.default_rng(0).normal(size=TIME.size),
)


def velocity_map() -> VelocityMap:
    return VelocityMap(
        axes={"drive.frequency": np.array([1.0, 2.0, 3.0]), "mass": np.array([0.1, 0.2])},
        units={"drive.frequency": "Hz", "mass": "kg"},
        unit="m/s",
        velocity=np.array([[0.1, -0.1], [0.2, np.nan], [0.3, 0.1]]),
        unsettled=np.zeros((3, 2)),
        closes=np.ones((3, 2), dtype=int),
        spread=np.full((3, 2), np.nan),
        chaotic=np.zeros((3, 2), dtype=bool),
        period=np.ones((3, 2)),
        status=np.array(
            [[Status.END_TIME] * 2, [Status.END_TIME, Status.ZENO], [Status.AT_REST] * 2]
        ),
        certified=np.ones((3, 2), dtype=bool),
    )


@pytest.fixture(scope="module")
def results():
    """One result of each kind, by its type."""
    table = TABLE
    driven = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=1.0))
    rough = Coulomb(kinetic_coefficient=0.5)
    known = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.24, 0.26)})
    levels = {"kinetic_coefficient": np.array([0.2, 0.25, 0.3])}
    outputs = {"fastest": Max("v"), "way": Samples("x", [0.1, 0.2])}
    return {
        "run": simulate(BLOCK, LAW, t_end=1.0),
        "ensemble": ensemble(BLOCK, LAW, levels, t_end=1.0, outputs=outputs),
        "band": band_of(BLOCK, LAW, known, t_end=1.0, count=20),
        "record fit": fit(Axis(inertia=1.0), CoulombViscous, table),
        "travel fit": fit(BLOCK, Coulomb, Measurement(travel=0.20, uncertainty=0.005)),
        "record verdict": select(Axis(inertia=1.0), ["coulomb", "coulomb-viscous"], RUBBED),
        "table verdict": select(Axis(inertia=1.0), ["coulomb", "coulomb-viscous"], TABLE),
        "travel verdict": select(
            BLOCK, ["coulomb", "viscous"], Measurement(travel=0.20, uncertainty=0.005)
        ),
        "map": velocity_map(),
        "basins": basins(driven, rough, {"x": [-1.0, 0.0, 1.0], "v": [-1.0, 1.0]}, settle=30),
        "loop": presliding_loop(DAHL, 0.001, load=10.0),
    }


KINDS = (
    "run", "ensemble", "band", "record fit", "travel fit", "record verdict",
    "table verdict", "travel verdict", "map", "basins", "loop",
)  # fmt: skip


def settings() -> dict[str, object]:
    return {name: mpl.rcParams[name] for name in mpl.rcParams}


@pytest.mark.parametrize("kind", KINDS)
def test_a_result_plots_itself_into_a_new_figure_and_is_not_shown(kind, results, monkeypatch):
    monkeypatch.setattr(plt, "show", lambda *a, **k: pytest.fail("plt.show was called"))
    before = settings()
    drawn = results[kind].plot()
    assert settings() == before
    assert plt.get_fignums() == [1]
    panels = np.atleast_1d(drawn)
    assert all(isinstance(panel, Axes) for panel in panels)
    assert all(panel.figure is plt.figure(1) for panel in panels)
    assert isinstance(drawn, np.ndarray) == isinstance(results[kind], InPanels)
    assert all(panel.has_data() for panel in panels)


@pytest.mark.parametrize("kind", KINDS)
def test_a_result_draws_on_the_axes_it_is_given_and_makes_no_figure(kind, results):
    count = len(results[kind].plot(Figure())) if isinstance(results[kind], InPanels) else 1
    figure, given = plt.subplots(count, squeeze=False, figsize=(8, 8))
    axes = given[:, 0]
    before = settings()
    drawn = results[kind].plot(axes if count > 1 else axes[0])
    assert settings() == before
    assert list(np.atleast_1d(drawn)) == list(axes)
    assert all(ax.has_data() for ax in axes)
    assert plt.get_fignums() == [figure.number]
    figure.canvas.draw()


@pytest.mark.parametrize("kind", KINDS)
def test_a_notebook_shows_status_or_verdict_a_table_and_a_figure(kind, results):
    before = settings()
    page = results[kind]._repr_html_()
    assert settings() == before
    assert plt.get_fignums() == []
    assert page.startswith("<p>")
    assert "<table>" in page
    assert page.count("<svg") == 1
    assert "$" not in page.partition("<svg")[0]
    sentences = {
        "run": Status.AT_REST.value,
        "record verdict": results["record verdict"].sentence.split(" ")[0],
        "ensemble": "3 of 3 runs were completed.",
    }
    assert sentences.get(kind, "") in page


@pytest.mark.parametrize("kind", KINDS)
def test_a_result_that_cannot_be_drawn_still_has_its_table(kind, results, monkeypatch):
    def fail(*_):
        raise RuntimeError("no drawing")

    monkeypatch.setattr("stickslip.show.plots.dispatch.plot", fail)
    page = results[kind]._repr_html_()
    assert "<table>" in page
    assert "<svg" not in page


def test_a_notebook_shows_the_text_of_a_result_whose_summary_fails(results):
    class Broken:
        def __repr__(self) -> str:
            raise ValueError

    def fail():
        raise RuntimeError

    run = results["run"]
    assert html_of(fail, run).startswith("<pre>&lt;Trajectory: Came")
    assert "Broken object" in html_of(fail, Broken())
    bad = replace(run, certificate=None)
    assert bad._repr_html_().startswith("<pre>&lt;Trajectory: &lt;stickslip")


def test_a_figure_in_a_notebook_warns_of_nothing(results):
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        results["ensemble"]._repr_html_()
    assert seen == []


def test_long_tables_of_a_notebook_are_cut_and_texts_are_escaped():
    rows = [(f"<b>{i}", float("nan")) for i in range(MOST_ROWS + 3)]
    page = html_of(lambda: Summary(sentence="a < b", head=("x", "y"), rows=rows), "nothing")
    assert page.startswith("<p>a &lt; b</p><table><tr><th>x</th>")
    assert "<td>&lt;b&gt;" in page or "<td>&lt;b" in page
    assert page.count("<tr>") == MOST_ROWS + 1
    assert "<p>3 more rows.</p>" in page
    assert "nan" not in page


def test_a_plot_of_something_else_names_what_can_be_plotted():
    with pytest.raises(
        InputError, match="no plot for a str; there is one for Trajectory, Ensemble"
    ):
        plots.plot("run")
    figures = plt.get_fignums()
    wrong = {
        plots.plot_run: "run must be a Trajectory",
        plots.plot_fit: "fit must be a Fit, got",
        plots.plot_verdict: "verdict must be a Verdict, got",
        plots.plot_ensemble: "runs must be an Ensemble",
        plots.plot_sweep: "result must be a VelocityMap, Basins, SensitivityIndices",
        plots.plot_law: "law must be a FrictionLaw",
        plots.plot_presliding: "loop must be a PreslidingLoop or FrictionLaw",
        plots.plot_limit_cycle: "run must be a Trajectory or ClosedLoop",
        plots.plot_band: "band must be a Band",
        plots.plot_measurement: "measurement must be a Measurement",
        plots.plot_optimum: "optimum must be an Optimum",
        plots.plot_velocity_band: "result must be a VelocityBand",
        plots.plot_closed_loop: "loop must be a ClosedLoop",
        plots.plot_joints: "fit must be a JointLawFit or JointVerdict, got",
        plots.plot_friction_velocity: "run must be a Trajectory",
    }
    for function, message in wrong.items():
        with pytest.raises(InputError, match=message):
            function("nonsense")
    assert plt.get_fignums() == figures
    listed = {getattr(plots, name) for name in plots.__all__ if name.startswith("plot_")}
    assert listed - set(wrong) == {plots.plot_runs}


def test_every_plot_takes_what_it_draws_and_then_the_axes():
    for room in (plots, kinds):
        for name in room.__all__:
            if name.startswith("plot"):
                _, ax, *options = inspect.signature(getattr(room, name)).parameters.values()
                assert (ax.name, ax.default) == ("ax", None)
                assert all(option.kind is option.KEYWORD_ONLY for option in options)


def test_axes_of_the_wrong_kind_or_number_are_refused_before_anything_is_drawn(results):
    run = results["run"]
    figure, (subplot, other) = plt.subplots(2)
    with pytest.raises(
        InputError, match="has 3 panels: ax must be a sequence of 3 Axes or a Figure, got 1"
    ):
        plots.plot_run(run, subplot)
    with pytest.raises(InputError, match=r"has 3 panels.* got 2 Axes"):
        plots.plot_run(run, [subplot, other])
    for wrong in ("axes", 3, [], [subplot, "other"]):
        with pytest.raises(InputError, match="ax must be matplotlib Axes"):
            plots.plot_run(run, wrong)
    assert not subplot.has_data()
    assert not other.has_data()
    with pytest.raises(
        InputError, match="has 1 panel: ax must be one Axes or a Figure, got 2 Axes"
    ):
        plots.plot_friction_velocity(run, [subplot, other])
    other.remove()
    with pytest.raises(InputError, match="was removed from its figure"):
        plots.plot_friction_velocity(run, other)
    assert plt.get_fignums() == [figure.number]


def test_a_drawing_that_fails_leaves_no_figure_and_no_settings_behind(results):
    before = settings()
    with pytest.raises(UnknownNameError, match="Did you mean 'x'"):
        plots.plot_run(results["run"], slip="xx")
    draw = plots.draw_run(results["run"], rate="v", slip="x")

    def fail(figure, narrow):
        draw(figure, narrow)
        raise KeyboardInterrupt

    from stickslip.show.plots.axes import on_panels

    with pytest.raises(KeyboardInterrupt):
        on_panels(fail, None, (880, 300))
    assert plt.get_fignums() == []
    assert settings() == before


def test_a_plot_fills_a_subfigure_and_leaves_its_neighbour_alone(results):
    figure = plt.figure(layout="constrained")
    left, right = figure.subfigures(1, 2)
    panels = results["run"].plot(left)
    assert [axes.get_figure() for axes in panels] == [left] * 3
    assert right.axes == []
    figure.canvas.draw()


def test_what_the_reader_set_of_letters_size_colours_and_lines_holds(results):
    cycle = mpl.cycler(color=["#d62728", "#2ca02c"])
    own = {"figure.dpi": 137.0, "font.size": 23.0, "figure.figsize": (7.0, 5.0)}
    with mpl.rc_context(own | {"axes.prop_cycle": cycle, "lines.linewidth": 3.6}):
        axes = results["loop"].plot()
        assert axes.figure.dpi == 137.0
        assert tuple(axes.figure.get_size_inches()) == (7.0, 5.0)
        assert axes.xaxis.label.get_size() == 23.0
        assert {tick.label1.get_size() for tick in axes.xaxis.get_major_ticks()} == {22.0}
        first, *_ = axes.lines
        assert first.get_color() == pytest.approx(mpl.colors.to_rgba("#d62728"))
        assert mpl.rcParams["font.size"] == 23.0
    plain = results["loop"].plot()
    assert tuple(plain.figure.get_size_inches()) == (10.0, pytest.approx(4.5, abs=1.0))
    assert plain.xaxis.label.get_size() == 11.5
    assert plain.lines[0].get_color() == plots.C1
    assert first.get_linewidth() == 2.0 * plain.lines[0].get_linewidth()


@pytest.mark.parametrize("kind", ["run", "map", "basins"])
def test_a_style_sheet_for_dark_paper_leaves_no_dark_letters_on_it(kind, results):
    with plt.style.context("dark_background"):
        panels = np.atleast_1d(results[kind].plot())
        assert panels[0].figure.get_facecolor() == (0.0, 0.0, 0.0, 1.0)
        texts = [text for axes in panels for text in axes.findobj(mpl.text.Text)]
        shown = [text for text in texts if text.get_text()]
        assert min(sum(mpl.colors.to_rgb(text.get_color())) for text in shown) > 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_in_a_column_of_a_journal_letters_are_small_and_labels_keep_apart(kind, results):
    with mpl.rc_context({"figure.figsize": (3.5, 2.6)}):
        panels = np.atleast_1d(results[kind].plot())
    figure = panels[0].figure
    figure.canvas.draw()
    assert tuple(figure.get_size_inches()) == (3.5, 2.6)
    sizes = {t.get_size() for t in figure.findobj(mpl.text.Text) if t.get_text()}
    assert 6.0 <= min(sizes) <= max(sizes) < 9.0
    boxes = [axes.yaxis.label.get_window_extent() for axes in panels]
    column = [box for box in boxes if abs(box.x0 - boxes[0].x0) < 20.0]
    assert not any(a.overlaps(b) for a, b in itertools.combinations(column, 2))


def test_two_laws_share_axes():
    ax = plots.plot_law(LAW, Figure().add_subplot(), load=4.0)
    again = plots.plot_law(DAHL, ax, load=8.0)
    assert again is ax
    tops = [float(np.nanmax(line.get_ydata())) for line in ax.lines if len(line.get_ydata()) > 2]
    assert tops == pytest.approx([1.0, 2.0], rel=1e-12)  # mu N, no more than a rounding off


def test_a_plot_shows_what_the_run_has():
    run = simulate(BLOCK, LAW, t_end=1.0)
    first, *_ = plots.plot_run(run, Figure())
    end = float(first.lines[0].get_ydata()[-1])
    assert end == pytest.approx(run["x"][-1], rel=1e-12)  # the same number
    assert len(plots.plot_run(run, Figure(), normal_force=True)) == 4


def test_a_run_without_x_and_v_is_plotted_by_its_own_names():
    clock = Pendulum(mass=0.2, length=0.5)
    run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=1.0, y0={"theta": 0.5})
    labels = [axes.get_ylabel() for axes in plots.plot_run(run, Figure())]
    assert labels[:2] == ["displacement, rad", "velocity, rad/s"]
    ax = plots.plot_runs({"clock": run}, Figure(), column="friction")
    assert ax.get_ylabel() == "friction, mN m"
    with pytest.raises(InputError, match="at least one run"):
        plots.plot_runs({})


def test_a_run_without_a_limit_cycle_says_so():
    run = simulate(BLOCK, LAW, t_end=1.0)
    with pytest.raises(InputError, match="v has no limit cycle: the second half of the run has"):
        plots.plot_limit_cycle(run)
    pulled = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    cycle = simulate(pulled, Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5), t_end=80.0)
    _, near = plots.plot_limit_cycle(cycle, Figure())
    assert np.diff(near.get_xlim())[0] == pytest.approx(7.6113, abs=1e-4)  # the printed digits


def test_runs_that_ended_early_are_told_apart_from_the_others(results):
    runs = results["ensemble"]
    status = np.array([Status.END_TIME, Status.STEP_LIMIT, Status.AT_REST])
    early = replace(runs, status=status)
    ax = plots.plot_ensemble(early, Figure())
    assert [len(line.get_xdata()) for line in ax.lines] == [2, 1]
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [
        "reached the end",
        "ended early:\nReached the maximum number of\nsteps before the end time",
    ]
    way = plots.plot_ensemble(runs, Figure(), output="way")
    assert len(way.lines[0].get_xdata()) == 2 * len(runs)
    assert (way.get_xlabel(), way.get_ylabel()) == ("kinetic coefficient", "way, m")
    with pytest.raises(UnknownNameError, match="fastest"):
        plots.plot_ensemble(runs, output="fastet")
    with pytest.raises(UnknownNameError):
        plots.plot_ensemble(runs, parameter="mass")


def test_a_verdict_of_a_record_is_plotted_as_its_band_with_the_law(results):
    verdict = results["record verdict"]
    ax = verdict.plot(Figure())
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("velocity, m/s", "friction, N")
    shades = [
        collection.get_paths()[0].vertices
        for collection in ax.collections
        if len(collection.get_paths()) == 1
    ]
    widest = max(shades, key=len)
    assert widest[:, 1].min() < verdict.friction.median.min()


def test_estimates_are_a_table_with_a_row_each(results):
    found = results["record fit"]
    frame = found.to_dataframe()
    assert list(frame["parameter"]) == [estimate.path for estimate in found.estimates]
    assert list(frame["value"]) == [estimate.value for estimate in found.estimates]
    assert (frame["low"] <= frame["value"]).all()
    single = results["travel fit"].to_dataframe()
    assert single["symbol"].tolist() == ["mu_k"]


def test_grids_and_ensembles_are_datasets_with_units(results):
    data = results["map"].to_xarray()
    assert data["velocity"].dims == ("drive.frequency", "mass")
    assert data["velocity"].attrs["units"] == "m/s"
    assert data["mass"].attrs["units"] == "kg"
    assert float(data["velocity"].sel({"drive.frequency": 2.0, "mass": 0.1})) == 0.2
    runs = results["ensemble"].to_xarray()
    assert runs["way"].dims == ("run", "way_index")
    assert runs["friction.kinetic_coefficient"].dims == ("run",)
    assert runs["status"].values.tolist() == ["AT_REST"] * 3
    found = results["basins"]
    assert found.to_xarray()["attractor"].shape == found.index.shape
    frame = found.to_dataframe()
    assert len(frame) == found.index.size
    row = frame.iloc[-1]
    assert (row["x"], row["v"]) == (1.0, 1.0)
    assert row["attractor"] == found.index[-1, -1]


@pytest.mark.parametrize("kind", ["run", "ensemble", "map", "basins"])
def test_a_dataset_without_xarray_says_what_to_install(kind, results, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(InputError, match=r"pip install 'stickslip\[xarray\]', or use to_dataframe"):
        results[kind].to_xarray()


def test_threads_that_show_results_do_not_mix_their_settings(results):
    before = settings()
    pages: list[str] = []
    show = results["loop"]._repr_html_
    threads = [threading.Thread(target=lambda: pages.append(show())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(set(pages)) == 1
    assert "<svg" in pages[0]
    assert settings() == before


def test_a_law_named_in_the_table_of_plots_is_found_by_its_base():
    law = Stribeck(kinetic_coefficient=0.25, static_coefficient=0.35, stribeck_velocity=0.05)
    assert plots.plot(law, Figure()).get_title("left") == law.title


def test_a_fit_or_verdict_without_a_plot_is_refused_by_name():
    @dataclass(frozen=True, kw_only=True, repr=False)
    class BareFit(Fit):
        law_estimates = sentences = to_dict = None

    @dataclass(frozen=True, kw_only=True)
    class BareCandidate(Candidate):
        to_row = to_dict = None

    @dataclass(frozen=True, kw_only=True, repr=False)
    class BareVerdict(Verdict):
        route, score_unit = "bare", "N"
        _details = _basis = None

    bare = BareFit(law=None, mechanism=None, estimates=())
    for plot in (plots.plot, plots.plot_fit, lambda fit: fit.plot()):
        with pytest.raises(InputError, match="there is no plot for a BareFit: its class has no"):
            plot(bare)
    words = Wording(
        verdict="", lede="", settles=(), cannot_tell=(), measure_next=(), no_score="One only."
    )
    candidate = BareCandidate(name="bare", title="Bare", fit=None)
    verdict = BareVerdict(
        mechanism=None,
        measurement=None,
        words=words,
        candidates=(candidate,),
        best=None,
        ranked=False,
        checks=None,
    )
    with pytest.raises(InputError, match=r"no law has a held-out error to plot\. One only\."):
        plots.plot_verdict(verdict)


def test_what_a_backend_sets_as_it_is_loaded_outlasts_the_first_plot(tmp_path, monkeypatch):
    """The backend of notebooks makes matplotlib interactive, or no later figure would be shown."""
    lines = ["from matplotlib.backends.backend_agg import *", "import matplotlib"]
    (tmp_path / "showing.py").write_text("\n".join([*lines, "matplotlib.interactive(True)"]))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(plt, "_backend_mod", None)
    with mpl.rc_context():
        mpl.rcParams["backend"] = "module://showing"
        assert not mpl.is_interactive()
        plt.close(plots.plot_law(LAW).figure)
        assert mpl.is_interactive()
    mpl.use("agg")


def test_a_law_without_memory_has_no_presliding_to_plot():
    with pytest.raises(InputError, match="Coulomb friction has no presliding"):
        plots.plot_presliding(Coulomb(kinetic_coefficient=0.2))
