"""Draw the figures of the README and of the documentation, and make the record of the README.

``python docs/make_figures.py`` makes all of them, ``python docs/make_figures.py cart`` one.
"""

import ast
import math
import re
import sys
import textwrap
import tomllib
from collections.abc import Collection, Sequence
from pathlib import Path

import grimp
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch
from matplotlib.path import Path as MplPath

import stickslip
from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    CoulombViscous,
    FixedStep,
    PendulumCart,
    animate,
    load_measurement,
    load_rig,
    select,
    simulate,
)
from stickslip.mechanisms import Prescribed, Torque
from stickslip.mechanisms.drives import Sampled, Sine, ThreePhase
from stickslip.show.plots import (
    C1,
    DATA,
    INK,
    MUTED,
    SURFACE,
    Draw,
    Size,
    standalone_svg,
)
from stickslip.show.plots.runs import LOOP_SIZES, draw_closed_loop
from stickslip.show.plots.studies import draw_fixed_steps
from stickslip.show.plots.sweep_maps import draw_velocity_map
from stickslip.study.control import PID, closed_loop
from stickslip.study.sweep import average_velocity

FOLDER = Path(__file__).parent / "figures"
FILES = Path(__file__).parent / "howto" / "files"
TABLE = FILES / "friction.csv"
"""The table of the README: synthetic, 4 N and 30 N s/m."""
RECORD = FILES / "axis.csv"
"""The record of "My CSV in five commands": synthetic, so that the true values are known."""
PAD = 16
"""Of the card around a figure, which keeps it readable on dark pages [CSS px]."""


def card(name: str, draw: Draw, size: Size, title: str) -> None:
    """Save a figure on a card with round corners."""
    svg = standalone_svg(draw, size=size, title=title)
    width, height = size[0] + 2 * PAD, size[1] + 2 * PAD
    rest = svg[svg.index(">") + 1 :]
    head = svg[: svg.index(">") + 1]
    for key, value in (("width", width), ("height", height)):
        head = re.sub(rf' {key}="[^"]*"', f' {key}="{value:g}"', head)
    box = f"{-PAD} {-PAD} {width:g} {height:g}"
    head = re.sub(r'viewBox="[^"]*"', f'viewBox="{box}"', head)
    x, y, w, h = box.split()
    paper = f'<rect x="{x}" y="{y}" width="{w}" height="{h}" rx="8" fill="{SURFACE}"/>'
    (FOLDER / name).write_text(head + paper + rest, encoding="utf-8", newline="\n")


def chatter() -> None:
    """The stop of the block, event-driven and with a fixed step."""
    rig = load_rig()
    law = rig.laws["coulomb"]
    fixed = {
        "fixed step of 10 ms, no stick rule": FixedStep(dt=0.01, stick_rule=False),
        "fixed step of 1 ms, no stick rule": FixedStep(dt=0.001, stick_rule=False),
    }
    draw = draw_fixed_steps(
        simulate(rig.mechanism, law, t_end=1.0),
        {
            label: simulate(rig.mechanism, law, t_end=1.0, solver=solver)
            for label, solver in fixed.items()
        },
    )
    card(
        "chatter.svg",
        draw,
        (880, 260),
        "Velocity around the stop: the event-driven run ends at zero, fixed steps chatter",
    )


def reversal() -> None:
    """The direction of a vibro-impact capsule against the frequency of its drive."""
    capsule = Capsule(
        capsule_mass=0.8,
        inner_mass=0.2,
        stiffness=100.0,
        damping=0.3,
        upper_stop=0.02,
        restitution=0.6,
        drive=Torque(drive=Sine(amplitude=1.0, frequency=4.0)),
    )
    found = average_velocity(
        capsule,
        Coulomb(kinetic_coefficient=0.05),
        {"mechanism.drive.drive.frequency": np.linspace(2.5, 6.0, 141)},
    )
    card(
        "reversal.svg",
        draw_velocity_map(found),
        (800, 320),
        "Mean velocity of a capsule against the frequency of its drive: forward at resonance,"
        " backward above 4.42 Hz, none where the inner mass does not reach its stop",
    )


