"""Peers: other libraries that are given the same part of a record.

Each finds values of the unknowns that a fit of stickslip has for the same form of friction, so that
one metric judges all. Peers of regression are given what a user prepares: motion and force through
one Butterworth filter forward and backward, differences, rows that slip; the rigid-body terms are
those of the mechanism.
"""

import contextlib
import functools
import importlib
import io
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from benchmarks.friction.definition import Task
from stickslip.data import Measurement, between_gaps
from stickslip.engine.formulation import JointTorques
from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import Laws
from stickslip.identify.fits import WIDE, Fit, FreeParameter, FreeParameters, load_of, starting_law
from stickslip.identify.fits.shooting.segments import segments_of
from stickslip.mechanisms import Axis, Mechanism, Pendulum
from stickslip.quantities import parameters, vary
from stickslip.show.described import Described
from stickslip.show.display import require_library

Array = NDArray[np.float64]

ORDER: Final = 4
"""Of the Butterworth filter of motion and force."""
SLIP_SHARE: Final = 0.02
"""Share of the largest speed below which a row does not slip for sure, and is left out."""
ENDS: Final = 2.0
"""Periods of the filter at the ends of a record, which are left out."""
SPARSE: Final = 0.01
"""Threshold of STLSQ, for terms and accelerations of unit standard deviation."""
NORMAL: Final = 1.96
"""Half width of a 95 % interval over the standard error."""
WHITE: Final = "intervals of white noise"
STEP: Final = 1e-6
"""Relative step of differences."""
MOST_ROWS: Final = 20_000
"""Rows of a regression at most."""


class Found(NamedTuple):
    """What a peer found."""

    values: Mapping[str, float]
    """By path of the unknown."""
    halves: Mapping[str, float]
    """Half widths of its 95 % intervals, by path; none where it gives none."""
    note: str
    """What it was given, and what its intervals hold."""


@dataclass(frozen=True, kw_only=True)
class Peer(metaclass=Described):
    """Another library.

    Examples
    --------
    >>> PEERS["scipy"].law
    'coulomb-viscous'
    """

    name: str
    """Name on the command line."""
    title: str
    """What is run."""
    package: str
    """What it is installed by."""
    law: str
    """Form of friction that it fits."""
    fit: Callable[[Task, Measurement, Fit[Any]], Found]
    """Fits a record; the unknowns are those of a fit of stickslip."""


@dataclass(frozen=True)
class Samples:
    """Rows of a regression: one for each joint and time."""

    force: Array
    """What drives, or friction that was measured, less what is known of the mechanism (n,)."""
    terms: Mapping[str, Array]
    """Columns (n,) that are linear in unknowns of the mechanism, by path."""
    joint: NDArray[np.intp]
    """Number of the joint of each row (n,)."""
    velocity: Array
    """Of the joint (n,)."""
    load: Array
    """Normal force (n,); 1 where levels are forces."""
    voltage: Array
    """Of the motor (n,) [V]; NaN where there is none, or its winding is open."""
    names: tuple[str, ...]
    """Names of the joints."""


