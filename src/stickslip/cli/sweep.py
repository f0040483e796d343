"""``stickslip sweep``."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.cli.console import print_json, refuse_inputs, refuse_overwriting, show_table, stdout
from stickslip.cli.law_choice import (
    friction_content,
    friction_of,
    friction_title,
    laws_drawn,
    rig_and_friction,
)
from stickslip.cli.options import LawOptions
from stickslip.cli.process_pool import workers
from stickslip.cli.progress import Drawing
from stickslip.cli.simulate import check_table, table_bytes
from stickslip.documents import document, write_files
from stickslip.errors import InputError, check_size
from stickslip.executors import Inline
from stickslip.experiments import Rig, settled_speed
from stickslip.formatting import joined, number, printable
from stickslip.friction import FrictionLaw
from stickslip.quantities import full_path, parameters
from stickslip.sweep import VelocityBand, VelocityMap, average_velocity, velocity_band

Array = NDArray[np.float64]
SIZE = (800, 360)
MOST_AXES = 2


def run(
    path: Path | None,
    changes: Sequence[str],
    asked: LawOptions,
    vary: Sequence[str],
    cycles: int,
    settle: int,
    coordinate: str | None,
    output: Path,
    *,
    draws: int | None,
    seed: int,
    count: int | None,
    executor: str | None,
    allow_import: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Run the grid, write table and figure, show."""
    check_table(output)
    figure = output.with_suffix(".svg")
    for file in (output, figure):
        refuse_overwriting(file, output.parent, force=force)
    axes = _axes(vary)
    if draws is not None and (coordinate is not None or len(axes) > 1):
        raise InputError("--ensemble takes one --vary, and no --coordinate.")
    rig, chosen = rig_and_friction(path, changes, asked, allow_import=allow_import)
    refuse_inputs(output, rig.files)
    law = friction_of(chosen)
    options: dict[str, Any] = {"cycles": cycles, "settle": settle, "y0": rig.start(law)}
    turns: Sequence[float] = []
    measured: dict[float, float] = {}
    found: VelocityMap | VelocityBand
    if draws is not None:
        laws, options["error"] = laws_drawn(rig, chosen, asked, draws, seed)
        ((name, values),) = axes.items()
        measured = _filmed(rig, name, values)
        values = np.union1d(values, [*measured])  # a curve with jumps tells nothing in between
        with Drawing("Running", "laws") as progress:
            found = velocity_band(rig.mechanism, laws, {name: values}, progress=progress, **options)
        content = _band_content(found, laws, measured)
    else:
        with Drawing("Running", "runs") as progress, workers(count or 1, executor) as pool:
            found = average_velocity(
                rig.mechanism,
                law,
                axes,
                coordinate=coordinate,
                executor=pool or (Inline() if count == 1 else None),
                progress=progress,
                **options,
            )
        turns = found.reversals().tolist() if len(found.axes) == 1 else []
        content = _content(found, turns)
    _write(found, measured, output, figure)
    if as_json:
        head = {"rig": rig.heading, "digest": rig.digest}
        head |= friction_content(chosen, rig.mechanism)
        files = [str(output), str(figure)]
        print_json(document("sweep", head | content | {"files": files}))
        return
    stdout().print(printable(rig.heading), markup=False, style="bold", end="")
    if isinstance(found, VelocityBand):
        counts = [f"{name} {times}" for name, times in content["laws"].items()]
        stdout().print(f", laws drawn: {joined(counts)}", markup=False)
        _show_band(found, measured)
    else:
        stdout().print(f", {friction_title(chosen)} friction", markup=False)
        _show(found, turns)
    stdout().print(f"\nWritten: {output}, {figure}", markup=False)


def _filmed(rig: Rig, name: str, values: Array) -> dict[float, float]:
    """Return the speeds of films in which a parameter was set within a range, by its value."""
    known = {path: quantity for path, quantity, _ in parameters(rig.mechanism, "mechanism")}
    films = [] if rig.measurement is None else rig.measurement.records()
    found = {}
    for film in films if any(film.overrides for film in films) else ():
        at = film.overrides.get(full_path(name, known))
        if at is not None and film.position is not None and values.min() <= at <= values.max():
            found[at] = settled_speed(rig.mechanism, film)[0]
    return found


