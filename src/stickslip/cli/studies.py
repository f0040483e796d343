"""``stickslip sweep``, ``stickslip orbits`` and ``stickslip optimise``."""

import dataclasses
import itertools
import os
import time
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, TypeVar, cast

import numpy as np
import typer
from numpy.typing import NDArray

from stickslip.cli import console as terminal
from stickslip.cli import inputs
from stickslip.cli import options as option_groups
from stickslip.cli.console import note, print_json, stdout
from stickslip.cli.inputs import FILE, friction_title, rig_and_friction
from stickslip.cli.options import LawOptions, PaperOptions, SweepOptions
from stickslip.cli.progress import Drawing, Improving, Interrupts, Watching, workers
from stickslip.cli.simulate import check_table, table_bytes
from stickslip.data import Rig, load_rig, parse, read_bytes, read_number, settled_speed
from stickslip.engine.executors import Inline
from stickslip.engine.solver import (
    EventCount,
    EventTimes,
    Max,
    Mean,
    Min,
    Output,
    Samples,
    Sensitivity,
    path_units,
)
from stickslip.engine.solver import Final as Last
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError, ParameterError, UnknownNameError, check_size, concerning
from stickslip.friction import FrictionLaw, Laws
from stickslip.identify.kinds import PAGE
from stickslip.mechanisms import PendulumCart, slip_among
from stickslip.paper import PaperAudit, audit, paper_report, result_sections
from stickslip.paper.rigs import CART
from stickslip.quantities import Quantity, all_paths, full_path, parameters, vary
from stickslip.show import report as page
from stickslip.show.documents import document, json_text, write_files, write_folder
from stickslip.show.formatting import count, joined, number, printable, quantity
from stickslip.study import optimisation
from stickslip.study.sweep import (
    Campaign,
    CampaignRuns,
    Case,
    Estimate,
    Factor,
    Levels,
    Normal,
    OrbitChart,
    OrbitDiagram,
    SensitivityIndices,
    Uniform,
    VelocityBand,
    VelocityMap,
    average_velocity,
    orbit_chart,
    orbit_diagram,
    units_of_columns,
    velocity_band,
)
from stickslip.units import per_second

if TYPE_CHECKING:
    from stickslip.study.optimisation import GoalName


# ``stickslip paper``: published results, computed again.

# ``stickslip paper``.

DOCUMENT = "paper.json"


def run_paper(options: PaperOptions) -> None:
    """Recompute the paper, write the page, print Table II."""
    folder = terminal.folder_of(options.output, "stickslip-paper", as_json=options.as_json)
    if folder is not None:
        terminal.refuse_overwriting(folder, folder, force=options.force, files=(PAGE, DOCUMENT))
    cart = _cart(options.changes)
    with Watching(list(load_rig().laws), "Recomputing the paper:") as watch:
        result = audit(cart=cart, progress=watch)
    content = document("paper", result.to_dict())
    if options.as_json:
        terminal.print_json(content)
    else:
        _show(result)
    if folder is None:
        return
    files = {DOCUMENT: json_text(content)}
    kept = f"The numbers are in {folder / DOCUMENT}."
    drawn = partial(paper_report, result, command=terminal.command_line())

    def write(text: str | None) -> None:
        write_folder(folder, files if text is None else {PAGE: text} | files, stale=[PAGE])

    terminal.leave_unless_drawn(
        terminal.draw_page(folder, drawn, write, kept=kept, quiet=options.as_json)
    )


def _cart(changes: Sequence[str]) -> PendulumCart:
    """Return the cart with masses and swing from the command line."""
    quantities = {path: quantity for path, quantity, _ in parameters(CART, "cart")}
    values = {}
    for given, text in terminal.overrides(changes).items():
        path = full_path(given, quantities)
        with concerning(f"--set {given}"):
            values[path] = terminal.number_of(text, quantities[path])
    return vary(CART, "cart", values)


def _show(found: PaperAudit) -> None:
    """Print the tables of the page that have the results of the paper, ours beside."""
    shown = (page.Table, page.Subheading)
    for section in result_sections(found):
        terminal.stdout().print(f"\n{page.plain(section.heading)}", style="bold")
        terminal.show_blocks(block for block in section.blocks if isinstance(block, shown))


# ``stickslip sweep``, ``stickslip orbits`` and ``stickslip optimise``.

# ``stickslip sweep campaign.toml``: the file of a campaign, and its runs.

