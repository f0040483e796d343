"""Animations of runs: a scene to scale beside time plots, as GIF or MP4."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stickslip.documents import unwritable
from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism, slipping
from stickslip.plots.animation.animation_frame import Stage, moments_of
from stickslip.plots.animation.scenes.shapes import Drawn, Scene
from stickslip.plots.animation.video_encoding import ENCODERS, Encoder, encoder_of
from stickslip.plots.core.arguments import check_scene, check_size, file_of, number
from stickslip.plots.core.helpers import horizon
from stickslip.plots.core.svg import Draw, Size
from stickslip.plots.core.theme import SURFACE, house_style
from stickslip.trajectory import Trajectory

ANIMATION_SIZE: Final[Size] = (880, 400)
NARROWEST: Final = 620.0
"""Below this width the scene stands above the time plots [CSS px]."""
MOST_FRAMES: Final = 2000
FASTEST: Final = 50.0
"""Frames a second that browsers show of a GIF."""

Pixels: TypeAlias = NDArray[np.uint8]


def draw_scene(
    run: Trajectory, mechanism: Drawn, t: float, *, scene: Scene[Drawn] | None = None
) -> Draw:
    """Return a drawing of a mechanism at one moment of a run, beside its time plots.

    Parameters
    ----------
    run : Trajectory
        The run.
    mechanism : Mechanism
        What moves in it.
    t : float
        The moment [s].
    scene : callable, optional
        How it is drawn, if not as `stickslip.plots.animation.scenes.scene_of` says.

    Returns
    -------
    callable
        Draws it, as `stickslip.plots.save` and `standalone_svg` take it.

    Raises
    ------
    InputError
        If an argument cannot be used, or the run is not one of the mechanism.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> from stickslip.plots import standalone_svg
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> "slip forward" in standalone_svg(draw_scene(run, rig, 0.1), size=(880, 400))
    True
    """
    check_scene(run, mechanism, scene)
    number("t", t)
    first, last = run.span
    if not first <= t <= last:
        raise InputError(f"t must lie between {first:g} and {last:g} s, got {t:g} s.")

    def draw(figure: Figure, narrow: bool) -> None:
        stage = Stage(figure, run, mechanism, until=last, scene=scene, narrow=narrow)
        stage.show(moments_of(run, mechanism, np.array([t]))[0])

    return draw


def picture_of(run: Trajectory, mechanism: Drawn, t: float, *, size: Size) -> Pixels:
    """Return what `draw_scene` draws as a picture (height, width, 3) in RGB."""
    check_scene(run, mechanism)
    (pixels,) = frames(run, mechanism, np.array([t]), size=size, dpi=72.0, scene=None)
    return pixels


def animate(
    run: Trajectory,
    mechanism: Drawn,
    path: str | Path,
    *,
    fps: float = 25.0,
    speed: float = 1.0,
    until: float | None = None,
    size: Size = ANIMATION_SIZE,
    dpi: float = 72.0,
    scene: Scene[Drawn] | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Path | None:
    """Write an animation of a run as a GIF or MP4 file, chosen by the ending of its name.

    The mechanism is drawn to scale, the body that rubs in the colour of stick or slip, forces as
    arrows of one scale, beside displacement, velocity and friction with a cursor that moves.

    Parameters
    ----------
    run : Trajectory
        The run.
    mechanism : Mechanism
        What moves in it.
    path : str or Path
        The file; it appears whole or not at all, and replaces one that is there. MP4 needs the
        program ``ffmpeg``.
    fps : float
        Frames a second, at most 50 for a GIF.
    speed : float
        Seconds of the run in a second of the animation: 0.1 is slow motion.
    until : float, optional
        Last time shown [s]; if not given the end of the run, or some time after the body has
        arrived.
    size : tuple of float
        Width and height [CSS px]; below a width of 620 the scene stands above the time plots.
    dpi : float
        Resolution: 72 makes a pixel of each CSS pixel, 144 four.
    scene : callable, optional
        How the mechanism is drawn, if not as `stickslip.plots.animation.scenes.scene_of` says.
    progress : callable, optional
        Called with the number of frames done and of all; if it returns False, nothing is written.

    Returns
    -------
    Path or None
        The file, None if it was cancelled.

    Raises
    ------
    InputError
        If an argument cannot be used, the run is not one of the mechanism, or there is no
        ``ffmpeg``.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=2.0, y0={"theta": 0.5})
    >>> path = animate(run, clock, "clock.gif", fps=5, size=(600, 520))  # doctest: +SKIP
    """
    check_scene(run, mechanism, scene)
    path = file_of(path)
    encoder = encoder_of(path)
    _check(encoder, fps=fps, size=size, dpi=dpi)
    times = frame_times(run, mechanism, fps=fps, speed=speed, until=until)
    done = 0

    def told() -> Iterator[Pixels]:
        nonlocal done
        for pixels in frames(run, mechanism, times, size=size, dpi=dpi, scene=scene):
            yield pixels
            done += 1
            if progress is not None and progress(done, len(times)) is False:
                return

    beside = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        encoder.write(told(), beside, fps)
        if done < len(times):
            return None
        beside.replace(path)
    except OSError as error:
        raise unwritable(path, error) from error
    finally:
        beside.unlink(missing_ok=True)
    return path


def frame_times(
    run: Trajectory, mechanism: Mechanism, *, fps: float, speed: float, until: float | None = None
) -> NDArray[np.float64]:
    """Return the times of the frames of an animation [s]: evenly spaced, the start among them.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=2.0, y0={"theta": 0.5})
    >>> frame_times(run, clock, fps=4.0, speed=0.5).size
    17
    """
    check_scene(run, mechanism)
    number("fps", fps)
    number("speed", speed)
    first, last = run.span
    if until is not None:
        number("until", until)
        if not first < until <= last:
            raise InputError(f"until must lie between {first:g} and {last:g} s, got {until:g} s.")
        last = until
    else:
        last = max(horizon(run, slip) for slip in slipping(mechanism))
    for name, unit, value in (("fps", "1/s", fps), ("speed", "1", speed)):
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{name} [{unit}] must be above 0, got {value:g}.")
    count = math.floor((last - first) * fps / speed * (1.0 + 1e-12)) + 1
    if count > MOST_FRAMES:
        raise InputError(
            f"{count} frames are more than {MOST_FRAMES}: show less of the run by `until`, or raise"
            f" `speed` from {speed:g}, or lower `fps` from {fps:g}."
        )
    times: NDArray[np.float64] = np.minimum(first + np.arange(count) * speed / fps, last)
    return times


def frames(
    run: Trajectory,
    mechanism: Mechanism,
    times: NDArray[np.float64],
    *,
    size: Size,
    dpi: float,
    scene: Scene | None,
) -> Iterator[Pixels]:
    """Yield pictures (height, width, 3) of a run at some times."""
    with house_style():
        figure = Figure(figsize=(size[0] / 72, size[1] / 72), dpi=dpi, layout="constrained")
        figure.set_facecolor(SURFACE)
        canvas: Any = FigureCanvasAgg(figure)  # half of it has no types
        stage = Stage(
            figure,
            run,
            mechanism,
            until=float(times[-1]) if times.size > 1 else run.span[1],
            scene=scene,
            narrow=size[0] < NARROWEST,
            digits=_digits(times),
        )
    moments = moments_of(run, mechanism, times)
    background = None
    for moment in moments:
        with house_style():  # not across a yield: others may draw in between
            moving = stage.show(moment)
            if background is None:
                # what does not move is drawn once, which makes frames several times cheaper
                for artist in moving:
                    artist.set_animated(True)
                canvas.draw()
                background = canvas.copy_from_bbox(figure.bbox)
            canvas.restore_region(background)
            for artist in moving:
                artist.set_animated(True)
                figure.draw_artist(artist)
            pixels = np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
        yield pixels


def _digits(times: NDArray[np.float64]) -> int:
    """Return decimals that tell neighbouring frames apart."""
    step = float(times[1] - times[0]) if times.size > 1 else 1.0
    return max(0, math.ceil(-math.log10(step) - 1e-9)) if step < 1.0 else 2


def _check(encoder: Encoder, *, fps: float, size: Size, dpi: float) -> None:
    number("fps", fps)
    number("dpi", dpi)
    check_size(size)
    if encoder is ENCODERS[".gif"] and fps > FASTEST:
        raise InputError(
            f"a GIF shows at most {FASTEST:g} frames a second, got fps={fps:g}; write an .mp4."
        )
    if not (min(size) >= 200 and max(size) * dpi / 72 <= 8000):
        raise InputError(
            f"size must be at least 200 by 200 px and, times dpi / 72, at most 8000 px, got"
            f" {size[0]:g} by {size[1]:g} px at {dpi:g} dpi."
        )