def _band_content(
    found: VelocityBand, laws: Sequence[FrictionLaw], measured: Mapping[float, float]
) -> dict[str, Any]:
    return {
        "path": found.path,
        "unit": found.unit,
        "values": found.values.tolist(),
        **{end: getattr(found, end).tolist() for end in ("low", "median", "high")},
        "velocity_unit": found.velocity_unit,
        "level": found.level,
        "error": found.error,
        "laws": dict(Counter(one.name for one in laws)),
        "measured": [list(pair) for pair in measured.items()],
        "early_ends": list(found.reasons),
    }


def _content(found: VelocityMap, turns: Sequence[float]) -> dict[str, Any]:
    return {
        "axes": {name: values.tolist() for name, values in found.axes.items()},
        **({"coordinate": found.coordinate} if found.coordinate else {}),
        "unit": found.unit,
        "velocity": found.velocity.tolist(),
        "status": np.reshape(
            [one.name for one in found.status.ravel().tolist()], found.status.shape
        ).tolist(),
        "early_ends": list(found.early_ends()),
        "reversals": list(turns),
    }


def _write(
    found: VelocityMap | VelocityBand, measured: Mapping[float, float], output: Path, figure: Path
) -> None:
    from stickslip.plots import draw_velocity_band, draw_velocity_map, standalone_svg

    if isinstance(found, VelocityBand):
        drawing, ends = draw_velocity_band(found, measured), ("low", "median", "high")
        units = {found.path: found.unit} | dict.fromkeys(ends, found.velocity_unit)
    else:
        drawing = draw_velocity_map(found)
        units = {**found.units, "period": "s", "velocity": found.unit, "unsettled": found.unit}
    svg = standalone_svg(drawing, size=SIZE, title="Mean velocity")
    write_files({output: table_bytes(found.to_dataframe(), output, units), figure: svg})


def _show_band(found: VelocityBand, measured: Mapping[float, float]) -> None:
    stdout().print(str(found), markup=False)
    ends = zip(found.values.tolist(), found.low, found.high, strict=True)
    seen = [(at, low <= measured[at] <= high) for at, low, high in ends if at in measured]
    if seen:
        off = [number(at, 6) for at, inside in seen if not inside]
        where = f", not at {joined(off)} {found.unit}" if off else ""
        stdout().print(f"{len(seen) - len(off)} of {len(seen)} measured speeds lie in it{where}.")


def _show(found: VelocityMap, turns: Sequence[float]) -> None:
    console = stdout()
    rows = []
    for word, pick in (("largest", np.nanargmax), ("least", np.nanargmin)):
        if not np.isfinite(found.velocity).any():
            break
        place = np.unravel_index(pick(found.velocity), found.velocity.shape)
        at = [
            f"{number(values[i], 6)} {found.units[name]}"
            for i, (name, values) in zip(place, found.axes.items(), strict=True)
        ]
        rows.append([word, f"{number(found.velocity[place] + 0.0, 6)}", *at])
    if rows:
        show_table("", ["mean velocity", found.unit, *found.axes], rows)
    for turn in turns:
        console.print(f"The mean velocity changes sign at {number(turn, 6)}.", markup=False)
    for reason in found.early_ends():
        console.print(reason, markup=False)


def _axes(vary: Sequence[str]) -> dict[str, Array]:
    """Read ``path=low:high:n``, once or twice."""
    if not 1 <= len(vary) <= MOST_AXES:
        raise InputError(f"--vary is given once or twice, got {len(vary)}.")
    found = {}
    for text in vary:
        path, _, span = text.partition("=")
        try:
            low, high, count = span.split(":")
            check_size(f"--vary {path}", int(count), "give fewer values")
            values = np.linspace(float(low), float(high), int(count))
        except InputError:
            raise
        except ValueError:
            values = np.empty(0)
        if not path.strip() or not values.size:
            raise InputError(
                "--vary takes PATH=LOW:HIGH:N in SI units such as"
                f" mechanism.drive.drive.frequency=1:6:50, got {text!r}."
            )
        found[path.strip()] = values
    return found