CANCELLED: Final = 130
OF_DESIGN: Final = ("design", "runs", "seed", "spread", "energy", "part")
KEYS: Final = ("rigs", "laws", "t_end", *OF_DESIGN, "factors", "outputs")
KINDS: Final[Mapping[str, type[Output]]] = {
    "final": Last,
    "max": Max,
    "min": Min,
    "mean": Mean,
    "samples": Samples,
    "event-times": EventTimes,
    "event-count": EventCount,
    "sensitivity": Sensitivity,
}
"""Outputs by the key that says of which state or event they are."""
FACTORS: Final[Mapping[str, type[Factor]]] = {"values": Levels, "mean": Normal, "low": Uniform}
"""Factors by the key that only they have, or have to have."""
T = TypeVar("T")
LISTS: Final = ("values", "times")
TIMES: Final = ("since", "last", "times")
TIME: Final = Quantity("t", "s")
SIZE: Final = (700, 320)


def _run_campaign(options: SweepOptions) -> None:
    """Read the file, make the runs that are missing, show what is there."""
    if unused := option_groups.typed(
        options, "law", "law_load", "changes", "coordinate", "draws", "energy"
    ):
        raise InputError(
            f"{unused[0]} applies to a rig file with --vary PATH=LOW:HIGH:N; a campaign file says"
            " rigs, laws and factors itself."
        )
    if options.rig is None:
        raise InputError("give a campaign file, or a rig file with --vary PATH=LOW:HIGH:N.")
    folder, count = options.output or Path("stickslip-campaign"), options.count
    plans, cases = _read(options.rig, allow_import=options.allow_import)
    if options.dry_run:
        shared = 1 if options.executor else count or os.cpu_count() or 1
        _show_estimate(plans.estimate(), cases, shared, as_json=options.as_json)
        return
    begun = time.perf_counter()
    with (
        Interrupts() as interrupts,
        Drawing("Running", "runs") as bar,
        workers(count or 1, options.executor) as pool,
    ):
        interrupts.promise = "Stopping after the files in work; press Ctrl-C again to cancel."

        def progress(done: int, total: int) -> bool:
            bar(done, total)
            return not interrupts.stopped

        inline = Inline() if count == 1 else None
        result = plans.run(
            folder, executor=pool or inline, progress=progress, replace=options.force
        )
    took = time.perf_counter() - begun
    if not result.complete:
        note(f"{len(result)} of {len(plans)} runs are there: the same command goes on.")
        raise typer.Exit(CANCELLED)
    indices = _indices(plans, result, cases)
    if options.as_json:
        rows = {index.output: index.to_dataframe().to_dict("records") for index in indices}
        content = {
            "runs": len(result),
            "certified": result.certified,
            "status": result.status,
            "meaning": {name: Status[name].value for name in result.status},
            "files": len(result.parts),
            "bytes": result.size,
            "made": result.made,
            "seconds": took,
            "sensitivity": rows,
            "folder": str(folder),
        }
        print_json(document("campaign-runs", content))
        return
    for case in cases:
        stdout().print(case)
    terminal.show_summary(result.in_short())
    if result.made:
        rate = (
            f"{result.made:,} runs were made in {quantity(took, 's')}, {result.made / took:,.0f} a"
        )
        stdout().print(f"{rate} second.")
    for index in indices:
        stdout().print()
        terminal.show_summary(index.in_short())
    stdout().print(f"\nWritten: {folder}")


def _indices(
    plans: Campaign, found: CampaignRuns, cases: Sequence[str]
) -> list[SensitivityIndices]:
    """Return the indices of each output that is one number, and write them beside the runs."""
    if plans.whole.block == 1:
        return []
    if len(cases) > 1:
        note("Sensitivity indices are of one case: make a campaign of each.")
        return []
    import pandas as pd

    from stickslip.show.plots import draw_sensitivity, standalone_svg

    indices = []
    for name in plans.outputs or found.units:
        several = f"{name}.0" in found.units or name in plans.factors or name not in found.columns
        if several:
            continue
        try:
            indices.append(found.sensitivity(name))
        except InputError as error:
            note(str(error))
    if indices:
        table = pd.concat([index.to_dataframe().assign(output=index.output) for index in indices])
        size = (SIZE[0], SIZE[1] * len(indices))
        svg = standalone_svg(draw_sensitivity(indices), size=size, title="Sensitivity indices")
        rows = table[["output", *(column for column in table if column != "output")]]
        files = {"sensitivity.csv": rows.to_csv(index=False), "sensitivity.svg": svg}
        write_files({found.folder / name: content for name, content in files.items()})
    return indices


