"""``stickslip simulate``."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich.text import Text

from stickslip.cli.laws import law_of
from stickslip.cli.output import (
    document,
    note,
    overrides,
    print_json,
    refuse_overwriting,
    show_table,
    stdout,
    write_file,
)
from stickslip.errors import InputError
from stickslip.experiments import Rig, load_rig
from stickslip.friction import FrictionLaw, PrintedForm, bristles_of
from stickslip.report.numbers import residue
from stickslip.selection import criteria_of
from stickslip.simulation import simulate
from stickslip.solver import FixedStep, Solver
from stickslip.trajectory import Trajectory

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Settings", "check_table", "run", "start_of", "table_bytes"]

CRITERIA_FAILED = 4
EVENT_CHECKS = ("guard_violation", "event_residual", "stick_drift")
"""Parts of a certificate that only a run with located events has."""
MODES = {0: "stick", 1: "slip +", -1: "slip -", 2: "at stop +", -2: "at stop -"}


@dataclass(frozen=True, kw_only=True)
class Settings:
    """What to run and how."""

    law: str | None
    t_end: float | None
    samples: int
    fixed_step: float | None
    method: str
    stick_rule: bool


def run(
    path: Path | None,
    changes: Sequence[str],
    settings: Settings,
    output: Path | None,
    *,
    allow_import: bool,
    force: bool,
    as_json: bool,
    enforce: bool,
) -> None:
    """Simulate, export, show."""
    if output is not None:
        check_table(output)
        refuse_overwriting(output, output.parent, force=force)
    rig = load_rig(path, overrides=overrides(changes), allow_import=allow_import)
    law = law_of(rig, settings.law)
    t_end = rig.t_end if settings.t_end is None else settings.t_end
    start = start_of(rig, law)
    trajectory = simulate(rig.mechanism, law, t_end=t_end, y0=start, solver=_solver(settings))
    seen = criteria_of(trajectory, rig.mechanism)
    if output is not None:
        frame = trajectory.sampled(settings.samples).to_dataframe()
        write_file(output, table_bytes(frame, output))
    if as_json:
        content = _content(rig, law, trajectory, settings) | {"criteria": asdict(seen)}
        print_json(document("simulate", content))
    else:
        _show(rig, law, trajectory, settings)
        if output is not None:
            stdout().print(f"\nExported: {output}", markup=False)
    if enforce and not (seen.velocity_never_negative and seen.displacement_never_decreases):
        note("A criterion of the paper fails: the body moves backwards.")
        raise typer.Exit(CRITERIA_FAILED)


def start_of(rig: Rig, law: FrictionLaw) -> Mapping[str, float]:
    """Return how the first trial begins; bristles that the law does not have are left out."""
    if rig.measurement is None:
        return {}
    bristles = bristles_of(law)
    known = (*rig.mechanism.coordinates, *rig.mechanism.rates, *bristles)
    initial = rig.measurement.records()[0].initial
    return {name: value for name, value in initial.items() if name in known}


def _solver(settings: Settings) -> Solver | None:
    if settings.fixed_step is None:
        return None
    return FixedStep(
        dt=settings.fixed_step,
        method=settings.method,  # type: ignore[arg-type]  # checked by FixedStep itself
        stick_rule=settings.stick_rule,
    )


def check_table(output: Path) -> None:
    """Refuse what is neither CSV nor Parquet."""
    if output.suffix not in (".csv", ".parquet"):
        raise InputError(f"--output takes a .csv or .parquet file, got {output}.")


def table_bytes(frame: "pd.DataFrame", output: Path) -> bytes:
    """Return a table as the file's kind asks for."""
    if output.suffix == ".csv":
        return frame.to_csv(index=False).encode()
    buffer = io.BytesIO()
    frame.to_parquet(buffer, index=False)
    return buffer.getvalue()


def _content(
    rig: Rig, law: FrictionLaw | PrintedForm, run: Trajectory, settings: Settings
) -> dict[str, Any]:
    ends = run.at(run.span)
    unchecked = EVENT_CHECKS if settings.fixed_step is not None else ()
    return {
        "rig": rig.title,
        "digest": rig.digest,
        "law": law.name,
        "status": run.status.name,
        "meaning": run.status.value,
        "final": {name: float(ends[name][1]) for name in run.names},
        "events": [asdict(event) for event in run.events],
        "certificate": {
            **asdict(run.certificate),
            **dict.fromkeys(unchecked),
            "certified": run.certificate.certified,
        },
    }


def _show(rig: Rig, law: FrictionLaw, run: Trajectory, settings: Settings) -> None:
    console = stdout()
    console.print(Text.assemble((rig.title, "bold"), f", {law.title} friction"))
    console.print(run.status.value, markup=False)
    rows = [
        [f"{event.t:.6f}", event.reason, MODES[event.from_mode], MODES[event.to_mode]]
        for event in run.events
    ]
    if rows:
        show_table("", ["t, s", "event", "from", "to"], rows)
    ends = run.at(run.span)
    final = ", ".join(
        f"{name} = {ends[name][1] + 0.0:.6g} {run.units[name]}" for name in run.names[:2]
    )
    console.print(f"At {run.span[1]:g} s: {final}", markup=False)
    trust = run.certificate
    checked = f"Energy mismatch {residue(trust.energy_error)}, "
    if settings.fixed_step is None:
        checked += f"guard violation {residue(trust.guard_violation)}, "
        checked += f"stick drift {residue(trust.stick_drift)}, "
    console.print(f"{checked}{trust.steps} steps", markup=False)
    for warning in trust.warnings:
        console.print(f"Near a limit: {warning}", markup=False)
    for problem in trust.problems:
        console.print(f"Not certified: {problem}", markup=False)
