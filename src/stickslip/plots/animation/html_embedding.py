"""Animations inside HTML: a GIF of bounded size on screen, a still picture in print."""

import base64
import html
from typing import Final

import numpy as np

from stickslip.errors import InputError
from stickslip.plots.animation.animation import ANIMATION_SIZE, draw_scene, frame_times, frames
from stickslip.plots.animation.scenes.shapes import Drawn, Scene
from stickslip.plots.animation.video_encoding import gif_of
from stickslip.plots.core.svg import Size, standalone_svg
from stickslip.trajectory import Trajectory

MOST: Final = 1_500_000
"""Bytes of a GIF in a page, if nothing else is asked for."""
PHONE: Final = 620
"""Width of a window up to which the narrow animation is shown [CSS px]."""
SLOWEST: Final = 5.0
"""Frames a second below which a motion is no motion any more."""


def animation_html(
    run: Trajectory,
    mechanism: Drawn,
    *,
    alt: str,
    fps: float = 20.0,
    speed: float = 1.0,
    until: float | None = None,
    size: Size = ANIMATION_SIZE,
    narrow: Size | None = None,
    still: float | None = None,
    most_bytes: int = MOST,
    scene: Scene[Drawn] | None = None,
) -> str:
    """Return an animation of a run as HTML that needs no other file.

    The GIF stands in the page itself. If it is larger than `most_bytes` it is made again with fewer
    frames a second, at least 5. In print, and for readers who ask for less motion, a still picture
    stands in its place.

    Parameters
    ----------
    run : Trajectory
        The run.
    mechanism : Mechanism
        What moves in it.
    alt : str
        What is to be seen, for readers who cannot see it.
    fps : float
        Frames per second of the animation, as in `animate` [1/s].
    speed : float
        Seconds of the run per second of the animation.
    until : float, optional
        Last time shown [s]; if not given, as in `animate`.
    size : tuple of float
        Width and height [CSS px].
    narrow : tuple of float, optional
        Width and height of a second GIF, which phones show: there the scene stands above the plots.
    still : float, optional
        Time of the still picture [s]; the middle of what is shown if not given.
    most_bytes : int
        Largest GIF of each size [bytes].
    scene : callable, optional
        How the mechanism is drawn, as in `animate`.

    Returns
    -------
    str
        One ``<figure>`` element.

    Raises
    ------
    InputError
        If the GIF is too large with 5 frames a second too, or an argument cannot be used.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=1.0, y0={"theta": 0.5})
    >>> page = animation_html(run, clock, alt="A pendulum swings", fps=5, size=(600, 520))
    >>> page[:7], "data:image/gif;base64," in page
    ('<figure', True)
    """
    if not alt.strip():
        raise InputError("an animation needs an `alt` text that says what it shows, got none.")

    def gif(shape: Size) -> bytes:
        rate = fps
        while True:
            times = frame_times(run, mechanism, fps=rate, speed=speed, until=until)
            pictures = frames(run, mechanism, times, size=shape, dpi=72.0, scene=scene)
            content = gif_of(pictures, rate)
            if len(content) <= most_bytes:
                return content
            if rate <= SLOWEST:
                raise InputError(
                    f"the animation has {len(content)} bytes with {rate:g} frames a second, more"
                    f" than most_bytes={most_bytes}: show less of the run by `until`, or raise"
                    " `speed`."
                )
            rate = max(SLOWEST, 0.8 * rate * most_bytes / len(content))

    content = gif(size)
    phone = None if narrow is None else gif(narrow)
    times = frame_times(run, mechanism, fps=fps, speed=speed, until=until)
    moment = float(np.median(times)) if still is None else still
    picture = standalone_svg(
        draw_scene(run, mechanism, moment, scene=scene), size=size, title=alt, narrow=size[0] < 620
    )
    return _figure(content, phone, picture, html.escape(alt, quote=True), size)


def _figure(gif: bytes, phone: bytes | None, still: str, alt: str, size: Size) -> str:
    moving, quiet = _data("gif", gif), _data("svg+xml", still.encode())
    small = ""
    if phone is not None:
        small = f'<source media="(max-width: {PHONE}px)" srcset="{_data("gif", phone)}">'
    return (
        '<figure class="animation"><picture>'
        f'<source media="print, (prefers-reduced-motion: reduce)" srcset="{quiet}">{small}'
        f'<img src="{moving}" alt="{alt}" width="{size[0]:g}" height="{size[1]:g}"'
        ' style="max-width:100%;height:auto">'
        "</picture></figure>"
    )


def _data(kind: str, content: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