def _show_estimate(found: Estimate, cases: Sequence[str], shared: int, *, as_json: bool) -> None:
    if as_json:
        content = {**dataclasses.asdict(found), "workers": shared, "cases": [*cases]}
        print_json(document("campaign-estimate", content))
        return
    console = stdout()
    for case in cases:
        console.print(printable(case))
    console.print(
        f"{count(found.runs, 'run')} in {count(found.files, 'file')}, about"
        f" {quantity(found.size / 1e6, 'MB')};"
        f" about {quantity(found.seconds / shared, 's', 2)} on {count(shared, 'core')} like these."
    )


def _read(path: Path, *, allow_import: bool) -> tuple[Campaign, list[str]]:
    """Return the campaign of a file, and its cases in words."""
    file = str(path)
    raw = parse(read_bytes(path), file)
    if "mechanism" in raw:
        raise InputError(
            f"{file} is a rig file: say what varies, as --vary PATH=LOW:HIGH:N, or name it in a"
            ' campaign file, as rigs = "..." beside [factors].'
        )
    _known(raw, KEYS, file)
    rigs = _named(raw, "rigs", file)
    laws = _named(raw, "laws", file) if "laws" in raw else {"": ""}
    cases, titles = [], []
    for rig_name, rig_text in rigs.items():
        for law_name, law_text in laws.items():
            source = None if rig_text == "demo" else path.parent / rig_text
            law = str(path.parent / law_text) if FILE.fullmatch(law_text) else law_text
            options = LawOptions(rig=source, law=law or None, allow_import=allow_import)
            rig, chosen = rig_and_friction(options)
            friction = chosen.law
            labels = {"rig": rig_name} if len(rigs) > 1 else {}
            labels |= {"law": law_name} if len(laws) > 1 else {}
            last = _number(raw["t_end"], TIME, f"{file}: t_end") if "t_end" in raw else rig.t_end
            start = rig.start(friction)
            cases.append(
                Case(mechanism=rig.mechanism, law=friction, t_end=last, y0=start, labels=labels)
            )
            titles.append(f"{rig.heading}, {friction_title(chosen)} friction")
    campaign = Campaign(
        cases=tuple(cases),
        factors=_factors(raw.get("factors"), cases[0], file),
        outputs=_outputs(raw.get("outputs"), file),
        **{key: raw[key] for key in OF_DESIGN if key in raw},
    )
    return campaign, titles


def _known(table: object, known: Collection[str], where: str) -> None:
    """Refuse what is no table, and keys that are not known."""
    if not isinstance(table, dict):
        raise InputError(f"{where} must be a table, got {table!r}.")
    for key in table:
        if key not in known:
            raise UnknownNameError(f"key of {where}:", key, known)


def _named(raw: Mapping[str, Any], key: str, file: str) -> dict[str, str]:
    """Return files or names by what they are called: those given, or their own."""
    given = raw.get(key)
    if isinstance(given, str):
        given = [given]
    if isinstance(given, list) and given and all(isinstance(law, str) for law in given):
        given = {Path(law).stem if law.endswith(".toml") else law: law for law in given}
        if len(given) < len(raw[key]) and not isinstance(raw[key], str):
            raise InputError(f'{file}: {key} have equal names: give them as a = "...", b = "...".')
    if not (given and isinstance(given, dict) and all(isinstance(x, str) for x in given.values())):
        raise InputError(
            f"{file}: {key} must be a file or a name, a list of them, or a table of them, got"
            f" {given!r}."
        )
    return given


def _factors(table: object, case: Case, file: str) -> dict[str, Factor]:
    """Return what varies, by full path."""
    where = f"[factors] of {file}"
    if not isinstance(table, dict) or not table:
        raise InputError(
            f'{where} is missing: say what varies, such as "friction.kinetic_coefficient" ='
            " {low = 0.2, high = 0.3}."
        )
    varying = _varying(case)
    result = {}
    for name, given in _leaves(table):
        path = full_path(name, varying)
        known = varying[path]
        own: Any = given if isinstance(given, dict) else {"values": given}
        at = f"{name} in {where}"
        for key, kinds, said in (("times", str, "the path of a factor"), ("log", bool, "a bool")):
            if key in own and not isinstance(own[key], kinds):
                raise InputError(f"{at}: {key} must be {said}, got {own[key]!r}.")
        if own.get("times"):
            known = Quantity(known.symbol)
            own = {**own, "times": full_path(own["times"], varying)}
        wanted = dict.fromkeys(("values", "mean", "low", "high"), known)
        wanted["sd"] = Quantity(known.symbol, known.unit)
        needs = "values, or low and high, or mean and sd"
        result[path] = _made(FACTORS, own, at, needs, wanted)
    return result