def hunting() -> None:
    """Integral action that hunts about its target, because rest holds more than sliding."""
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    pid = PID(proportional=100.0, integral=300.0, derivative=20.0, reference=0.1)
    loop = closed_loop(Axis(inertia=1.0), law, pid, period=5e-3, t_end=40.0)
    card(
        "hunting.svg",
        draw_closed_loop(loop, reference=0.1, level=1.5, since=2.0),
        LOOP_SIZES["wide"],
        "Position and command of an axis whose integral action hunts: it rests beside its target"
        " while the command grows to the break-away level, jumps past the target and rests again",
    )


def record() -> pd.DataFrame:
    """A carriage of 2.4 kg, its friction 4 N and 30 N s/m, an encoder with 20 um of noise."""
    time = np.arange(400) / 100
    force = (14.0 * np.sin(np.pi * time) + 6.0 * np.sin(3.2 * np.pi * time)).round(3)
    drive = Sampled(times=tuple(time), values=tuple(force), hold="first")
    law = CoulombViscous(kinetic_coefficient=4.0, viscous_coefficient=30.0)
    run = simulate(Axis(inertia=2.4, drive=drive), law, t_end=float(time[-1]))
    noise = np.random.default_rng(0).normal(0.0, 2e-5, time.size)
    position = (1e3 * (run.at(time)["x"] + noise)).round(3)
    return pd.DataFrame({"time [s]": time, "position [mm]": position, "force [N]": force})


def axis_record() -> None:
    """Write the record of "My CSV in five commands"."""
    record().to_csv(RECORD, index=False, lineterminator="\n")


def report() -> None:
    """What `stickslip select` says of the table of the README, as its page shows it."""
    table = load_measurement(TABLE, columns={"velocity": "speed", "friction": "friction"})
    verdict = select(Axis(inertia=1.0), None, table)

    def draw(figure: Figure, _narrow: bool) -> None:
        figure.set_layout_engine("none")
        lines = textwrap.wrap(verdict.sentence, 88)
        figure.text(0.02, 0.97, "\n".join(lines), fontsize=13, weight="bold", color=INK, va="top")
        below = 0.955 - 0.048 * len(lines)
        lines = textwrap.wrap(verdict.words.lede, 105)
        figure.text(0.02, below, "\n".join(lines), fontsize=11, color=MUTED, va="top")
        verdict.plot(figure.add_axes((0.09, 0.11, 0.88, 0.57)))
        for k, one in enumerate(verdict.intervals):
            figure.text(
                0.13, 0.57 - 0.06 * k, str(one), fontsize=12, color=INK, va="top",
                bbox={"facecolor": SURFACE, "linewidth": 0, "pad": 2},
            )  # fmt: skip

    card(
        "report.svg",
        draw,
        (640, 480),
        "Verdict, friction with its band, and parameters, of five readings of friction",
    )


def cart() -> None:
    """A cart that a swinging pendulum drives forward, with its stick and slip."""
    swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    driven = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    )
    run = simulate(driven, Coulomb(kinetic_coefficient=0.2), t_end=3 * float(swing.period))
    animate(run, driven, FOLDER / "cart.gif", fps=15, speed=0.5, size=(800, 340))


BOXES = (
    # centre, text, whether it is a question
    (130, 32, "record and mechanism", False),
    (130, 115, "A table, or one coordinate that\na measured force drives?", True),
    (430, 115, "Posterior of the force balance,\nor of the table, with that law", False),
    (130, 220, "A voltage of unknown motor,\nor a drive of its own", False),
    (430, 220, "Posterior about runs that follow\nthe record, with friction beside", False),
    (733, 115, "Estimates, band, limitations:\nas in a selection", False),
)
WIDTH, LINE, ROUND = 212, 15, 14
"""Width of a box, height of its lines, and what is left above and below them."""
ARROWS = (
    # from one box to another, by their places above, and the answer that leads there
    (0, 1, ""), (1, 2, "yes"), (1, 3, "no"), (3, 4, ""), (2, 5, ""), (4, 5, ""),
)  # fmt: skip


