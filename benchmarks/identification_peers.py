"""``python -m benchmarks.identification_peers``: EMPS fitted by ours, lmfit and mujoco.sysid.

Mass, Coulomb and viscous friction and a constant force, from the same start values: segments of
1 s each from its own state where a peer can do that, the same rows. First compiles and imports are
apart. lmfit integrates a smoothed sign with scipy; mujoco.sysid rolls out a slide joint. Neither
comes with an extra: ``pip install lmfit 'mujoco[sysid]'``; one that is missing is left out.
"""

import argparse
import contextlib
import importlib
import io
import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip import Axis, CoulombViscous
from stickslip.catalogue import dataset
from stickslip.errors import InputError
from stickslip.identification.records.fitting import fit_record
from stickslip.identification.series.start_values import Scales, scales_of
from stickslip.identification.settings import RecordSettings
from stickslip.identification.shooting.multiple_shooting import Segment
from stickslip.identification.shooting.segments import segments_of

NAMES = ("mass", "level", "viscous", "offset")
UNITS = ("kg", "N", "N s/m", "N")
AXIS = Axis(inertia=95.0)
SMOOTHING = 1e-3
"""Speed [m/s] over which lmfit's sign is smoothed: a hundredth of the fastest."""
REPEATS = 7
TARGET = 0.3
"""Time of one fit [s]."""
STEP = 1e-3
"""Step of mujoco [s]: that of the record."""

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Peer:
    """What one tool found."""

    name: str
    first: float
    """Time of the first fit [s]."""
    median: float
    """Time of a later one [s]."""
    processor: float
    """The same on the processor's clock [s], which other work on the machine does not lengthen."""
    rms: float
    """Root mean square of its residuals [m]."""
    estimates: Mapping[str, tuple[float, float]]
    """Value and half width of its 95 % interval, by name."""
    note: str


def timed(run: Callable[[], Any], repeats: int) -> tuple[float, float, float, Any]:
    """Return the first time, the medians of later ones on both clocks, and the last answer."""
    times, processor = [], []
    for _ in range(1 + repeats):
        began, busy = time.perf_counter(), time.process_time()
        found = run()
        times.append(time.perf_counter() - began)
        processor.append(time.process_time() - busy)
    later = 1 if repeats else 0
    wall, busy = (statistics.median(one[later:]) for one in (times, processor))
    return times[0], wall, busy, found


def ours(starts: int) -> Peer:
    record, settings = dataset("emps").measurement(), RecordSettings(starts=starts)
    first, median, processor, found = timed(
        lambda: fit_record(AXIS, CoulombViscous, record, unknown=("inertia",), settings=settings),
        REPEATS,
    )
    half = found.inference.half_widths
    order = [found.free_parameters.paths.index(found.estimate(name).path) for name in
             ("inertia", "kinetic_coefficient", "viscous_coefficient", "offset")]  # fmt: skip
    return Peer(
        name=f"stickslip, {starts} start{'s' if starts > 1 else ''}",
        first=first,
        median=median,
        processor=processor,
        rms=found.rms,
        estimates={n: (found.values[i], half[i]) for n, i in zip(NAMES, order, strict=True)},
        note="intervals from leaving blocks out",
    )


def begun() -> tuple[Scales, tuple[Segment, ...]]:
    """Return start values and segments, the same for all."""
    record = dataset("emps").measurement()
    return scales_of(AXIS, record, ("inertia",)), segments_of(AXIS, record, length=1.0)