def _made(
    kinds: Mapping[str, type[T]],
    given: Any,
    at: str,
    needs: str,
    numbers: Mapping[str, Quantity],
) -> T:
    """Return the dataclass that has a key of a table, of its fields, some of which are numbers.

    The key says which it is: the name of a field, or what stands for its first one.
    """
    kind = next((key for key in kinds if isinstance(given, dict) and key in given), None)
    if kind is None:
        raise InputError(f"{at} needs {needs}.")
    parts = dataclasses.fields(cast("Any", kinds[kind]))
    names = [part.name for part in parts]
    called = dict(zip(names if kind in names else [kind, *names[1:]], parts, strict=True))
    _known(given, called, at)
    needed = [key for key, part in called.items() if part.default is dataclasses.MISSING]
    if lacking := [key for key in needed if key not in given]:
        raise InputError(f"{at} lacks {' and '.join(lacking)}.")

    def read(key: str, value: Any) -> Any:
        if isinstance(value, list) and key in LISTS:
            return [read(key, item) for item in value]
        return _number(value, numbers[key], f"{at}: {key}") if key in numbers else value

    values = {called[key].name: read(key, value) for key, value in given.items()}
    try:
        return kinds[kind](**values)
    except (ParameterError, TypeError) as error:
        raise ParameterError(f"{at}: {error}") from None


def _varying(case: Case) -> dict[str, Quantity]:
    """Return what may vary, by full path; what was not given as well, as in `ensemble`."""
    roots = ((cast("Any", case.mechanism), "mechanism"), (cast("Any", case.law), "friction"))
    declared = {path: measured for root in roots for path, measured in all_paths(*root).items()}
    ranges = {path: known for root in roots for path, known, _ in parameters(*root)}
    units = path_units(case.mechanism, cast("Any", case.law))
    return declared | {
        path: ranges.get(path, Quantity(path.rpartition(".")[2], unit))
        for path, unit in units.items()
    }


