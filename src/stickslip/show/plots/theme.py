"""The palette of every figure, the matplotlib settings that go with it, and checks of arguments.

A colour has one meaning throughout a report (chosen model, rival, measured, at rest). The
constants are the light palette itself, so a figure drawn with them is right in a file, a notebook
or on paper as it stands; `stickslip.show.plots.svg` replaces them by CSS variables where the page
decides between light and dark. No two may be equal, or that replacement could not tell them apart.
"""

import itertools
import math
import numbers
import os
import re
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Literal

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib import style
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import Collection
from matplotlib.colors import to_hex, to_rgba, to_rgba_array
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Annotation

from stickslip.engine.simulation import no_mechanism
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism

INK: Final = "#14191d"
"""Text, and lines that must stand out."""
MUTED: Final = "#5d6870"
"""Axes, ticks and asides."""
LINE: Final = "#e3e6e8"
"""Grid lines."""
DATA: Final = "#7d8990"
"""Measured points."""
C1: Final = "#0b62a8"
"""Chosen model."""
C2: Final = "#b84a00"
"""Reference or rival model, drawn dashed."""
C3: Final = "#00795a"
"""Third series."""
C4: Final = "#8a4a86"
"""Fourth series."""
STICK: Final = "#fff1c9"
"""Band of rest, or of what is undetermined."""
SLIP_BACK: Final = "#e6eef5"
"""Band of reverse travel, or of a measured range."""
SURFACE: Final = "#ffffff"
"""Paper: the inside of open markers."""

NAME_GAP: Final = 14.0
"""Least distance of names in a column [pt]."""
BAND: Final = 0.25
"""Share of the colour of a line in a band, on paper of the reader's colour."""
COLOURED: Final = ("color", "facecolor", "edgecolor", "markerfacecolor", "markeredgecolor")
"""Properties of artists that are colours."""
VARIABLES: Final = MappingProxyType(
    {
        INK: "ink",
        MUTED: "muted",
        LINE: "line",
        DATA: "data",
        C1: "c1",
        C2: "c2",
        C3: "c3",
        C4: "c4",
        STICK: "stick",
        SLIP_BACK: "slip-back",
        SURFACE: "surface",
    }
)
"""CSS variable of each colour, without its leading dashes."""

STYLE: Final[MappingProxyType[str, Any]] = MappingProxyType(
    {
        "svg.fonttype": "none",
        "svg.hashsalt": "stickslip",
        "pdf.fonttype": 42,
        "figure.dpi": 72,  # one unit of a drawing is then one CSS pixel
        "figure.facecolor": "none",
        "axes.facecolor": "none",
        "savefig.facecolor": "auto",
        "figure.constrained_layout.w_pad": 0.05,
        "figure.constrained_layout.h_pad": 0.05,
        "font.size": 11.5,
        "axes.titlesize": 11.5,
        "axes.titlelocation": "left",
        "axes.labelsize": 11.5,
        "xtick.labelsize": 11,
        "ytick.labelsize": 11,
        "axes.linewidth": 0.8,
        "lines.linewidth": 1.8,
        "lines.solid_capstyle": "round",
        "patch.linewidth": 0.8,
        "grid.linewidth": 0.8,
        "grid.color": LINE,
        "axes.axisbelow": True,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.edgecolor": MUTED,
        "axes.labelcolor": MUTED,
        "axes.titlecolor": INK,
        "xtick.color": MUTED,
        "ytick.color": MUTED,
        "text.color": INK,
        "patch.edgecolor": INK,
        "axes.prop_cycle": cycler(color=(C1, C2, C3, C4)),
        "legend.frameon": False,
        "axes.formatter.use_mathtext": False,
        "axes.formatter.useoffset": False,
    }
)
"""Settings of matplotlib for the figures of this package."""

