r"""Limit cycles of a block that a spring pulls: frequency, mean and scatter of the spring's force.

A block that sticks forgets what was before: spring and damper pull it away at the static level, and
each cycle is the same. With the force :math:`y` of the spring, the speed :math:`v` of the block and
:math:`V` of the pull,

1. *slip*: from rest at :math:`y + c V = F_s`, steps of Runge and Kutta of

   .. math:: \dot y = k (V - v), \qquad m \dot v = y + c (V - v) - F(v, N),

   with the integrals of the force and its square, until :math:`v = 0`;
2. *stick*: the force grows by :math:`k V` up to :math:`F_s`, in closed form.

A block that does not come to rest within `SWINGS` natural periods either swings on, and its cycle
is the last swing, or comes to slide steadily: its frequency and scatter are 0.

Laws with memory, with inputs of the contact, or under a modulated load are run by the engine until
the motion has settled.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import ensemble
from stickslip.engine.solver import EventDriven, Samples
from stickslip.friction import FrictionLaw
from stickslip.identify.bands import Array
from stickslip.identify.fits import with_arrays
from stickslip.mechanisms import TowedBlock

STEPS = 60
"""Steps in a natural period: features are right to 1e-4."""
SWINGS = 8
"""Natural periods after which a block that has not come to rest is watched for its swing."""
FADES = 0.95
"""Variance of a swing over that of the one before, below which the swing fades."""
OWN = ("mass", "stiffness", "speed", "damping")
SETTLING, WATCHED, SAMPLES = 12, 10, 64
"""Of the engine: cycles before the motion has settled, cycles watched, samples in a cycle."""
SOLVER = EventDriven(tier="compiled", tolerance=1e-7, stiff_tolerance=1e-5, max_steps=50_000)
"""Features carry a part of a per cent of doubt."""


def limit_cycles(
    block: TowedBlock, law: FrictionLaw, values: Mapping[str, Array], period: Array
) -> Array:
    """Return frequency [Hz], mean and scatter of the force over the load (n, 3).

    `values` has arrays (n,) by path, `law` what is not in it, and `period` the periods that are
    expected [s], for runs of the engine. Frequency and scatter are 0 where a block slides steadily;
    features are NaN where a run fails. The load stays the same whatever the mass.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> found = limit_cycles(block, law, {"mechanism.speed": np.array([0.1])}, np.array([7.6]))
    >>> float(1.0 / found[0, 0]).__round__(4)
    7.6113
    """
    count = len(period)
    whole = replace(block, load=block.steady_load)
    if law.states or law.inputs or block.modulation is not None:
        result = np.full((count, 3), np.nan)
        rows = {path: np.broadcast_to(x, count) for path, x in values.items()}
        for size in np.unique(np.round(np.log(period), 2)):
            (same,) = np.nonzero(np.round(np.log(period), 2) == size)
            own = {path: x[same] for path, x in rows.items()}
            result[same] = _run(whole, law, own, math.exp(size))
        return result
    return _Pull(whole, law, values, count).cycles()


class _Pull:
    """Blocks that slip, as arrays (n,) of their states and sums."""

    def __init__(
        self, block: TowedBlock, law: FrictionLaw, values: Mapping[str, Array], count: int
    ) -> None:
        self.block, self.base, self.values = block, law, values
        self.count = count
        rows = {name: values.get(f"mechanism.{name}", getattr(block, name)) for name in OWN}
        self.m, self.k, self.V, self.c = (np.broadcast_to(x, count) * 1.0 for x in rows.values())
        self.N = np.broadcast_to(values.get("mechanism.load", block.steady_load), count) * 1.0
        table = {path: x for path, x in values.items() if path.startswith("friction.")}
        self.law = with_arrays(law, table) if table else law
        self.holds = np.broadcast_to(self.law.break_away(self.N), count)

    def taken(self, rows: NDArray[np.intp]) -> "_Pull":
        """Return some of the blocks."""
        values = {path: np.broadcast_to(x, self.count)[rows] for path, x in self.values.items()}
        return _Pull(self.block, self.base, values, len(rows))

    def rates(self, z: Array) -> Array:
        """Return the rates (4, n) of force, speed, and integrals of the force less `holds`."""
        y, v = z[0], z[1]
        friction = self.law.force(np.maximum(v, 1e-9 * self.V), self.N)
        pulled = y + self.c * (self.V - v)
        off = pulled - self.holds
        return np.array([self.k * (self.V - v), (pulled - friction) / self.m, off, off**2])

    def stepped(self, z: Array, h: Array) -> Array:
        """Return the states (4, n) after a time (n,)."""
        a = self.rates(z)
        b = self.rates(z + 0.5 * h * a)
        c = self.rates(z + 0.5 * h * b)
        d = self.rates(z + h * c)
        return np.asarray(z + h / 6.0 * (a + 2.0 * b + 2.0 * c + d))

    def cycles(self) -> Array:
        """Return the features (n, 3)."""
        result = np.full((self.count, 3), np.nan)
        stopped = np.zeros((6, self.count))  # the state before it stops, the step, and the time
        rests, live = np.zeros(self.count, dtype=bool), np.ones(self.count, dtype=bool)
        pull, rows, z = self, np.arange(self.count), np.zeros((4, self.count))
        z[0] = self.holds - self.c * self.V
        time, passed = np.zeros(self.count), np.zeros((3, 3, self.count))
        with np.errstate(all="ignore"):
            for number in range(SWINGS * STEPS):
                h = 2.0 * math.pi * np.sqrt(pull.m / pull.k) / STEPS
                after = pull.stepped(z, h)
                if not number:
                    after[1] = np.maximum(after[1], 0.0)
                rises = (z[1] < pull.V) & (after[1] >= pull.V)
                ends = live & ((after[1] <= 0.0) | ~np.isfinite(after[1])) & (number > 0)
                if rises.any():
                    share = (pull.V - z[1]) / np.where(rises, after[1] - z[1], 1.0)
                    now = np.array([time + share * h, *(z[2:] + share * (after - z)[2:])])
                    passed[:, :, rises] = np.concatenate([passed[1:], now[None]])[:, :, rises]
                    fades = live & rises & ~ends & (_fading(passed) < FADES)
                    if fades.any():
                        own = pull.taken(np.flatnonzero(fades))
                        result[rows[fades]] = own.swinging(passed[:, :, fades])
                        live &= ~fades
                stopped[:, rows[ends]] = [*z[:, ends], h[ends], time[ends]]
                rests[rows[ends]] = True
                live &= ~ends
                z, time = after, time + h
                if 2 * np.count_nonzero(live) <= len(live):
                    goes = np.flatnonzero(live)
                    if not len(goes):
                        break
                    pull, rows, live = pull.taken(goes), rows[goes], live[goes]
                    z, time, passed = z[:, goes], time[goes], passed[:, :, goes]
            if live.any():
                left = np.flatnonzero(live)
                result[rows[left]] = pull.taken(left).swinging(passed[:, :, left])
            last = np.flatnonzero(rests)
            if len(last):
                *before, h, time = stopped[:, last]
                result[last] = self.taken(last).stuck(np.array(before), h, time)
        return result

    def stuck(self, z: Array, h: Array, time: Array) -> Array:
        """Return the features (n, 3) of blocks that come to rest within a step."""
        share = np.ones(self.count)
        last = self.stepped(z, h)
        share = z[1] / (z[1] - last[1])
        for _ in range(3):
            last = self.stepped(z, share * h)
            slowing = self.rates(last)[1]
            share = np.clip(share - last[1] / (slowing * h), 0.0, 1.0)
        last, slip = self.stepped(z, share * h), time + share * h
        off = last[0] + self.c * self.V - self.holds
        stick = -off / (self.k * self.V)
        whole = slip + stick
        mean = (last[2] + 0.5 * off * stick) / whole
        square = (last[3] + off**2 * stick / 3.0) / whole
        result = self._features(1.0 / whole, mean, square - mean**2)
        result[(off >= 0.0) | (off < -2.0 * self.holds)] = np.nan  # it is pushed back
        return result

    def swinging(self, passed: Array) -> Array:
        """Return the features (n, 3) of blocks that do not stop, from times they pass V."""
        period, mean, variance = _swings(passed)
        steady = self.law.force(self.V, self.N) - self.holds
        result = self._features(1.0 / period[1], mean[1], variance[1])
        slides = self._features(0.0 * steady, steady, 0.0 * steady)
        lasts = (passed[0, 0] > 0.0) & (_fading(passed) > FADES)
        return np.where(lasts[:, None], result, slides)

    def _features(self, frequency: Array, off: Array, variance: Array) -> Array:
        spread = np.sqrt(np.maximum(variance, 0.0))
        return np.column_stack([frequency, (self.holds + off) / self.N, spread / self.N])


def _swings(passed: Array) -> tuple[Array, Array, Array]:
    """Return periods, means and variances of two swings (2, n) between times they pass V."""
    spans = np.diff(passed, axis=0)
    mean = spans[:, 1] / spans[:, 0]
    return spans[:, 0], mean, spans[:, 2] / spans[:, 0] - mean**2


def _fading(passed: Array) -> Array:
    """Return the variance of the last swing over that before (n,); infinite without two."""
    variance = _swings(passed)[2]
    return np.where(passed[0, 0] > 0.0, variance[1] / variance[0], np.inf)


def _run(block: TowedBlock, law: FrictionLaw, values: Mapping[str, Array], period: float) -> Array:
    """Return the features (n, 3) of runs of the engine, with about the same period [s]."""
    times = period * (SETTLING + np.arange(WATCHED * SAMPLES + 1) / SAMPLES)
    rows = {name: values.get(f"mechanism.{name}", getattr(block, name)) for name in OWN}
    load = values.get("mechanism.load", block.steady_load)
    stiffness, speed, damping, load = (
        np.asarray(x)[..., None] for x in (rows["stiffness"], rows["speed"], rows["damping"], load)
    )
    level = law.steady(block.speed, block.steady_load)
    runs = ensemble(
        block,
        law,
        values,
        t_end=float(times[-1]),
        outputs={"x": Samples("x", list(times)), "v": Samples("v", list(times))},
        y0={"x": -level / block.stiffness},
        solver=SOLVER,
    )
    force = stiffness * (speed * times - runs["x"]) + damping * (speed - runs["v"])
    complete = [status.complete for status in runs.status]
    return np.array([
        _cycle(times, row) if good else np.full(3, np.nan)
        for row, good in zip(force / load, complete, strict=True)
    ])  # fmt: skip


def _cycle(times: Array, force: Array) -> Array:
    """Return frequency, mean and standard deviation over whole cycles of a periodic force."""
    mean, spread = float(force.mean()), float(force.std())
    ups = np.flatnonzero((force[:-1] < mean) & (force[1:] >= mean))
    if len(ups) < 3 or spread < 1e-4 * abs(mean):
        return np.array([0.0, mean, 0.0])
    share = (mean - force[ups]) / (force[ups + 1] - force[ups])
    crossings = times[ups] + share * (times[1] - times[0])
    whole = force[ups[0] + 1 : ups[-1] + 1]
    frequency = (len(ups) - 1) / (crossings[-1] - crossings[0])
    return np.array([frequency, float(whole.mean()), float(whole.std())])