JUDGED = (
    (130, 40, "Measurement and mechanism:\nrows, columns of all laws", False),
    (
        130,
        130,
        "Beside every law, with priors:\ndrift, runs, delay, turns, ...;\nwhat no law describes",
        False,
    ),
    (130, 230, "No drive? Then runs of each\nlaw, with start and length free", True),
    (430, 40, "Scales on a grid, best first:\none factor for all laws", False),
    (430, 130, "Probabilities of\nlaws and scales", False),
    (430, 230, "Odds of friction below 100 : 1?\nThen no law is recommended", True),
    (733, 40, "600 draws: the band, readings,\nanother run or specimen", False),
    (733, 130, "Each draw on each law: ladder,\nname, parameters", False),
    (733, 230, "Measure next: what takes most\noff the variance of the band", False),
)
JUDGED_ARROWS = (
    (0, 1, ""), (1, 2, ""), (2, 3, ""), (3, 4, ""), (4, 5, ""), (4, 6, ""), (6, 7, ""), (7, 8, ""),
)  # fmt: skip


def judge() -> None:
    """How a law is chosen and a band is made."""
    chart(
        "judge.svg",
        JUDGED,
        JUDGED_ARROWS,
        275,
        "Flow chart: a measurement becomes columns of laws and of what every experiment may have;"
        " scales are visited best first; probabilities of laws give draws, which give band, ladder,"
        " parameters and advice",
    )


def choices() -> None:
    """How the problem of a fit is chosen."""
    chart(
        "choices.svg",
        BOXES,
        ARROWS,
        265,
        "Flow chart: tables and records of a driven coordinate go to the posterior of the force"
        " balance; records under a voltage, or of a drive of its own, to that about runs",
    )


def chart(
    name: str,
    boxes: Sequence[tuple[int, int, str, bool]],
    arrows: Sequence[tuple[int, int, str]],
    height: int,
    title: str,
) -> None:
    """Draw boxes with arrows between them; questions are round."""

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(20, 860), ylim=(height, 5))
        axes.axis("off")
        halves = []
        for x, y, text, asked in boxes:
            lines = text.split("\n")
            half = 0.5 * (LINE * len(lines) + ROUND)
            halves.append(half)
            style = "round,pad=0,rounding_size=7" if asked else "square,pad=0"
            corner = (x - 0.5 * WIDTH, y - half)
            axes.add_patch(
                FancyBboxPatch(
                    corner, WIDTH, 2 * half, boxstyle=style, fc="none", ec=C1 if asked else DATA
                )
            )
            # each line is a text of its own: only those stay centred in other fonts
            for k, line in enumerate(lines):
                place = y + LINE * (k - 0.5 * (len(lines) - 1))
                axes.text(x, place, line, ha="center", va="center_baseline", fontsize=11)
        into = [to for _, to, _ in arrows]
        for k, (first, to, word) in enumerate(arrows):
            (x, y), (to_x, to_y) = boxes[first][:2], boxes[to][:2]
            if x == to_x:
                start, end = (x, y + halves[first]), (x, to_y - halves[to])
            else:  # what meets at one box is spread along its side
                shift = 9.0 * (into[:k].count(to) - 0.5 * (into.count(to) - 1))
                start, end = (x + 0.5 * WIDTH, y), (to_x - 0.5 * WIDTH, to_y + shift)
            look = {"arrowstyle": "->", "color": DATA, "shrinkA": 0, "shrinkB": 0}
            axes.annotate("", end, start, arrowprops=look)
            if word:
                place = (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1]))
                aside = (8, 0) if x == to_x else (0, -11 if end[1] <= start[1] else 13)
                axes.text(
                    place[0] + aside[0], place[1] + aside[1], word, fontsize=10,
                    ha="left" if x == to_x else "center", va="center_baseline",
                )  # fmt: skip

    card(name, draw, (840, height - 5), title)


PACKAGE = Path(stickslip.__file__).parent
FIGURES = ("show.plots", "show.report")
"""Of `show`, what stands above the rooms that it shows."""
ROW, LEFT, RIGHT, ARC = 50, 70, 760, 30
"""Height of the row of a room, ends of its box, and width of an arc to the next row [CSS px]."""


