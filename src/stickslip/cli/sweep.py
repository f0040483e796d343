"""``stickslip sweep``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.cli.console import print_json, refuse_inputs, refuse_overwriting, show_table, stdout
from stickslip.cli.law_choice import friction_content, friction_of, friction_title, rig_and_friction
from stickslip.cli.options import LawOptions
from stickslip.cli.process_pool import workers
from stickslip.cli.progress import Drawing
from stickslip.cli.simulate import check_table, table_bytes
from stickslip.documents import document, write_files
from stickslip.errors import InputError, check_size
from stickslip.executors import Inline
from stickslip.formatting import number, printable
from stickslip.sweep import VelocityMap, average_velocity

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
    rig, chosen = rig_and_friction(path, changes, asked, allow_import=allow_import)
    refuse_inputs(output, rig.files)
    law = friction_of(chosen)
    start = rig.start(law)
    with Drawing("Running", "runs") as progress, workers(count or 1, executor) as pool:
        found = average_velocity(
            rig.mechanism,
            law,
            axes,
            coordinate=coordinate,
            cycles=cycles,
            settle=settle,
            y0=start,
            executor=pool or (Inline() if count == 1 else None),
            progress=progress,
        )
    _write(found, output, figure)
    turns = found.reversals().tolist() if len(found.axes) == 1 else []
    if as_json:
        head = {"rig": rig.heading, "digest": rig.digest}
        head |= friction_content(chosen, rig.mechanism)
        files = [str(output), str(figure)]
        print_json(document("sweep", head | _content(found, turns) | {"files": files}))
        return
    stdout().print(printable(rig.heading), markup=False, style="bold", end="")
    stdout().print(f", {friction_title(chosen)} friction", markup=False)
    _show(found, turns)
    stdout().print(f"\nWritten: {output}, {figure}", markup=False)


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


def _write(found: VelocityMap, output: Path, figure: Path) -> None:
    from stickslip.plots import draw_velocity_map, standalone_svg

    svg = standalone_svg(draw_velocity_map(found), size=SIZE, title="Mean velocity")
    units = {**found.units, "period": "s", "velocity": found.unit, "unsettled": found.unit}
    table = table_bytes(found.to_dataframe(), output, units)
    write_files({output: table, figure: svg})


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


def _axes(vary: Sequence[str]) -> dict[str, "np.typing.NDArray[np.float64]"]:
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