_LETTERS: Final = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa"
    " lambda mu nu xi pi rho sigma tau upsilon phi chi psi"
    " omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"
)
GREEK: Final = frozenset(_LETTERS.split())
"""Letters that mathtext knows by these names."""
_SYMBOL: Final = re.compile(r"[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9_+-]+)?")
_LOCK: Final = threading.RLock()
_HELD: Final = threading.local()


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the house style, whatever the reader's own matplotlib settings are.

    matplotlib keeps its settings once per process; a lock keeps two threads from mixing theirs.

    Examples
    --------
    >>> import matplotlib as mpl
    >>> with house_style():
    ...     mpl.rcParams["axes.edgecolor"] == MUTED
    True
    """
    with _LOCK:
        if getattr(_HELD, "held", False):  # setting all again would take a tenth of an animation
            yield
            return
        _HELD.held = True
        try:
            with style.context(["default", dict(STYLE)]):
                yield
        finally:
            _HELD.held = False


FONT_SIZE: Final = float(STYLE["font.size"])
"""Size of letters of the house style [pt]."""
NARROW_WIDTH: Final = 358.0
"""Width of a narrow figure at that size [pt]; below, letters shrink with the figure."""
LEAST_FONT_SIZE: Final = 7.0
"""Size that journals still print [pt]."""
RELATIVE: Final = ("axes.titlesize", "axes.labelsize", "xtick.labelsize", "ytick.labelsize")
"""Sizes of the house style that go with that of letters."""
HEEDED: Final = (
    "axes.", "errorbar.", "figure.", "font.", "grid.", "hatch.", "image.", "legend.", "lines.",
    "mathtext.", "patch.", "scatter.", "text.", "xtick.", "ytick.",
)  # fmt: skip
"""Beginnings of the names of settings that say how a figure looks."""


@contextmanager
def readers_style(width: float | None = None) -> Iterator[Mapping[str, Any]]:
    """Draw in the house style, but for what the reader set; yield that.

    What differs from the defaults of matplotlib was set, by a style sheet, a file or a statement.
    Letters whose size was not set shrink with a figure whose width [pt] is less than that of a
    phone; without a width, on axes that have letters already, they have the reader's size.

    Examples
    --------
    >>> import matplotlib as mpl
    >>> with mpl.rc_context({"font.size": 8.0}), readers_style() as own:
    ...     own, mpl.rcParams["axes.labelsize"], mpl.rcParams["axes.edgecolor"] == MUTED
    ({'font.size': 8.0}, 8.0, True)
    """
    with _LOCK:
        if getattr(_HELD, "held", False):  # within a figure of ours, the reader has no say
            yield {}
            return
        defaults = mpl.rcParamsDefault
        names = [name for name in mpl.rcParams if name.startswith(HEEDED) and name in defaults]
        own: dict[str, Any] = {
            str(n): mpl.rcParams[n] for n in names if mpl.rcParams[n] != defaults[n]
        }
        size = mpl.rcParams["font.size"]
        if width is not None and "font.size" not in own:
            size = max(min(1.0, width / NARROW_WIDTH) * FONT_SIZE, LEAST_FONT_SIZE)
        sizes = {name: size / FONT_SIZE * STYLE[name] for name in RELATIVE}
        _HELD.held = True
        try:
            looks = dict(STYLE) | {"font.size": size} | sizes | own
            with style.context(["default", looks]):
                yield own
        finally:
            _HELD.held = False


def name_size() -> float:
    """Return the size of names beside curves [pt], which goes with that of letters."""
    size: float = 11.0 / FONT_SIZE * mpl.rcParams["font.size"]
    return size


def pixel_of(figure: Figure) -> float:
    """Return how many CSS pixels a dot of a figure is, where letters have the house's size."""
    pixel: float = 72.0 / figure.dpi * FONT_SIZE / mpl.rcParams["font.size"]
    return pixel


def restyle(artists: Iterable[Artist], own: Mapping[str, Any]) -> None:
    """Give artists that were drawn the colours and the width of lines that the reader set."""
    colours = _readers_palette(own)
    thicker = own.get("lines.linewidth", STYLE["lines.linewidth"]) / STYLE["lines.linewidth"]
    for artist in artists:
        if isinstance(artist, Line2D) and artist.axes is not None and artist in artist.axes.lines:
            artist.set_linewidth(thicker * artist.get_linewidth())
        if isinstance(artist, ScalarMappable) and artist.get_array() is not None:
            continue  # its colours are those of a map
        for name in COLOURED if colours else ():
            _recolour(artist, name, colours)