def by_lmfit() -> Peer:
    """Segments as here, their states eliminated by linear regression on two of their slopes."""
    import lmfit
    from scipy.integrate import solve_ivp

    scales, segments = begun()

    def run(segment: Segment, state: Array, p: Mapping[str, float]) -> Array:
        drive = segment.mechanism.drive  # type: ignore[attr-defined]
        times, forces = np.array(drive.times), np.array(drive.values)

        def slope(t: float, y: Array) -> list[float]:
            force = forces[max(np.searchsorted(times, t, side="right") - 1, 0)]
            friction = p["level"] * np.tanh(y[1] / SMOOTHING) + p["viscous"] * y[1]
            return [y[1], (force - friction - p["offset"]) / p["mass"]]

        end = segment.times[-1]
        found = solve_ivp(
            slope, (0.0, end), state, "LSODA", t_eval=segment.times, rtol=1e-6, atol=1e-8,
            max_step=0.01,
        )  # fmt: skip
        return np.asarray(found.y[0])

    def residual(params: Any) -> Array:
        p = params.valuesdict()
        found = []
        for k, segment in enumerate(segments):
            state = np.array([p[f"x_{k}"], p[f"v_{k}"]])
            found.append(segment.measured - run(segment, state, p))
        return np.concatenate(found)

    def jacobian(params: Any) -> Array:
        """Differences; a segment's own state is seen by its own rows only."""
        here, columns = residual(params), []
        edges = np.cumsum([0, *(len(s.times) for s in segments)])
        for name in params:
            h = 1e-6 * max(abs(params[name].value), 1e-2)
            p = params.valuesdict() | {name: params[name].value + h}
            column = np.zeros_like(here)
            own = int(name[2:]) if name[:2] in ("x_", "v_") else None
            for k, segment in enumerate(segments):
                if own in (None, k):
                    rows = slice(edges[k], edges[k + 1])
                    there = run(segment, np.array([p[f"x_{k}"], p[f"v_{k}"]]), p)
                    column[rows] = (segment.measured - there - here[rows]) / h
            columns.append(column)
        return np.column_stack(columns)

    def fitted() -> Any:
        params = lmfit.Parameters()
        start = (scales.inertia, scales.level, scales.slope, scales.offset)
        for name, value in zip(NAMES, start, strict=True):
            params.add(name, value=value)
        for k, segment in enumerate(segments):
            params.add(f"x_{k}", value=segment.guess[0])
            params.add(f"v_{k}", value=segment.guess[1])
        return lmfit.minimize(residual, params, method="leastsq", Dfun=jacobian, ftol=1e-4)

    first, median, processor, found = timed(fitted, 0)
    return Peer(
        name="lmfit with scipy's LSODA",
        first=first,
        median=median,
        processor=processor,
        rms=float(np.sqrt(np.mean(found.residual**2))),
        estimates={
            n: (found.params[n].value, 1.96 * (found.params[n].stderr or np.inf)) for n in NAMES
        },
        note=f"sign smoothed over {1e3 * SMOOTHING:g} mm/s; intervals of white noise",
    )


MODEL = f"""
<mujoco>
  <option timestep="{STEP}" gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody>
    <body name="car">
      <inertial pos="0 0 0" mass="{{mass}}" diaginertia="1 1 1"/>
      <joint name="slide" type="slide" axis="1 0 0" damping="{{viscous}}"
             frictionloss="{{level}}"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="push" joint="slide"/>
    <motor name="bias" joint="slide" gear="{{gear}}"/>
  </actuator>
  <sensor><jointpos name="position" joint="slide"/></sensor>
</mujoco>
"""