def samples(
    task: Task, mechanism: Mechanism, record: Measurement, linear: Sequence[str]
) -> Samples:
    """Return the rows that slip, with columns by parameters of the mechanism."""
    names = mechanism.coordinates
    motor = getattr(mechanism, "drive", None)
    if motor is not None:  # what drives is known from its voltage
        mechanism = replace(cast("Any", mechanism), drive=None, inertia=motor.rotor_inertia)
    measured = any("friction" in item.quantities() for item in record.records())
    torques = None if measured else JointTorques.of(mechanism, linear)
    start = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    known = np.array([start[path] for path in linear])
    parts: list[tuple[Array, ...]] = []
    for whole in record.records():
        opened = motor is not None and whole.overrides.get("mechanism.drive.current_limit") == 0.0
        set_up = mechanism if motor else vary(mechanism, "mechanism", whole.overrides)
        for trial in between_gaps(whole):
            time, motion, force, load = _even(trial, names, "friction" if measured else "force")
            dt = float(time[1] - time[0])
            # Position and force through one filter: what it delays or takes off cancels.
            q, force = _filtered(motion, task.cutoff, dt), _filtered(force, task.cutoff, dt)
            v = np.gradient(q, dt, axis=0)
            a = np.gradient(v, dt, axis=0)
            slopes = np.zeros((*force.shape, 0))
            if torques is not None:
                taken, slopes = torques.along(set_up, time, q, v, a)
                force = force - taken + slopes @ known
            # Filters and differences have wrong values at the ends.
            cut = min(math.ceil(ENDS / (task.cutoff * dt)), len(time) // 4)
            inner = slice(cut, len(time) - cut)
            for j in range(len(names)):
                # Near rest friction is any force up to break-away: such rows say nothing of a law
                # of speed.
                fast = np.abs(v[inner, j]) > SLIP_SHARE * np.max(np.abs(v[inner, j]))
                number = np.full(len(time), j)
                volts = np.full(len(time), np.nan) if opened or motor is None else _on(trial, time)
                columns = (force[:, j], slopes[:, j], number, v[:, j], load, volts)
                parts.append(tuple(column[inner][fast] for column in columns))
    force, slopes, joint, velocity, load, voltage = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    # Every so many rows, so that all of the record is in the regression.
    rows = slice(None, None, max(1, math.ceil(len(force) / MOST_ROWS)))
    return Samples(
        force=force[rows],
        terms={path: slopes[rows, k] for k, path in enumerate(linear)},
        joint=joint[rows],
        velocity=velocity[rows],
        load=load[rows],
        voltage=voltage[rows],
        names=names,
    )


def _on(record: Measurement, even: Array) -> Array:
    """Return the voltage of a record at other times (n,)."""
    result: Array = np.interp(even, np.asarray(record.time), record.values("voltage"))
    return result


def _even(
    record: Measurement, names: Sequence[str], quantity: str
) -> tuple[Array, Array, Array, Array]:
    """Return even times, positions (n, m), forces (n, m) and loads (n,)."""
    time = np.asarray(record.time)
    # Even steps, which filters and differences ask for.
    even = np.arange(time[0], time[-1], float(np.median(np.diff(time))))
    joints = [record.joints[name] for name in names] if record.joints else [record]

    def on(column: Any) -> Array:
        values = np.broadcast_to(np.asarray(column, dtype=float), time.shape)
        return np.asarray(np.interp(even, time, values))

    def columns(name: str) -> Array:
        return np.column_stack([on(getattr(joint, name)) for joint in joints])

    # Friction of a table is over the load; other forces are themselves.
    load = record.load if quantity == "friction" and record.load is not None else 1.0
    missing = quantity == "force" and not record.joints and record.force is None
    force = np.zeros((len(even), len(joints))) if missing else columns(quantity)
    return even, columns("position"), force, on(load)


def _filtered(table: Array, cutoff: float, dt: float) -> Array:
    from scipy.signal import butter, sosfiltfilt

    return np.asarray(sosfiltfilt(butter(ORDER, cutoff, fs=1.0 / dt, output="sos"), table, axis=0))


def unknowns_of(task: Task, fit: Fit[Any]) -> FreeParameters:
    """Return what a fit found as unknowns that begin at ordinary values, with wide limits."""
    laws = fit.law.members if isinstance(fit.law, Laws) else {"": fit.law}
    starts = {path: value for path, _, value in parameters(task.mechanism, "mechanism")}
    for name, law in laws.items():
        begun = starting_law(type(law), 1.0 if name else load_of(task.mechanism))
        room = f"friction.{name}" if name else "friction"
        starts |= {path: value for path, _, value in parameters(begun, room)}
    items = []
    for estimate in fit.estimates:
        start, quantity = starts.get(estimate.path, 0.0), estimate.quantity
        far = WIDE * abs(start) or math.inf  # 0 tells no size
        items.append(
            FreeParameter(
                path=estimate.path, quantity=quantity, start=start,
                low=max(quantity.low, -far), high=min(quantity.high, far),
            )
        )  # fmt: skip
    return FreeParameters(tuple(items))


class Regression:
    """The force of samples as a function of the unknowns of a fit, as its optimiser sees them."""

    def __init__(self, task: Task, record: Measurement, fit: Fit[Any]) -> None:
        self.fit, self.unknown = fit, unknowns_of(task, fit)
        own = self.unknown.paths
        linear = [key for key in own if key.startswith("mechanism.") and key != "mechanism.offset"]
        self.motor = "mechanism.drive.torque_constant" in own
        # A motor's unknowns enter by its voltage, and not as terms of the motion.
        if self.motor:
            linear = [text for text in linear if not text.startswith("mechanism.drive.")]
            linear += ["mechanism.inertia"]
        stated = {path for path, _, _ in parameters(task.mechanism, "mechanism")}
        # links that nobody described are parameters of the fitted robot only
        mechanism = task.mechanism if stated.issuperset(linear) else fit.mechanism
        self.rows = samples(task, mechanism, record, linear)
        contacts = [contact.name for contact in task.mechanism.contacts()]
        several = isinstance(fit.law, Laws)
        self.prefixes = [f"friction.{name}." if several else "friction." for name in contacts]
        self.laws = dict(fit.law.members) if several else {contacts[0]: fit.law}
        self.constants: dict[str, NDArray[np.bool_]] = {}
        for path in own:
            # An offset is a constant of the rows of its joint.
            if "offset" in path:
                result = [j for j, name in enumerate(self.rows.names) if path.endswith(f".{name}")]
                self.constants[path] = np.isin(self.rows.joint, result or [0])

    def _bases(self) -> Iterator[tuple[int, int]]:
        """Yield which unknowns are at least which others: sought is how far they are above."""
        for i, item in enumerate(self.unknown.items):
            base = f"{item.path.rpartition('.')[0]}.{item.quantity.at_least}"
            if base in self.unknown.paths:
                yield i, self.unknown.paths.index(base)

    def values(self, coordinates: Array) -> Array:
        """Return the values (p,) of unknowns at coordinates."""
        result = np.array(self.unknown.values(coordinates), dtype=float)
        for i, base in self._bases():
            result[i] += result[base]
        return result

    def begun(self) -> tuple[Array, tuple[Array, Array]]:
        """Return coordinates to begin at, inside their limits."""
        low, high = (np.array(limit, dtype=float) for limit in self.unknown.limits())
        start = np.array(self.unknown.coordinates(self.unknown.start), dtype=float)
        for i, base in self._bases():
            start[i], low[i] = start[i] - start[base], 0.0
        room = np.where(np.isfinite(high - low), high - low, 1.0)
        # Optimisers refuse a start on a limit.
        return np.clip(start, low + STEP * room, high - STEP * room), (low, high)

    def __call__(self, coordinates: Array) -> Array:
        """Return the predicted force (n,)."""
        values = dict(zip(self.unknown.paths, self.values(coordinates), strict=True))
        rows = self.rows
        if self.motor:
            # The inertia of a motor's axis is that of its rotor.
            values["mechanism.inertia"] = values["mechanism.drive.rotor_inertia"]
        force = sum(
            (values[path] * column for path, column in rows.terms.items()), 0.0 * rows.force
        )
        for path, here in self.constants.items():
            force = force + values[path] * here
        for j, (prefix, (_, law)) in enumerate(zip(self.prefixes, self.laws.items(), strict=True)):
            own = {
                path: x
                for path, x in values.items()
                if path.startswith(prefix) and "offset" not in path
            }
            changed: Any = vary(law, prefix[:-1], own)
            here = rows.joint == j
            force[here] += changed.steady(rows.velocity[here], rows.load[here])
        if self.motor:
            k, r = (values[f"mechanism.drive.{name}"] for name in ("torque_constant", "resistance"))
            # Torque k i of a motor whose current is (U - k v) / R, without inductance.
            force -= np.nan_to_num(k / r * (rows.voltage - k * rows.velocity))
        return force

    def found(self, coordinates: Array, covariance: Array | None, note: str) -> Found:
        """Return the values at coordinates, with intervals by what the coordinates' errors do."""
        values, halves = self.values(coordinates), {}
        if covariance is not None and np.all(np.isfinite(covariance)):
            slopes = []
            for i, at in enumerate(coordinates):
                moved = coordinates.copy()
                moved[i] += STEP * max(abs(at), STEP)
                slopes.append((self.values(moved) - values) / (moved[i] - at))
            # Intervals of parameters by first-order propagation of those of coordinates.
            table = np.array(slopes).T
            errors = np.sqrt(np.diag(table @ covariance @ table.T))
            halves = dict(zip(self.unknown.paths, (NORMAL * errors).tolist(), strict=True))
        return Found(dict(zip(self.unknown.paths, values.tolist(), strict=True)), halves, note)


def _by_scipy(task: Task, record: Measurement, fit: Fit[Any]) -> Found:
    from scipy.optimize import curve_fit

    model = Regression(task, record, fit)
    start, limits = model.begun()

    def predicted(_: Array, *coordinates: float) -> Array:
        return model(np.array(coordinates))

    with np.errstate(all="ignore"):  # overflow far from the optimum is no reason to warn
        best, covariance = curve_fit(
            predicted, np.arange(len(model.rows.force)), model.rows.force, p0=start, bounds=limits
        )
    return model.found(best, covariance, _of_rows(model))


def _library(name: str) -> Any:
    return require_library(name, "bench", f"leave the peer {name} out")


def _of_rows(model: Regression) -> str:
    return f"{len(model.rows.force):,} rows that slip; {WHITE}"


def _by_lmfit(task: Task, record: Measurement, fit: Fit[Any]) -> Found:
    lmfit = _library("lmfit")
    model = Regression(task, record, fit)
    start, (low, high) = model.begun()
    unknown = lmfit.Parameters()
    for i, value in enumerate(start):
        unknown.add(f"p{i}", value=value, min=low[i], max=high[i])

    def residual(unknown: Any) -> Array:
        at = np.array([parameter.value for parameter in unknown.values()])
        # Least squares cannot go on from a residual that is not finite.
        return np.nan_to_num(model.rows.force - model(at), nan=1e6, posinf=1e6, neginf=-1e6)

    with np.errstate(all="ignore"):
        result = lmfit.minimize(residual, unknown, method="leastsq", max_nfev=200 * len(start))
    covariance = getattr(result, "covar", None)
    full = None
    if covariance is not None:
        # Coordinates that it held at a limit have no row.
        full = np.zeros((len(start), len(start)))
        own = [int(name[1:]) for name in result.var_names]
        full[np.ix_(own, own)] = covariance
    best = np.array([param.value for param in result.params.values()])
    return model.found(best, full, _of_rows(model))


def _by_pysindy(task: Task, record: Measurement, fit: Fit[Any]) -> Found:
    """Select terms of the acceleration, as its optimiser does, and read them as friction."""
    sindy = _library("pysindy")
    inertias = [name for name in INERTIAS if hasattr(task.mechanism, name[10:])]
    rows = samples(task, task.mechanism, record, inertias)
    a, weights, inertia = _parts_of(task.mechanism, rows)
    v, size = rows.velocity, np.abs(rows.velocity)
    table = {
        "force": rows.force,
        "1": np.ones_like(v),
        "v": v,
        "sign(v)": np.sign(v),
        "v|v|": v * size,
    }
    table |= weights
    columns = np.column_stack(list(table.values()))
    # The threshold of STLSQ is one for all columns: these must be of one size.
    scale = np.where(np.std(columns, axis=0) > 0.0, np.std(columns, axis=0), 1.0)
    optimizer = sindy.STLSQ(threshold=SPARSE, alpha=0.0)
    with contextlib.redirect_stdout(io.StringIO()):
        optimizer.fit(columns / scale, (a / np.std(a))[:, None])
    result = dict(zip(table, np.ravel(optimizer.coef_) / scale * np.std(a), strict=True))
    kept = [name for name, value in result.items() if value != 0.0]
    if not result["force"] > 0.0:
        raise ConvergenceError("it drops the force from the acceleration")
    # Divided by the coefficient of the force, the acceleration's equation is that of forces.
    shares = {name: value / result["force"] for name, value in result.items()}
    shares["a"] = 1.0 / result["force"]
    values = inertia(shares) | {
        "mechanism.offset": -shares["1"],
        "friction.viscous_coefficient": -shares["v"],
        "friction.kinetic_coefficient": -shares["sign(v)"],
        "friction.quadratic_coefficient": -shares["v|v|"],
    }
    unknown = unknowns_of(task, fit)
    low = {item.path: item.quantity.low for item in unknown.items}
    # Least squares know no ranges of a law.
    raised = [path for path in unknown.paths if values.get(path, 0.0) < low[path]]
    own = {path: max(values.get(path, 0.0), low[path]) for path in unknown.paths}
    note = f"terms kept: {', '.join(kept)}; no intervals"
    if raised:
        note += f"; raised to the range of the law: {', '.join(raised)}"
    return Found(own, {}, note)


INERTIAS: Final = ("mechanism.inertia", "mechanism.mass")


def _parts_of(
    mechanism: Mechanism, rows: Samples
) -> tuple[Array, Mapping[str, Array], Callable[[Mapping[str, float]], dict[str, float]]]:
    """Return accelerations, terms of weight by name, and what reads unknowns from shares."""
    if isinstance(mechanism, Pendulum):
        arm = mechanism.length
        acceleration = rows.terms["mechanism.inertia"]
        # Two terms of the rigid body, m (l^2 a + l g sin q) and J a: the difference is the weight.
        weight = (rows.terms["mechanism.mass"] - arm**2 * acceleration) / (arm * mechanism.gravity)

        def swinging(shares: Mapping[str, float]) -> dict[str, float]:
            mass = -shares["sin(q)"] / (arm * mechanism.gravity)
            return {"mechanism.mass": mass, "mechanism.inertia": shares["a"] - mass * arm**2}

        return acceleration, {"sin(q)": weight}, swinging
    (path,) = rows.terms
    return rows.terms[path], {}, lambda shares: {path: shares["a"]}


MODELS: Final[Mapping[type, str]] = {
    Axis: """
<mujoco>
  <option timestep="{step}" gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody>
    <body name="body">
      <inertial pos="0 0 0" mass="{inertia}" diaginertia="1 1 1"/>
      <joint name="joint" type="slide" axis="1 0 0" damping="{viscous}" frictionloss="{level}"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="push" joint="joint"/>
    <motor name="bias" joint="joint" gear="{gear}"/>
  </actuator>
  <sensor><jointpos name="position" joint="joint"/></sensor>
</mujoco>
""",
    Pendulum: """
<mujoco>
  <option timestep="{step}" gravity="0 0 -{gravity}"><flag contact="disable"/></option>
  <worldbody>
    <body name="body">
      <inertial pos="0 0 -{length}" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/>
      <joint name="joint" type="hinge" axis="0 -1 0" damping="{viscous}"
             frictionloss="{level}" armature="{inertia}"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="push" joint="joint"/>
    <motor name="bias" joint="joint" gear="{gear}"/>
  </actuator>
  <sensor><jointpos name="position" joint="joint"/></sensor>
</mujoco>
""",
}


def _by_mujoco(task: Task, record: Measurement, fit: Fit[Any]) -> Found:
    """Segments as in a fit of stickslip, from states guessed and not fitted."""
    mujoco = _library("mujoco")
    try:
        sysid = importlib.import_module("mujoco.sysid")
        optimize = sysid.optimize
    except (ImportError, AttributeError):
        raise InputError(
            "mujoco.sysid lacks what it imports: pip install 'stickslip[bench]', or leave the"
            " peer mujoco out."
        ) from None
    mechanism: Any = task.mechanism
    found = unknowns_of(task, fit)
    own = {path: setter for path, setter in SETTERS.items() if path in found.paths}
    start = dict(zip(found.paths, found.start.tolist(), strict=True))
    # The shortest step of all records, as the model has one.
    steps = [float(np.median(np.diff(np.asarray(trial.time)))) for trial in record.records()]
    model_of = {
        "step": min(steps),
        "gear": -start.get("mechanism.offset", 0.0),
        "level": start["friction.kinetic_coefficient"],
        "viscous": start["friction.viscous_coefficient"],
        "inertia": start.get("mechanism.inertia", mechanism.inertia),
        "mass": start.get("mechanism.mass", 1.0),
        "length": getattr(mechanism, "length", 0.0),
        "gravity": getattr(mechanism, "gravity", 0.0),
    }
    spec = mujoco.MjSpec.from_string(MODELS[type(mechanism)].format(**model_of))
    model = spec.compile()
    low, high = (dict(zip(found.paths, x.tolist(), strict=True)) for x in found.limits())
    unknown = sysid.ParameterDict()
    for path, put in own.items():
        unknown.add(
            sysid.Parameter(
                path, nominal=start[path], min_value=low[path], max_value=high[path],
                modifier=functools.partial(_put, put, type(mechanism)),
            )
        )  # fmt: skip
    chunks = [
        _chunk(sysid, model, whole, segment)
        for number, whole in enumerate(record.records())
        for segment in segments_of(mechanism, record, length=task.metric.horizon)  # type: ignore[attr-defined]
        if segment.record == number
    ]
    states, controls, sensed = zip(*chunks, strict=True)
    names = [f"segment {k}" for k in range(len(chunks))]
    sequences = sysid.ModelSequences(task.name, spec, names, states, controls, sensed)
    residual = sysid.build_residual_fn(models_sequences=[sequences])
    with contextlib.redirect_stdout(io.StringIO()):  # each round of its optimiser prints a line
        best, ended = optimize(
            initial_params=unknown, residual_fn=residual, optimizer="mujoco", verbose=False
        )
        rows = residual(ended.x, best)
        half = sysid.calculate_intervals(rows[0], ended.jac)[1]
    values = {path: float(best[path].value[0]) for path in own}
    # What its model does not have is 0.
    held = {path: 0.0 for path in found.paths if path not in own}
    return Found(
        held | values,
        dict(zip(own, map(float, half), strict=True)),
        f"{len(chunks)} segments from guessed states; {WHITE}",
    )


def _joint(field: str) -> Callable[[Any, float], None]:
    """Return what sets a field of the joint, whose shape differs between versions of MuJoCo."""

    def put(spec: Any, value: float) -> None:
        old = np.asarray(getattr(spec.joint("joint"), field), dtype=float)
        new = np.zeros_like(old)
        if old.ndim:
            new[0] = value
        setattr(spec.joint("joint"), field, new if old.ndim else value)

    return put


SETTERS: Final[Mapping[str, Callable[[Any, float], None]]] = {
    "mechanism.mass": lambda spec, x: setattr(spec.body("body"), "mass", x),
    "mechanism.inertia": _joint("armature"),
    "friction.kinetic_coefficient": _joint("frictionloss"),
    "friction.viscous_coefficient": _joint("damping"),
    "mechanism.offset": lambda spec, x: setattr(spec.actuator("bias"), "gear", [-x, 0, 0, 0, 0, 0]),
}


def _put(put: Callable[[Any, float], None], kind: type, spec: Any, parameter: Any) -> None:
    # On a straight axis the inertia is the mass of the body.
    own = SETTERS["mechanism.mass"] if kind is Axis and put is SETTERS["mechanism.inertia"] else put
    own(spec, float(parameter.value[0]))


def _chunk(sysid: Any, model: Any, record: Measurement, segment: Any) -> tuple[Any, Any, Any]:
    """Return first state, control and measured positions of a segment on MuJoCo's steps."""
    t = np.arange(0.0, segment.times[-1], model.opt.timestep)
    seen = np.asarray(record.time) - segment.start
    force, x = (np.interp(t, seen, np.asarray(record.values(n))) for n in ("force", "position"))
    state = sysid.create_initial_state(model, segment.guess[:1], segment.guess[1:2], np.empty(0))
    control = sysid.TimeSeries(t, np.column_stack([force, np.ones_like(t)]))
    # Sensors are read at the end of each step.
    return state, control, sysid.TimeSeries.from_names(t[1:], x[1:, None], model)


def by_speed(
    name: str, record: Measurement, judging: Measurement, since: float
) -> tuple[Found, float]:
    """Fit a coefficient of friction that follows the speed of the load point; return its error.

    SciPy's is c + b V, as Coulomb and viscous friction are; that of lmfit c + a ln V.
    """
    fitted, judged = (_speed_and_coefficient(trial) for trial in (record, judging))
    late = np.asarray(judging.time) >= since
    if name == "scipy":
        from scipy.optimize import curve_fit

        def linear(v: Array, c: float, b: float) -> Array:
            return c + b * v

        best, covariance = curve_fit(linear, *fitted, p0=(0.5, 0.0))
        halves = NORMAL * np.sqrt(np.diag(covariance))
        predicted, paths = linear(judged[0], *best), ("c", "b")
    else:
        lmfit = _library("lmfit")

        def logarithmic(v: Array, c: float, a: float) -> Array:
            return c + a * np.log(v)

        result = lmfit.Model(logarithmic).fit(fitted[1], v=fitted[0], c=0.5, a=0.01)
        best = [result.params[key].value for key in ("c", "a")]
        halves = np.array([NORMAL * result.params[key].stderr for key in ("c", "a")])
        predicted, paths = result.eval(v=judged[0]), ("c", "a")
    error = float(np.sqrt(np.mean((judged[1] - predicted)[late] ** 2)))
    note = f"{len(fitted[0]):,} rows, the speed of the load point; {WHITE}"
    values = dict(zip(paths, map(float, best), strict=True))
    return Found(values, dict(zip(paths, map(float, halves), strict=True)), note), error


def _speed_and_coefficient(record: Measurement) -> tuple[Array, Array]:
    """Return the speed of the load point between its steps (n,), and friction over load (n,)."""
    time, pull = np.asarray(record.time), np.asarray(record.values("pull"))
    lag = max(len(time) // 200, 1)
    speed = (pull[lag:] - pull[:-lag]) / (time[lag:] - time[:-lag])
    speed = np.concatenate([speed, np.full(lag, speed[-1])])
    coefficient = np.asarray(record.values("friction")) / np.asarray(record.values("load"))
    # Never 0: its logarithm is taken.
    return np.maximum(speed, STEP * np.max(speed)), coefficient


PEERS: Final[Mapping[str, Peer]] = MappingProxyType(
    {
        peer.name: peer
        for peer in (
            Peer(
                name="scipy",
                title="SciPy curve_fit, Coulomb + viscous",
                package="scipy",
                law="coulomb-viscous",
                fit=_by_scipy,
            ),
            Peer(
                name="lmfit",
                title="lmfit, Stribeck",
                package="lmfit",
                law="stribeck",
                fit=_by_lmfit,
            ),
            Peer(
                name="pysindy",
                title="PySINDy, STLSQ",
                package="pysindy",
                law="level + viscous + drag",
                fit=_by_pysindy,
            ),
            Peer(
                name="mujoco",
                title="mujoco.sysid, damping + frictionloss",
                package="mujoco",
                law="coulomb-viscous",
                fit=_by_mujoco,
            ),
        )
    }
)
"""Peers by name."""