def _recolour(artist: Artist, name: str, colours: Mapping[str, tuple[float, ...]]) -> None:
    """Replace a colour of the palette; white is paper inside of shapes only."""
    get, put = (getattr(artist, f"{verb}_{name}", None) for verb in ("get", "set"))
    before = to_rgba_array(get()) if get is not None and put is not None else ()
    after = [
        (*colours[key][:3], setting[3])
        if (key := to_hex(setting)) in colours and (key != SURFACE or name.endswith("facecolor"))
        else tuple(setting)
        for setting in before
    ]
    if put is not None and not np.array_equal(after, before):
        put(after if isinstance(artist, Collection) else after[0])


def _readers_palette(own: Mapping[str, Any]) -> dict[str, tuple[float, ...]]:
    """Return what stands for each colour of the palette, as far as the reader set it."""
    result: dict[str, Any] = {}
    if "axes.prop_cycle" in own:
        cycle = own["axes.prop_cycle"].by_key().get("color", [])
        result |= dict(zip((C1, C2, C3, C4), itertools.cycle(cycle), strict=False)) if cycle else {}
    named = {INK: "text.color", MUTED: "axes.labelcolor", LINE: "grid.color"}
    result |= {colour: own[name] for colour, name in named.items() if name in own}
    if "axes.facecolor" in own:
        paper = np.array(to_rgba(own["axes.facecolor"]))
        result |= {SURFACE: paper}
        bands = {STICK: C2, SLIP_BACK: C1}
        shades = {band: np.array(to_rgba(result.get(line, line))) for band, line in bands.items()}
        result |= {band: paper + BAND * (line - paper) for band, line in shades.items()}
    return {colour: tuple(to_rgba(value)) for colour, value in result.items()}


def shade(axes: Axes, spans: Iterable[tuple[float, float]], *, colour: str = STICK) -> None:
    """Mark stretches of the horizontal axis, such as the times at rest, by a band behind all.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes = Figure().add_subplot()
    >>> shade(axes, [(0.0, 0.2), (0.2, 0.3), (0.8, 1.0)])
    >>> len(axes.patches)
    2
    """
    merged: list[list[float]] = []
    for low, high in sorted(spans):
        if merged and low <= merged[-1][1]:
            merged[-1][1] = max(high, merged[-1][1])
        else:
            merged.append([low, high])
    for low, high in merged:
        axes.axvspan(low, high, facecolor=colour, edgecolor="none", linewidth=0, zorder=0)


def label_at(
    axes: Axes,
    x: float,
    y: float,
    text: str,
    colour: str,
    *,
    offset: tuple[float, float] = (6, 0),
    align: Literal["left", "center", "right"] = "left",
) -> Annotation:
    """Name a curve beside it and in its colour, instead of in a legend.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> label_at(Figure().add_subplot(), 1.0, 0.5, "Coulomb", C1).get_color() == C1
    True
    """
    return axes.annotate(
        text,
        (x, y),
        xytext=offset,
        textcoords="offset points",
        color=colour,
        fontsize=name_size(),
        ha=align,
        va="center",
        annotation_clip=False,
    )


def label_column(axes: Axes, x: float, labels: Sequence[tuple[float, str, str]]) -> None:
    """Name curves in a column where they end; names of curves that end close together move apart.

    Set the limits of the axes before.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes = Figure().add_subplot()
    >>> label_column(axes, 1.0, [(0.50, "Dahl", C1), (0.51, "LuGre", C2)])
    >>> [label.get_text() for label in axes.texts]
    ['Dahl', 'LuGre']
    """
    figure = axes.get_figure(root=True)
    if figure is None:
        raise InputError(
            "the axes were removed from their figure; label them before removing them."
        )
    lay_out(figure)
    pixel, point = pixel_of(figure), mpl.rcParams["font.size"] / FONT_SIZE
    wanted = [float(axes.transData.transform((x, y))[1]) * pixel for y, _, _ in labels]
    for (y, text, colour), old, new in zip(labels, wanted, spread(wanted, NAME_GAP), strict=True):
        label_at(axes, x, y, text, colour, offset=(6 * point, (new - old) * point))


def lay_out(figure: Figure) -> None:
    """Place the axes of a figure: the layout decides how many pixels a unit has."""
    engine = figure.get_layout_engine()
    if engine is None:
        figure.draw_without_rendering()  # axes of a given aspect take their place as they are drawn
    else:
        engine.execute(figure)