def by_mujoco() -> Peer:
    """Segments as here, from states guessed and not fitted, which it has no unknowns for."""
    import mujoco

    sysid = importlib.import_module("mujoco.sysid")
    if not hasattr(sysid, "optimize"):
        raise InputError(
            "mujoco.sysid is there without what it imports: install mujoco[sysid] to compare it."
        )
    scales, segments = begun()
    record = dataset("emps").measurement()
    values = (scales.inertia, scales.level, scales.slope, scales.offset)
    start = dict(zip(NAMES, values, strict=True))
    # the second motor pushes with 1: its gear is the constant force
    spec = mujoco.MjSpec.from_string(MODEL.format(gear=-start["offset"], **start))
    model = spec.compile()
    setters: dict[str, Callable[[Any, float], None]] = {
        "mass": lambda s, v: setattr(s.body("car"), "mass", v),
        "level": lambda s, v: setattr(
            s.joint("slide"), "frictionloss", _like(s, "frictionloss", v)
        ),
        "viscous": lambda s, v: setattr(s.joint("slide"), "damping", _like(s, "damping", v)),
        "offset": lambda s, v: setattr(s.actuator("bias"), "gear", [-v, 0, 0, 0, 0, 0]),
    }
    low_high = {"mass": (10.0, 500.0), "level": (0.0, 200.0), "viscous": (0.0, 2000.0)}

    def fitted() -> Any:
        params = sysid.ParameterDict()
        for name, value in start.items():
            low, high = low_high.get(name, (-50.0, 50.0))
            params.add(
                sysid.Parameter(
                    name, nominal=value, min_value=low, max_value=high,
                    modifier=lambda s, p, put=setters[name]: put(s, float(p.value[0])),
                )
            )  # fmt: skip
        chunks = [_chunk(sysid, model, record, segment) for segment in segments]
        states, controls, sensed = zip(*chunks, strict=True)
        names = [f"segment {k}" for k in range(len(segments))]
        sequences = sysid.ModelSequences("emps", spec, names, states, controls, sensed)
        residual = sysid.build_residual_fn(models_sequences=[sequences])
        with contextlib.redirect_stdout(io.StringIO()):  # each round of its optimiser prints a line
            best, ended = sysid.optimize(
                initial_params=params, residual_fn=residual, optimizer="mujoco", verbose=False
            )
        return best, ended, residual

    first, median, processor, (best, ended, residual) = timed(fitted, 0)
    rows = residual(ended.x, best)
    half = sysid.calculate_intervals(rows[0], ended.jac)[1]
    off = np.concatenate([
        np.ravel(seen.data) - np.ravel(known.data)
        for seen, known in zip(np.ravel(rows[1]), np.ravel(rows[2]), strict=True)
    ])  # fmt: skip
    return Peer(
        name="mujoco.sysid",
        first=first,
        median=median,
        processor=processor,
        rms=float(np.sqrt(np.mean(off**2))),
        estimates={n: (float(best[n].value[0]), float(half[i])) for i, n in enumerate(start)},
        note="states of segments guessed, not fitted; intervals of white noise",
    )


def _like(spec: Any, name: str, value: float) -> Any:
    """Return a value in the shape of a joint's field, which differs between versions."""
    old = np.asarray(getattr(spec.joint("slide"), name), dtype=float)
    if old.ndim == 0:
        return value
    new = np.zeros_like(old)
    new[0] = value
    return new


def _chunk(sysid: Any, model: Any, record: Any, segment: Segment) -> tuple[Any, Any, Any]:
    """Return first state, control and measured positions of a segment on mujoco's steps."""
    t = np.arange(0.0, segment.times[-1], STEP)
    seen = record.time - segment.start
    force, x = (np.interp(t, seen, np.asarray(record.values(n))) for n in ("force", "position"))
    state = sysid.create_initial_state(model, segment.guess[:1], segment.guess[1:], np.empty(0))
    control = sysid.TimeSeries(t, np.column_stack([force, np.ones_like(t)]))
    return state, control, sysid.TimeSeries.from_names(t[1:], x[1:, None], model)


def line(peer: Peer, own: float) -> str:
    values = ", ".join(
        f"{name} {value:.4g} +- {half:.2g} {unit}"
        for (name, (value, half)), unit in zip(peer.estimates.items(), UNITS, strict=True)
    )
    return (
        f"{peer.name}: first {peer.first:.3g} s, then {peer.median:.3g} s"
        f" ({peer.processor:.3g} s of processor)"
        f" ({peer.median / own:.3g} times ours), residual {1e3 * peer.rms:.3g} mm\n"
        f"    {values}\n    {peer.note}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.identification_peers")
    parser.add_argument("--only", choices=("stickslip", "lmfit", "mujoco"))
    only = parser.parse_args().only
    own = ours(1)
    print(line(own, own.median), flush=True)
    print(f"    target under {TARGET:g} s: {'met' if own.median < TARGET else 'not met'}")
    if only in (None, "stickslip"):
        print(line(ours(RecordSettings().starts), own.median), flush=True)
    for name, peer in (("lmfit", by_lmfit), ("mujoco", by_mujoco)):
        if only not in (None, name):
            continue
        try:
            print(line(peer(), own.median), flush=True)
        except (ImportError, InputError) as error:
            print(f"{name}: left out: {error}")


if __name__ == "__main__":
    main()
