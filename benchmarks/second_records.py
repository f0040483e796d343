"""Measured records, and how much of another record of the same machine lies in their bands.

``python -m benchmarks.second_records`` judges each first record by `select` with the second as
``validate``, and prints the share of its readings in the 95 % band. Records are those of the
catalogue, or of the folder that ``STICKSLIP_DATA`` names: EMPS by halves, the tribometer and joints
of a TX40 from three fifths to the rest, a pendulum drive from one motion to four others.
"""

import argparse
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from stickslip import Axis, Measurement, Pendulum, select
from stickslip.data import catalogue
from stickslip.errors import StickslipError
from stickslip.identify import BandVerdict

FIRST = 0.6
"""Part of a record that the rest is predicted from."""
SETTLED = 9.6
"""Time [s] from which the tribometer runs evenly, as its source says."""
UNTOUCHED: Mapping[str, float] = {"sac": 4.0, "ilqr": 5.0, "energy_shaping": 5.0}
"""Seconds of the motions of the pendulum in which nobody pushes it."""
MOTIONS = ("ddp", "sac", "ilqr", "energy_shaping", "identification")
INERTIA = ("mechanism.inertia",)


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A record, and others of the same machine."""

    name: str
    mechanism: Any
    first: Measurement
    others: Mapping[str, Measurement]
    unknown: Sequence[str] = ()


def _table(name: str, file: str) -> Any:
    return pd.read_parquet(catalogue.dataset(name).path(file))


def _emps(table: Any) -> Measurement:
    columns = (table[one].to_numpy() for one in ("t_s", "q_meas_m", "force_N"))
    return Measurement(**dict(zip(("time", "position", "force"), columns, strict=True)))


def _loops(table: Any) -> Measurement:
    return Measurement(
        time=table["t_s"].to_numpy(),
        position=table["x_m"].to_numpy(),
        friction=-table["friction_N"].to_numpy(),
        load=table["normal_N"].to_numpy(),
    )


def _joint(table: Any, number: int) -> Measurement:
    return Measurement(
        time=table["t_s"].to_numpy(),
        position=table[f"q{number}_rad"].to_numpy(),
        force=table[f"tau{number}_Nm"].to_numpy(),
        turning=True,
    )


def _swing(name: str) -> Measurement:
    table = _table("simple_pendulum_drive", name)
    t = table["t_s"].to_numpy()
    grows = np.concatenate([[True], np.diff(t) > 0.0])
    table = table[(t < t[0] + UNTOUCHED.get(name, np.inf)) & grows]
    return Measurement(
        time=table["t_s"].to_numpy(),
        position=table["q_rad"].to_numpy(),
        velocity=table["dq_rad_s"].to_numpy(),
        force=table["tau_Nm"].to_numpy(),
    )


def pairs() -> Iterator[Pair]:
    """Yield records with others of their machines."""
    table = _table("emps", "train")
    halves = [_emps(part) for part in (table[: len(table) // 2], table[len(table) // 2 :])]
    for k, name in enumerate(("EMPS, first half", "EMPS, second half")):
        yield Pair(
            name=name,
            mechanism=Axis(inertia=100.0),
            first=halves[k],
            others={"other half": halves[1 - k]},
            unknown=INERTIA,
        )
    table = _table("reciprocating_tribometer", "train")
    table = table[table["t_s"] > SETTLED]
    cut = int(FIRST * len(table))
    first, rest = _loops(table[:cut]), _loops(table[cut:])
    yield Pair(name="tribometer", mechanism=Axis(inertia=1.0), first=first, others={"rest": rest})
    table = _table("staubli_tx40", "train")
    cut = int(FIRST * len(table))
    for joint in range(1, 7):
        yield Pair(
            name=f"TX40, joint {joint}",
            mechanism=Axis(inertia=1.0),
            first=_joint(table[:cut], joint),
            others={"rest": _joint(table[cut:], joint)},
            unknown=INERTIA,
        )
    swings = {name: _swing(name) for name in MOTIONS}
    yield Pair(
        name="pendulum, ddp",
        mechanism=Pendulum(mass=0.676, length=0.45),
        first=swings["ddp"],
        others={name: one for name, one in swings.items() if name != "ddp"},
        unknown=("mechanism.mass",),
    )


def measured(pair: Pair) -> Iterator[str]:
    """Yield a line for each other record."""
    for name, other in pair.others.items():
        began = time.process_time()
        try:
            verdict = select(
                pair.mechanism,
                None,
                pair.first,
                vary=["friction.*", *pair.unknown] if pair.unknown else None,
                route="balance",
                validate=other,
            )
        except StickslipError as error:
            yield f"{pair.name:20}{name:16}refused: {error}"
            continue
        seconds = time.process_time() - began
        assert isinstance(verdict, BandVerdict)
        law = verdict.closest.title
        yield f"{pair.name:20}{name:16}{verdict.inside:.3f} inside  {seconds:5.1f} s  {law}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print how much of other records lies in the bands of measured ones."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.second_records")
    parser.add_argument("--only", default="", help="beginning of the names of records")
    given = parser.parse_args(arguments)
    for pair in pairs():
        if pair.name.startswith(given.only):
            for line in measured(pair):
                print(line, flush=True)


if __name__ == "__main__":
    main()
