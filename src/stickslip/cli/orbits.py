"""``stickslip orbits``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from stickslip.cli.console import print_json, refuse_inputs, refuse_overwriting, show_table, stdout
from stickslip.cli.law_choice import friction_content, friction_of, friction_title, rig_and_friction
from stickslip.cli.options import LawOptions
from stickslip.cli.progress import Drawing
from stickslip.cli.simulate import check_table, table_bytes
from stickslip.documents import document, write_files
from stickslip.errors import InputError
from stickslip.formatting import number, printable, quantity
from stickslip.sweep import OrbitDiagram, orbit_diagram

SIZE = (880, 400)


def run(
    path: Path | None,
    changes: Sequence[str],
    asked: LawOptions,
    vary: str,
    cycles: int,
    values: int,
    settle: int,
    output: Path,
    *,
    allow_import: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Find the branches, write table and figure, show."""
    check_table(output)
    figure = output.with_suffix(".svg")
    for file in (output, figure):
        refuse_overwriting(file, output.parent, force=force)
    name, between = _range(vary)
    rig, chosen = rig_and_friction(path, changes, asked, allow_import=allow_import)
    refuse_inputs(output, rig.files)
    law = friction_of(chosen)
    with Drawing("Running", "values") as progress:
        found = orbit_diagram(
            rig.mechanism,
            law,
            name,
            between,
            cycles=cycles,
            values=values,
            settle=settle,
            y0=rig.start(law),
            progress=progress,
        )
    _write(found, output, figure)
    if as_json:
        head = {"rig": rig.heading, "digest": rig.digest}
        head |= friction_content(chosen, rig.mechanism)
        files = [str(output), str(figure)]
        print_json(document("orbits", head | _content(found) | {"files": files}))
        return
    stdout().print(printable(rig.heading), markup=False, style="bold", end="")
    stdout().print(f", {friction_title(chosen)} friction", markup=False)
    _show(found)
    stdout().print(f"\nWritten: {output}, {figure}", markup=False)


def _content(found: OrbitDiagram) -> dict[str, Any]:
    return {
        "path": found.path,
        "unit": found.unit,
        "branches": [
            {
                "cycles": branch.cycles,
                "values": branch.values.tolist(),
                "stable": branch.stable.tolist(),
                "mean_velocity": {
                    name: branch.mean_velocity(name).tolist() for name in branch.advances
                },
                "events": [
                    {"kind": event.kind, "value": event.value, "sentence": event.sentence}
                    for event in branch.events
                ],
                "ends": list(branch.ends),
            }
            for branch in found.branches
        ],
        "early_ends": list(found.early_ends()),
        "branch_cycles": found.branch_cycles,
        "brute_cycles": found.brute_cycles,
    }


def _write(found: OrbitDiagram, output: Path, figure: Path) -> None:
    from stickslip.plots import draw_orbits, standalone_svg

    svg = standalone_svg(draw_orbits(found), size=SIZE, title="Periodic orbits")
    units = {**found.units, found.path: found.unit, "period": "s"}
    units |= {f"advance {name}": found.units[name] for name in found.velocities}
    write_files({output: table_bytes(found.to_dataframe(), output, units), figure: svg})


def _show(found: OrbitDiagram) -> None:
    rows, events = [], []
    for index, branch in enumerate(found.branches):
        low, high = float(branch.values.min()), float(branch.values.max())
        span = f"{number(low, 6)} to {quantity(high, found.unit, 6)}"
        stable = f"{int(branch.stable.sum())} of {len(branch.values)}"
        rows.append([str(index), str(branch.cycles), span, stable])
        events += [
            [str(index), quantity(event.value, found.unit, 6), event.kind, event.sentence]
            for event in branch.events
        ]
    name = found.path.rpartition(".")[2]
    if rows:
        show_table("Branches of periodic orbits", ["branch", "period", name, "stable"], rows)
    if events:
        show_table("What changes along them", ["branch", name, "event", "what changes"], events)
    ends = [
        f"Branch {index}: {end}"
        for index, branch in enumerate(found.branches)
        for end in dict.fromkeys(branch.ends)
        if not end.startswith("It reaches")
    ]
    for sentence in (*ends, *found.costs()):
        stdout().print(sentence, markup=False)


def _range(text: str) -> tuple[str, tuple[float, float]]:
    """Read ``path=low:high``."""
    path, _, span = text.partition("=")
    try:
        low, high = map(float, span.split(":"))
    except ValueError:
        low, high = 0.0, 0.0
    if not path.strip() or not low < high:
        raise InputError(
            "--vary takes PATH=LOW:HIGH in SI units, the lower value first, such as"
            f" drive.frequency=2:20, got {text!r}."
        )
    return path.strip(), (low, high)