def _leaves(table: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Return what stands at each dotted path, of which TOML makes tables without quotes."""
    result: list[tuple[str, Any]] = []
    for key, value in table.items():
        inner = (
            isinstance(value, dict) and value and all(isinstance(x, dict) for x in value.values())
        )
        result += _leaves(value, f"{prefix}{key}.") if inner else [(f"{prefix}{key}", value)]
    return result


def _number(value: object, known: Quantity, where: str) -> float:
    with concerning(where):
        return read_number(value, known)


def _outputs(table: object, file: str) -> dict[str, Output] | None:
    """Return what is kept of each run, by name."""
    if table is None:
        return None
    where = f"[outputs] of {file}"
    _known(table, table if isinstance(table, dict) else (), where)
    needs = f'one of {", ".join(KINDS)}, such as {{final = "x"}}'
    numbers = dict.fromkeys(TIMES, TIME)
    result: dict[str, Output] = {}
    for name, own in cast("dict[str, Any]", table).items():
        at = f"{name} in {where}"
        if isinstance(own, dict) and not isinstance(own.get("times", []), list):
            raise InputError(f"{at}: times must be a list, got {own['times']!r}.")
        result[name] = _made(KINDS, own, at, needs, numbers)
    return result


# ``stickslip sweep``, ``stickslip orbits`` and ``stickslip optimise``.

# ``stickslip sweep``.

Array = NDArray[np.float64]
MAP_SIZE = (800, 360)
MOST_AXES = 2
MOST_CASES = 200
"""Scenarios of a search."""


def _figure_beside(output: Path, *, force: bool) -> Path:
    """Return the figure beside a table; refuse what neither could be written to."""
    check_table(output)
    figure = output.with_suffix(".svg")
    for file in (output, figure):
        terminal.refuse_overwriting(file, output.parent, force=force)
    return figure


def run_sweep(options: option_groups.SweepOptions) -> None:
    """Run a campaign, or the grid: write table and figure, show."""
    if not options.vary:
        _run_campaign(options)
        return
    if options.dry_run:
        raise InputError("--dry-run applies to campaign files, not to --vary: leave it out.")
    output = options.output or Path("stickslip-sweep.csv")
    figure = _figure_beside(output, force=options.force)
    axes = _axes(options.vary)
    draws, count, executor = options.draws, options.count, options.executor
    unused = options.coordinate is not None or options.energy
    if draws is not None and (unused or len(axes) > 1):
        raise InputError("--ensemble takes one --vary, and no --coordinate or --energy.")
    if draws is not None and (count is not None or executor is not None):
        raise InputError("--ensemble runs in one process: leave --workers and --executor out.")
    rig, chosen = inputs.rig_and_friction(options)
    terminal.refuse_inputs(output, rig.files)
    law = chosen.law
    settings: dict[str, Any] = {"cycles": options.cycles, "settle": options.settle}
    settings["y0"] = rig.start(law)
    measured: list[tuple[float, float]] = []
    result: VelocityMap | VelocityBand
    if draws is not None:
        laws, settings["error"] = inputs.laws_drawn(
            rig, chosen, options.law_load, draws, options.seed
        )
        ((name, values),) = axes.items()
        measured = _filmed(rig, name, values)
        values = np.union1d(
            values, [at for at, _ in measured]
        )  # a curve with jumps tells nothing in between
        with Drawing("Running", "laws") as progress:
            result = velocity_band(
                rig.mechanism, laws, {name: values}, progress=progress, **settings
            )
        content = _band_content(result, laws, measured)
    else:
        with Drawing("Running", "runs") as progress, workers(count or 1, executor) as pool:
            result = average_velocity(
                rig.mechanism,
                law,
                axes,
                coordinate=options.coordinate,
                energy=options.energy,
                executor=pool or (Inline() if count == 1 else None),
                progress=progress,
                **settings,
            )
        content = _map_content(result)
    from stickslip.show.plots import draw_velocity_band, draw_velocity_map, standalone_svg

    if isinstance(result, VelocityBand):
        drawing, ends = draw_velocity_band(result, measured), ("low", "median", "high")
        units = {result.path: result.unit, "laws": "1"} | dict.fromkeys(ends, result.velocity_unit)
    else:
        drawing = draw_velocity_map(result)
        units = {**result.units, "period": "s", "velocity": result.unit}
        units |= {"unsettled": result.unit, "spread": result.unit}
        units |= units_of_columns(result.energies, result.unit.removesuffix("/s"))
    svg = standalone_svg(drawing, size=MAP_SIZE, title="Mean velocity")
    write_files({output: table_bytes(result.to_dataframe(), output, units), figure: svg})
    if options.as_json:
        files = [str(output), str(figure)]
        terminal.print_json(
            document("sweep", inputs.rig_content(rig, chosen) | content | {"files": files})
        )
        return
    counts = [f"{name} {times}" for name, times in content.get("laws", {}).items()]
    drawn = f"laws drawn: {joined(counts)}"
    inputs.show_heading(rig, drawn if counts else f"{inputs.friction_title(chosen)} friction")
    terminal.show_summary(result.in_short())
    if isinstance(result, VelocityBand):
        _show_measured(result, measured)
    stdout().print(f"\nWritten: {output}, {figure}")


def _filmed(rig: Rig, name: str, values: Array) -> list[tuple[float, float]]:
    """Return values of a parameter within a range at which films were made, with their speeds."""
    known = {path: quantity for path, quantity, _ in parameters(rig.mechanism, "mechanism")}
    path, pairs = full_path(name, known), []
    for film in () if rig.measurement is None else rig.measurement.records():
        at = film.overrides.get(path)
        if at is not None and film.position is not None and values.min() <= at <= values.max():
            pairs.append((at, settled_speed(rig.mechanism, film)[0]))
    return pairs


def _band_content(
    found: VelocityBand, laws: Sequence[FrictionLaw], measured: Sequence[tuple[float, float]]
) -> dict[str, Any]:
    return {
        "path": found.path,
        "unit": found.unit,
        "values": found.values,
        **{end: getattr(found, end) for end in ("low", "median", "high")},
        "velocity_unit": found.velocity_unit,
        "level": found.level,
        "error": found.error,
        "laws": dict(Counter(law.name for law in laws)),
        "measured": measured,
        "early_ends": found.early_ends(),
    }


def _map_content(found: VelocityMap) -> dict[str, Any]:
    return {
        "axes": found.axes,
        **({"coordinate": found.coordinate} if found.coordinate else {}),
        "unit": found.unit,
        "velocity": found.velocity,
        "closes": found.closes,
        "spread": found.spread,
        "chaotic": found.chaotic,
        **({"energies": found.energies} if found.energies else {}),
        "status": found.status,
        "early_ends": found.early_ends(),
        "reversals": found.reversals() if len(found.axes) == 1 else [],
    }


def _show_measured(found: VelocityBand, measured: Sequence[tuple[float, float]]) -> None:
    ends = zip(found.low, found.high, strict=True)
    band = dict(zip(found.values.tolist(), ends, strict=True))
    seen = [(at, band[at][0] <= speed <= band[at][1]) for at, speed in measured]
    if seen:
        off = [number(at, 6) for at, inside in seen if not inside]
        where = f", not at {joined(off)} {found.unit}" if off else ""
        stdout().print(f"{len(seen) - len(off)} of {len(seen)} measured speeds lie in it{where}.")


def _few(vary: Sequence[str]) -> Sequence[str]:
    """Return what is varied, if that is one parameter or two."""
    if not 1 <= len(vary) <= MOST_AXES:
        raise InputError(f"--vary is given once or twice, got {len(vary)}.")
    return vary


def _axes(vary: Sequence[str]) -> dict[str, Array]:
    """Read ``path=low:high:n`` or ``path=[values]``, once or twice."""
    result = {}
    for text in _few(vary):
        path, numbers, listed = _numbers(text)
        values = np.unique(numbers) if listed else np.empty(0)
        if not listed and len(numbers) == 3 and numbers[2].is_integer():
            count = max(int(numbers[2]), 0)
            check_size(f"--vary {path}", count, "give fewer values")
            values = np.linspace(numbers[0], numbers[1], count)
        if not path or not values.size:
            raise InputError(
                "--vary takes PATH=LOW:HIGH:N or PATH=[VALUE, ...] in SI units, such as"
                " mechanism.drive.drive.frequency=1:6:50 or drive.frequency=[5.1, 7.3], got"
                f" {text!r}."
            )
        result[path] = values
    return result


def _numbers(text: str) -> tuple[str, list[float], bool]:
    """Read ``path=number:number`` or ``path=[numbers]``; return whether it is a list."""
    path, _, told = (part.strip() for part in text.partition("="))
    listed = told.startswith("[") and told.endswith("]")
    parts = told[1:-1].split(",") if listed else told.split(":")
    try:
        return path, [float(part) for part in parts], listed
    except ValueError:
        return path, [], listed


# ``stickslip orbits``.

DIAGRAM_SIZE = (880, 400)
CHART_SIZE = (880, 560)
ORBIT_VALUES, CHART_CELLS = 61, 40
"""Values at which runs settle, and cells of a chart along each parameter."""


def run_orbits(options: option_groups.OrbitOptions) -> None:
    """Find the branches or the chart, write table and figure, show."""
    from stickslip.show.plots import draw_orbit_chart, draw_orbits, standalone_svg

    output = options.output
    figure = _figure_beside(output, force=options.force)
    ranges = [_range(text) for text in _few(options.vary)]
    name, between, values = ranges[0]
    of_chart = len(ranges) > 1
    if of_chart and any(listed is not None for _, _, listed in ranges):
        raise InputError("--vary of a chart takes PATH=LOW:HIGH twice, got a list of values.")
    if of_chart and options.energy:
        raise InputError("--energy goes with one --vary: charts have no energies.")
    rig, chosen = inputs.rig_and_friction(options)
    terminal.refuse_inputs(output, rig.files)
    law, cells = chosen.law, options.values or CHART_CELLS
    with Drawing("Running", "lines" if of_chart else "values") as progress:
        shared: dict[str, Any] = {"cycles": options.cycles, "settle": options.settle}
        shared |= {"y0": rig.start(law), "progress": progress}
        if of_chart:
            box = {path: pair for path, pair, _ in ranges}
            result: OrbitChart | OrbitDiagram = orbit_chart(
                rig.mechanism, law, box, values=(cells, cells), **shared
            )
        else:
            count = (options.values or ORBIT_VALUES) if values is None else values
            result = orbit_diagram(rig.mechanism, law, name, between, values=count, **shared)
    drawing = draw_orbit_chart(result) if isinstance(result, OrbitChart) else draw_orbits(result)
    size = CHART_SIZE if of_chart else DIAGRAM_SIZE
    svg = standalone_svg(drawing, size=size, title="Periodic orbits")
    axes = (
        dict(zip(result.paths, result.parameter_units, strict=True))
        if isinstance(result, OrbitChart)
        else {result.path: result.unit}
    )
    units = {**result.units, **axes, "period": "s"}
    velocities = [*result.velocities]
    if isinstance(result, OrbitDiagram):
        velocities = [*{name for branch in result.branches for name in branch.advances}]
        table = result.to_dataframe(energy=options.energy)
        (travel, *_) = (*result.velocities, rig.mechanism.coordinates[0])
        units |= units_of_columns(map(str, table.columns), result.units[travel])
    else:
        table = result.to_dataframe()
    units |= {f"advance {name}": result.units[name] for name in velocities}
    units |= {f"mean velocity {name}": per_second(result.units[name]) for name in velocities}
    write_files({output: table_bytes(table, output, units), figure: svg})
    if options.as_json:
        own = _chart_content(result) if isinstance(result, OrbitChart) else _diagram_content(result)
        content = inputs.rig_content(rig, chosen) | own
        terminal.print_json(document("orbits", content | {"files": [str(output), str(figure)]}))
        return
    inputs.show_heading(rig, f"{inputs.friction_title(chosen)} friction")
    terminal.show_summary(result.in_short())
    stdout().print(f"\nWritten: {output}, {figure}")


def _chart_content(found: OrbitChart) -> dict[str, Any]:
    return {
        "axes": dict(zip(found.paths, found.axes, strict=True)),
        **{name: getattr(found, name) for name in ("count", "velocities", "lost")},
        "curves": [
            {
                **{name: getattr(curve, name) for name in ("kind", "cycles", "values", "ends")},
                "points": [
                    {name: getattr(p, name) for name in ("kind", "values", "sentence")}
                    for p in curve.points
                ],
            }
            for curve in found.curves
        ],
    }


def _diagram_content(found: OrbitDiagram) -> dict[str, Any]:
    return {
        "path": found.path,
        "unit": found.unit,
        "branches": [
            {
                "cycles": branch.cycles,
                "values": branch.values,
                "stable": branch.stable,
                "mean_velocity": {
                    name: branch.mean_velocity(name) for name in branch.map.mechanism.coordinates
                },
                "events": [
                    {name: getattr(event, name) for name in ("kind", "value", "sentence")}
                    for event in branch.events
                ],
                "ends": branch.ends,
            }
            for branch in found.branches
        ],
        "settled": {
            "values": found.values,
            "closes": found.settled,
            "chaotic": found.chaotic,
            "mean_velocity": found.velocities,
            "spread": found.spreads,
        },
        "early_ends": found.early_ends(),
        "branch_cycles": found.branch_cycles,
        "brute_cycles": found.brute_cycles,
    }


def _range(text: str) -> tuple[str, tuple[float, float], Array | None]:
    """Read ``path=low:high``, or ``path=[values]``, which says where runs settle, too."""
    path, numbers, listed = _numbers(text)
    low, high = (min(numbers), max(numbers)) if listed and numbers else (*numbers, 0.0, 0.0)[:2]
    if not path or not low < high or not (listed or len(numbers) == 2):
        raise InputError(
            "--vary takes PATH=LOW:HIGH, the lower value first, or PATH=[VALUE, ...], two or more,"
            " in SI units, such as drive.frequency=2:20 or drive.frequency=[5.1, 7.3], got"
            f" {text!r}."
        )
    return path, (low, high), np.array(numbers) if listed else None


# ``stickslip optimise``.

FILES = {"rig.toml", "optimum.svg", "optimum.json"}
INTERVAL_POINTS = 5
"""Values of an uncertain parameter from end to end."""


def run_optimise(options: option_groups.OptimiseOptions) -> None:
    """Search, write rig file, figure and numbers, print the best motions."""
    folder = terminal.folder_of(options.output, "stickslip-optimum", as_json=options.as_json)
    if folder is not None:
        terminal.refuse_overwriting(folder, folder, force=options.force, files=FILES)
    rig, chosen = inputs.rig_and_friction(
        option_groups.LawOptions(
            rig=options.rig, changes=options.changes, law=options.law, law_load=options.law_load
        )
    )
    law = chosen.law
    result = _optimum(rig, law, _scenarios(rig, chosen, law, options), options)
    content = document("optimum", inputs.rig_content(rig, chosen) | result.to_dict())
    if folder is not None:
        write_folder(folder, _files(result, content))
    if options.as_json:
        terminal.print_json(content)
    else:
        terminal.show_summary(result.in_short())
        terminal.stdout().print(f"\nWritten: {folder} ({', '.join(sorted(FILES))})")
    if result.cancelled:
        terminal.note("The search was stopped early; this is the best motion so far.")


def _optimum(
    rig: Rig,
    law: FrictionLaw | Laws,
    scenarios: Sequence[optimisation.Scenario] | None,
    options: option_groups.OptimiseOptions,
) -> optimisation.Optimum:
    """Search with a bar; Ctrl-C once ends the search."""
    mechanism = rig.mechanism
    known = optimisation.known_paths(mechanism, law)
    ends = dict(_ends("--vary", known, text) for text in options.vary)
    slip, _ = slip_among(
        mechanism, options.coordinate or optimisation.travelling(mechanism), "optimise"
    )
    units = optimisation.units_of(mechanism, slip)
    names = cast("list[GoalName]", [*options.goal])  # names are checked where they are used
    unit = units.get(names[0], "") if names else ""
    with (
        Interrupts() as interrupts,
        Improving(lambda best: f"{number(best, 5)} {unit}", interrupts) as watch,
        workers(options.count or 1, options.executor) as executor,
    ):
        return optimisation.optimise(
            mechanism,
            law,
            ends,
            goals=names,
            limits=dict(_limit(units, text) for text in options.limit),
            scenarios=scenarios,
            quantile=_quantile(options.quantile),
            coordinate=slip,
            evaluations=options.evaluations,
            seed=options.seed,
            executor=executor,
            progress=watch,
        )


def _scenarios(
    rig: Rig,
    chosen: inputs.ChosenLaw | inputs.ChosenLaws,
    law: FrictionLaw | Laws,
    options: option_groups.OptimiseOptions,
) -> Sequence[optimisation.Scenario] | None:
    """Return laws of an ensemble, or all combinations of values of uncertain parameters."""
    if options.draws is not None and options.interval:
        raise InputError("--ensemble and --interval are both given: leave one out.")
    if options.draws is not None:
        laws, _ = inputs.laws_drawn(rig, chosen, options.law_load, options.draws, options.seed)
        return laws
    if not options.interval:
        return None
    known = optimisation.known_paths(rig.mechanism, law)
    axes = dict(_ends("--interval", known, text) for text in options.interval)
    check_size("scenarios", INTERVAL_POINTS ** len(axes), "give fewer intervals", most=MOST_CASES)
    values = [np.linspace(*ends, INTERVAL_POINTS).tolist() for ends in axes.values()]
    return [dict(zip(axes, row, strict=True)) for row in itertools.product(*values)]


def _quantile(text: str) -> float | Literal["mean"]:
    if text == "mean":
        return "mean"
    with concerning("--quantile"):
        return read_number(text, Quantity("quantile", low=0, high=1))


def _ends(option: str, known: Mapping[str, Quantity], text: str) -> tuple[str, tuple[float, float]]:
    """Read ``path=low..high``, with units."""
    path, equals, ends = text.partition("=")
    if not (equals and ".." in ends and path.strip()):
        raise InputError(
            f"{option} takes PATH=LOW..HIGH such as mechanism.stiffness=10N/m..1kN/m, got {text!r}."
        )
    full = full_path(path.strip(), known)
    return full, terminal.range_of(f"{option} {full}", ends, known[full])


def _limit(units: Mapping[str, str], text: str) -> tuple[str, float]:
    """Read ``name=value``, with its unit."""
    name, equals, value = (part.strip() for part in text.partition("="))
    if not (equals and name and value):
        raise InputError(f"--limit takes NAME=VALUE such as xi=10mm, got {text!r}.")
    if name not in units:
        raise UnknownNameError("limit", name, [*units])
    with concerning(f"--limit {name}"):
        return name, read_number(value, Quantity(name, units[name], low=0))


def _files(found: optimisation.Optimum, content: Mapping[str, Any]) -> dict[str, str | bytes]:
    from stickslip.show.plots import draw_optimum, standalone_svg

    title = " and ".join(goal.title for goal in found.goals).capitalize()
    figure = standalone_svg(draw_optimum(found), size=MAP_SIZE, title=title)
    return {
        "rig.toml": found.to_toml(),
        "optimum.svg": figure,
        "optimum.json": json_text(content),
    }
