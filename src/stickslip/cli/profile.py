"""``stickslip profile optimise``."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

from stickslip.cli.console import (
    folder_of,
    note,
    print_json,
    refuse_overwriting,
    show_table,
    stdout,
)
from stickslip.cli.law_choice import (
    friction_content,
    friction_of,
    laws_drawn,
    rig_and_friction,
)
from stickslip.cli.numbers import range_of
from stickslip.cli.options import LawOptions, ProfileOptions
from stickslip.cli.process_pool import workers
from stickslip.cli.progress import Improving, Interrupts
from stickslip.documents import document, json_text, write_folder
from stickslip.errors import InputError, ParameterError
from stickslip.experiments import Rig, read_number
from stickslip.formatting import number
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism
from stickslip.optimisation import (
    GOALS,
    Limits,
    Margin,
    Optimum,
    ScoredMotion,
    optimise_profile,
    units_of_limits,
)
from stickslip.quantities import Quantity, fields_of, full_path, named, parameters

if TYPE_CHECKING:
    from stickslip.optimisation import GoalName, KindName

OPTIONS = {
    "rate": "--rate",
    "acceleration": "--acceleration",
    "effort": "--torque",
    "load_share": "--load-share",
    "back_slip": "--back-slip",
    "energy": "--energy",
}
"""Options by limit."""
FILES = {"rig.toml", "profile.svg", "optimum.json"}


def run(
    path: Path,
    settings: ProfileOptions,
    output: Path | None,
    *,
    force: bool,
    as_json: bool,
) -> None:
    """Search, write rig file, figure and numbers, print what was found."""
    folder = folder_of(output, "stickslip-profile", as_json=as_json)
    if folder is not None:
        refuse_overwriting(folder, folder, force=force, files=FILES)
    asked = LawOptions(law=settings.law, load=settings.load)
    rig, chosen = rig_and_friction(path, settings.changes or [], asked)
    laws = None
    if settings.draws is not None:
        laws, _ = laws_drawn(rig, chosen, asked, settings.draws, settings.seed)
    found = _found(rig, friction_of(chosen), laws, settings)
    head = {"rig": rig.heading, "digest": rig.digest}
    head |= friction_content(chosen, rig.mechanism)
    content = document("profile", head | found.to_dict())
    if folder is not None:
        write_folder(folder, _files(found, content))
    if as_json:
        print_json(content)
    else:
        _show(found)
        stdout().print(f"\nWritten: {folder} ({', '.join(sorted(FILES))})", markup=False)
    if found.cancelled:
        note("The search was stopped early; this is the best motion so far.")


def _found(
    rig: Rig,
    law: FrictionLaw | Laws,
    laws: Sequence[FrictionLaw] | None,
    settings: ProfileOptions,
) -> Optimum:
    """Search with a bar; Ctrl-C once ends the search."""
    goal = named(GOALS, settings.goal, "goal")
    limits = _limits(rig.mechanism, settings)
    interval = dict(_interval(rig.mechanism, law, text) for text in settings.interval or ())
    with (
        Interrupts() as interrupts,
        Improving(lambda best: f"{number(best, 5)} {goal.unit}", interrupts) as watch,
        workers(settings.count or 1, settings.executor) as executor,
    ):
        return optimise_profile(
            rig.mechanism,
            law,
            limits=limits,
            goal=cast("GoalName", settings.goal),  # names are checked where they are used
            kind=cast("KindName", settings.kind),
            interval=interval,
            scenarios=laws,
            quantile=_quantile(settings.quantile),
            knots=settings.knots,
            evaluations=settings.evaluations,
            seed=settings.seed,
            state=settings.resume,
            executor=executor,
            progress=watch,
        )


def _quantile(text: str) -> float | Literal["mean"]:
    if text == "mean":
        return "mean"
    try:
        return read_number(text, Quantity("quantile", low=0, high=1))
    except ParameterError as error:
        raise ParameterError(f"--quantile {error}") from None


def _limits(mechanism: Mechanism, settings: ProfileOptions) -> Limits:
    """Read the limits, each in its unit."""
    units, values = units_of_limits(mechanism), {}
    quantities = dict(fields_of(Limits))
    values["position"] = _position(settings, quantities.pop("position"), units["position"])
    for name, quantity in quantities.items():
        text: str | None = getattr(settings, name)
        if text is None:
            continue
        own = Quantity(
            quantity.symbol, units[name], low=quantity.low, high=quantity.high, above=quantity.above
        )
        try:
            values[name] = read_number(text, own)
        except ParameterError as error:
            raise ParameterError(f"{OPTIONS[name]} {error}") from None
    return Limits(**values)


def _position(settings: ProfileOptions, quantity: Quantity, unit: str) -> float:
    """Return the largest distance from the middle, by the option of its kind of motion."""
    of_angle = unit == "rad"
    option, wrong = ("--angle", "--stroke") if of_angle else ("--stroke", "--angle")
    text, other = settings.angle, settings.stroke
    if not of_angle:
        text, other = other, text
    if text is None or other is not None:
        what = "turns" if of_angle else "moves along a line, from end to end"
        got = "none of the two" if other is None else f"{wrong} {other}"
        raise InputError(f"give {option}: the inner body of this rig {what}; got {got}.")
    try:
        value = read_number(text, Quantity(quantity.symbol, unit, above=0))
    except ParameterError as error:
        raise ParameterError(f"{option} {error}") from None
    return value if of_angle else 0.5 * value


def _interval(
    mechanism: Mechanism, law: FrictionLaw | Laws, text: str
) -> tuple[str, tuple[float, float]]:
    """Read ``path=low..high``, with units or in SI."""
    path, equals, ends = text.partition("=")
    if not (equals and ".." in ends and path.strip()):
        raise InputError(
            "--interval takes PATH=LOW..HIGH such as friction.kinetic_coefficient=0.15..0.25,"
            f" got {text!r}."
        )
    known = {
        full: quantity
        for root, prefix in ((mechanism, "mechanism"), (law, "friction"))
        for full, quantity, _ in parameters(root, prefix)
    }
    full = full_path(path.strip(), known)
    return full, range_of(f"--interval {full}", ends, known[full])


def _files(found: Optimum, content: Mapping[str, Any]) -> dict[str, str | bytes]:
    from stickslip.plots import PROFILE_SIZES, draw_profile, standalone_svg

    figure = standalone_svg(draw_profile(found), size=PROFILE_SIZES["wide"])
    return {
        "rig.toml": found.to_toml(),
        "profile.svg": figure,
        "optimum.json": json_text(content),
    }


def _show(found: Optimum) -> None:
    console, goal = stdout(), found.goal
    title = f"\nBest {found.kind} motion: {goal.title} {number(found.value, 5)} {goal.unit}"
    console.print(title, markup=False, style="bold")
    if len(found.scenarios) > 1:
        console.print(f"Objective value: {found.scenarios.words}", markup=False)
    console.print("\n".join(filter(None, (str(found.profile), found.shortfall))), markup=False)
    console.print()
    rows = [
        [
            _limit_word(m),
            f"{number(m.reached, 5)}",
            f"{number(m.allowed, 5)}",
            f"{number(m.margin)}",
            m.unit,
        ]
        for m in found.margins
    ]
    show_table("", ["limit", "reached", "allowed", "left", "unit"], rows)
    console.print()
    others = [("three-phase, optimised", found.three_phase, found.factor)]
    others.append(("as given in the rig file", found.start, found.factor_over_start))
    shown = [_compared(name, judged, factor) for name, judged, factor in others]
    show_table("", ["compared with", f"{goal.title}, {goal.unit}", "factor", ""], shown)
    if found.best is found.start:
        how = "the motion as given"
    else:
        how = "refined locally" if found.polished else "from the evolution strategy"
    console.print(
        f"\n{found.evaluations} motions evaluated, seed {found.seed}, {how}; the run is certified.",
        markup=False,
    )


def _compared(name: str, judged: ScoredMotion | None, factor: float | None) -> list[str]:
    if judged is None:
        return [name, "", "", "none satisfies the limits"]
    remark = "" if judged.feasible else _broken(judged)
    return [
        name,
        f"{number(judged.value, 5)}",
        "" if factor is None else f"{number(factor, 4)}",
        remark,
    ]


def _broken(judged: ScoredMotion) -> str:
    """Say what a motion breaks."""
    if judged.early_end:
        return judged.early_end
    if not all(cycle.repeats for cycle in judged.cycles):
        return "its cycles are not periodic"
    names = [_limit_word(m) for m in judged.margins if m.margin < 0.0]
    return f"violates {', '.join(names)}"


def _limit_word(margin: Margin) -> str:
    """Return what a limit is of; the place of an inner mass is counted from its middle."""
    if margin.name == "position":
        return "angle" if margin.unit == "rad" else "half the stroke"
    return margin.name.replace("_", " ")
