"""What a run gives back."""

import math

import numpy as np
import pytest

from stickslip import Axis, Coulomb, TowedBlock, simulate
from stickslip.engine import Status
from stickslip.errors import InputError, UnknownNameError
from stickslip.mechanisms.drives import Pulse

LAW = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)


@pytest.fixture(scope="module")
def run():
    return simulate(TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0), LAW, t_end=20.0)


def test_columns_have_the_length_of_the_times(run):
    for name in run.names:
        assert run[name].shape == run.t.shape


def test_times_increase_from_zero_to_the_end(run):
    assert np.all(np.diff(run.t) > 0)
    assert (run.t[0], run.t[-1]) == run.span == (0.0, 20.0)


def test_an_unknown_column_lists_the_nearest(run):
    with pytest.raises(UnknownNameError, match=r"'frction'\. Did you mean 'friction'"):
        run["frction"]


@pytest.mark.parametrize("t", [-1e-9, 20.0001, [1.0, 21.0], math.nan])
def test_times_outside_the_run_are_refused_with_its_span(run, t):
    with pytest.raises(InputError, match="between 0 and 20 s"):
        run.at(t)


@pytest.mark.parametrize(
    ("t", "message"),
    [("x", r"'x'; the column is run\['x'\]"), ("soon", "got 'soon'"), ([1j], "must be numbers")],
)
def test_times_that_are_no_numbers_are_refused(run, t, message):
    with pytest.raises(InputError, match=message):
        run.at(t)


def test_a_run_can_be_asked_at_any_times_in_any_order(run):
    there = run.at([7.0, 3.0, 7.0])
    np.testing.assert_array_equal(there.t, [7.0, 3.0, 7.0])
    assert there["x"][0] == there["x"][2] == run.at(7.0)["x"][0]
    assert there["x"][1] == run.at(3.0)["x"][0]


def test_no_times_give_no_values(run):
    assert run.at([])["x"].shape == (0,)


def test_at_the_ends_of_steps_the_dense_output_meets_the_steps(run):
    # both sides of a step end agree within the solver's tolerance of 1e-12
    before = run.at(np.nextafter(run.t[1:], 0.0))
    for name in ("x", "v"):
        size = np.abs(run[name]).max()
        np.testing.assert_allclose(before[name], run[name][1:], rtol=0, atol=1e-11 * size)


def test_sampling_is_even_and_keeps_the_ends(run):
    fine = run.sampled(11)
    np.testing.assert_allclose(fine.t, np.linspace(0, 20, 11), rtol=1e-15)
    assert fine.span == run.span
    assert fine.events == run.events
    assert fine.certificate == run.certificate


def test_events_alternate_between_break_away_and_stop(run):
    reasons = [event.reason for event in run.events]
    assert reasons == ["break-away", "stop"] * (len(reasons) // 2) + ["break-away"] * (
        len(reasons) % 2
    )
    for event in run.events:
        assert (event.from_mode, event.to_mode) == ((0, 1) if "away" in event.reason else (1, 0))
        assert event.contact == ""


def test_stick_spans_are_the_times_in_which_nothing_moves(run):
    spans = run.stick_spans()
    assert spans[0] == (0.0, run.events[0].t)
    assert spans[1] == (run.events[1].t, run.events[2].t)
    for start, end in spans:
        inside = run.at(np.linspace(start, np.nextafter(end, 0.0), 20))
        assert np.all(inside["v"] == 0)
        assert np.all(inside["x"] == inside["x"][0])


def test_a_run_that_never_leaves_rest_is_one_stick_span():
    still = simulate(Axis(inertia=1.0), LAW, t_end=3.0)
    assert still.stick_spans() == [(0.0, 3.0)]
    assert still.status is Status.AT_REST


def test_the_margin_of_a_stop_is_what_break_away_has_left(run):
    stops = [event for event in run.events if event.reason == "stop"]
    for stop in stops:
        needed = abs(run.at(stop.t)["friction"][0])
        assert math.isclose(stop.margin, 1.5 - needed, rel_tol=1e-12)  # a rounding


def test_after_rest_the_friction_still_follows_the_drive():
    axis = Axis(inertia=1.0, drive=Pulse(level=0.5, duration=1.0, start=2.0))
    still = simulate(axis, LAW, t_end=4.0)
    assert still.status is Status.AT_REST
    np.testing.assert_array_equal(still.at([1.0, 2.5, 3.5])["friction"], [0.0, 0.5, 0.0])


def test_a_dataframe_has_the_time_and_every_column(run):
    frame = run.to_dataframe()
    assert list(frame.columns) == ["t", *run.names]
    np.testing.assert_array_equal(frame["x"], run["x"])


def test_a_dataset_has_units_and_the_status(run):
    dataset = run.to_xarray()
    assert dataset["v"].attrs["units"] == "m/s"
    assert dataset["t"].attrs["units"] == "s"
    assert dataset.attrs["status"] == run.status.value
    np.testing.assert_array_equal(dataset["x"].values, run["x"])


def test_the_html_form_says_how_the_run_ended_and_whether_to_trust_it(run):
    html = run._repr_html_()
    assert html.startswith(f"<p>{run.status.value}</p><table>")
    assert "<th>certified</th><td>yes</td>" in html


def test_a_status_speaks_in_sentences():
    assert all(status.value.endswith(".") for status in Status)
    assert {status for status in Status if status.complete} == {Status.END_TIME, Status.AT_REST}