def spread(positions: Sequence[float], gap: float) -> list[float]:
    """Move positions apart, as little as possible in the least-squares sense, to a given gap.

    Examples
    --------
    >>> spread([1.0, 1.0, 9.0], 2.0)
    [0.0, 2.0, 9.0]
    """
    order = sorted(range(len(positions)), key=lambda i: (positions[i], i))
    # With the gaps taken off, the order need only not fall: isotonic regression, whose exact
    # solution is to pool neighbours that fall into their mean.
    pools: list[tuple[float, int]] = []
    for rank, index in enumerate(order):
        mean, count = positions[index] - rank * gap, 1
        while pools and pools[-1][0] >= mean:
            other, others = pools.pop()
            mean = (other * others + mean * count) / (others + count)
            count += others
        pools.append((mean, count))
    levels = [mean for mean, count in pools for _ in range(count)]
    placed = [0.0] * len(order)
    for rank, index in enumerate(order):
        placed[index] = levels[rank] + rank * gap
    return placed


def symbol_label(name: str) -> str:
    r"""Return a symbol for a figure, in mathtext: an italic letter with an upright subscript.

    Examples
    --------
    >>> symbol_label("mu_d"), symbol_label("F")
    ('$\\mu_{\\mathrm{d}}$', '$F$')
    """
    if not _SYMBOL.fullmatch(name):
        return name.replace("$", r"\$")
    letter, _, below = name.partition("_")
    if len(letter) > 1:
        letter = f"\\{letter}" if letter in GREEK else rf"\mathit{{{letter}}}"
    below = below.replace("_", ",")
    return rf"${letter}_{{\mathrm{{{below}}}}}$" if below else f"${letter}$"


# What is said of wrong arguments of plots and animations, before anything is drawn.


def check_scene(run: object, mechanism: object, scene: object = None) -> None:
    """Refuse what is no run, no mechanism or no scene, and a run of another mechanism.

    Mechanisms are told apart by their coordinates and rates; bristles of a law come after these.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=1.0, y0={"theta": 0.5})
    >>> check_scene(run, clock)
    """
    if not isinstance(run, Trajectory):
        raise InputError(f"run must be a Trajectory such as simulate returns, got {run!r}.")
    if not isinstance(mechanism, Mechanism):
        raise no_mechanism(mechanism)
    if scene is not None and not callable(scene):
        raise InputError(f"scene must be a function of axes, mechanism and run, got {scene!r}.")
    own = (*mechanism.coordinates, *mechanism.rates)
    # a run that was put together from columns does not say which of them are states
    states = run.states[: len(own)] if run.states else tuple(n for n in own if n in run.names)
    if states != own:
        raise InputError(
            f"the run is not a run of {type(mechanism).__name__}, whose states are"
            f" {', '.join(own)}: it has {', '.join(run.states or run.names)}; give the mechanism"
            " that was simulated."
        )


def file_of(path: object) -> Path:
    """Return the path of a file.

    Examples
    --------
    >>> file_of("cart.gif").suffix
    '.gif'
    """
    if not isinstance(path, (str, os.PathLike)):
        raise InputError(f"path must be the name of a file such as 'cart.gif', got {path!r}.")
    return Path(path)


def number(name: str, value: object) -> None:
    """Refuse what is no finite number.

    Examples
    --------
    >>> number("fps", 25)
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise InputError(f"{name} must be a finite number, got {value!r}.")


def check_size(size: object) -> None:
    """Refuse what is no width and height.

    Examples
    --------
    >>> check_size((880, 400))
    """
    if not isinstance(size, (tuple, list)) or len(size) != 2:
        raise InputError(f"size must be (width, height) in px such as (880, 400), got {size!r}.")
    for name, value in zip(("width", "height"), size, strict=True):
        number(f"size: {name}", value)


def check_type(name: str, value: object, *kinds: type) -> None:
    """Refuse an argument of another type.

    Examples
    --------
    >>> check_type("run", 3, Trajectory)
    Traceback (most recent call last):
    ...
    stickslip.errors.InputError: run must be a Trajectory, got 3.
    """
    if not isinstance(value, kinds):
        names = [kind.__name__ for kind in kinds]
        known = " or ".join(filter(None, [", ".join(names[:-1]), names[-1]]))
        article = "an" if names[0][0] in "AEIO" else "a"
        raise InputError(f"{name} must be {article} {known}, got {value!r}.")