def imports_between_rooms() -> set[tuple[str, str]]:
    """Return which room imports from which other; figures and pages count as one of them."""
    graph = grimp.build_graph("stickslip", cache_dir=None)
    ends = {
        (room_of(module), room_of(other))
        for module in graph.modules
        for other in graph.find_modules_directly_imported_by(module)
    }
    return {(a, b) for a, b in ends if a and b and a != b}


def room_of(module: str) -> str:
    """Return the room of a module; empty for those beside the rooms."""
    room = module.partition(".")[2]
    if f"{room}.".startswith(tuple(f"{one}." for one in FIGURES)):
        return "figures"
    first = room.partition(".")[0]
    return first if (PACKAGE / first / "__init__.py").exists() and first else ""


def in_order(imports: Collection[tuple[str, str]]) -> list[str]:
    """Return the rooms from the top down: that of the contract, with `show` in its two places."""
    contracts = tomllib.loads((PACKAGE.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))
    layers = contracts["tool"]["importlinter"]["contracts"][0]["layers"]
    rooms = {room for ends in imports for room in ends}
    order = [one for one in (layer.strip("()") for layer in layers) if one in rooms]
    return [*order[: order.index("data")], "figures", *order[order.index("data") :], "show"]


def contents(room: str) -> str:
    """Return what a room says of itself at its door."""
    if room == "figures":
        return "Figures and pages."
    if room == "show":
        return "Numbers, tables and documents."
    text = ast.parse((PACKAGE / room / "__init__.py").read_text(encoding="utf-8"))
    return (ast.get_docstring(text) or "").partition("\n")[0]


def house() -> None:
    """The rooms and what they import: left out is what follows from other arrows."""
    imports = imports_between_rooms()
    order = in_order(imports)
    place = {room: k for k, room in enumerate(order)}
    down = {(a, b) for a, b in imports if place[a] < place[b]}
    below: dict[str, set[str]] = {}
    for room in reversed(order):
        next_ones = {b for a, b in down if a == room}
        below[room] = next_ones.union(*(below[one] for one in next_ones))
    arrows = [
        (a, b)
        for a, b in sorted(down)
        if not any(b in below[one] for c, one in down if c == a and one != b)
    ]
    upward = sorted(imports - down)
    height = ROW * len(order)

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(0, 840), ylim=(height, 0))
        axes.axis("off")
        for room, k in place.items():
            y, name = ROW * (k + 0.5), "show" if room == "figures" else room
            axes.add_patch(
                FancyBboxPatch(
                    (LEFT, y - 0.36 * ROW), RIGHT - LEFT, 0.72 * ROW, boxstyle="square,pad=0",
                    fc="none", ec=DATA,
                )
            )  # fmt: skip
            axes.text(LEFT + 10, y - 8, name, va="center", fontsize=11, weight="bold", color=INK)
            text = textwrap.shorten(contents(room), 92, placeholder=" ...")
            axes.text(LEFT + 10, y + 9, text, va="center", fontsize=9, color=INK)
        for side, ends, style, colour in ((RIGHT, arrows, "-", DATA), (LEFT, upward, ":", C1)):
            for a, b in ends:
                span = abs(place[a] - place[b])
                shift = 7 if place[a] < place[b] else -7
                start = side, ROW * (place[a] + 0.5) + shift
                end = side, ROW * (place[b] + 0.5) - shift
                bulge = (1 if side == RIGHT else -1) * ARC * span**0.75
                path = MplPath([start, (side + bulge, start[1]), (side + bulge, end[1]), end],
                               [1, 4, 4, 4])  # fmt: skip
                axes.add_patch(
                    FancyArrowPatch(path=path, arrowstyle="->", mutation_scale=9, ls=style,
                                    color=colour, fc="none")
                )  # fmt: skip

    card(
        "house.svg",
        draw,
        (840, height),
        "Ten rooms from the command line down to mechanisms; arrows between them lead down, dotted"
        " ones, which are exceptions, up",
    )


DRAWN = (house, choices, judge, reversal, chatter, hunting, axis_record, report, cart)
"""In the order in which they are made."""

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    known = {one.__name__: one for one in DRAWN}
    if unknown := sorted(set(sys.argv[1:]) - set(known)):
        sys.exit(f"Unknown: {', '.join(unknown)}. There are {', '.join(known)}.")
    for name in sys.argv[1:] or known:
        known[name]()
