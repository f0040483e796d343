"""Animations of runs: frames as a GIF, an MP4, or inside HTML.

Frames are drawn once and then blitted: only what moves is painted anew. A GIF is written by Pillow,
an MP4 by ffmpeg, one picture after the other, so that no animation is held in memory.
"""

import base64
import contextlib
import html
import io
import itertools
import math
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Protocol, TypeAlias

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism, slipping
from stickslip.show.documents import unwritable
from stickslip.show.plots import theme
from stickslip.show.plots.animation.frame import Stage, moments_of
from stickslip.show.plots.animation.scenes import Drawn, Scene
from stickslip.show.plots.axes import horizon
from stickslip.show.plots.svg import Draw, Size, standalone_svg

# Pictures one after the other as a GIF, by Pillow, or as an MP4, by ffmpeg.

PAPERS: Final = (theme.SURFACE, theme.STICK, theme.SLIP_BACK)
INKS: Final = (theme.INK, theme.MUTED, theme.C1, theme.C2, theme.C3, theme.C4)
SHADES: Final = 9
"""Steps from each paper to each ink, for smooth edges. One palette for all frames makes a GIF a
fraction of the size: only what changes is kept of a frame."""


class Encoder(Protocol):
    """Writes pictures (height, width, 3) into a file."""

    def write(self, pictures: Iterator[Any], path: Path, fps: float) -> None:
        """Write them all, so many a second."""


@dataclass(frozen=True)
class Gif:
    """GIF by Pillow; durations are hundredths of a second, kept right on the whole."""

    def write(self, pictures: Iterator[Any], path: Path, fps: float) -> None:
        """Write them all, so many a second."""
        path.write_bytes(gif_of(pictures, fps))


def gif_of(pictures: Iterator[Any], fps: float) -> bytes:
    """Return pictures (height, width, 3) as a GIF that repeats itself, empty if there are none.

    Examples
    --------
    >>> import numpy as np
    >>> white = np.full((2, 3, 3), 255, dtype=np.uint8)
    >>> gif_of(iter([white, 0 * white]), 25.0)[:6]
    b'GIF89a'
    """
    from PIL import Image

    palette = Image.new("P", (1, 1))
    palette.putpalette(bytes(_palette()))
    frames = [
        Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE)
        for picture in pictures
    ]
    if not frames:
        return b""
    ends = [round(100.0 * (i + 1) / fps) for i in range(len(frames))]
    lengths = [10 * (b - a) for a, b in zip([0, *ends], ends, strict=False)]
    buffer = io.BytesIO()
    frames[0].save(
        buffer,
        format="GIF",
        save_all=True,
        append_images=frames[1:],
        duration=lengths,
        loop=0,
        optimize=True,
        disposal=1,
    )
    return buffer.getvalue()


def _palette() -> list[int]:
    """Return the colours of the theme and those between each paper and each ink, flat."""
    pairs = [(_rgb(paper), _rgb(ink)) for paper in PAPERS for ink in INKS]
    found = {
        tuple(round(a + (b - a) * step / (SHADES - 1)) for a, b in zip(paper, ink, strict=True))
        for paper, ink in pairs
        for step in range(SHADES)
    }
    found.add(_rgb(theme.LINE))  # too pale for shades, which would be taken for paper
    return [level for colour in sorted(found, reverse=True) for level in colour]


def _rgb(colour: str) -> tuple[int, ...]:
    return tuple(int(colour[i : i + 2], 16) for i in (1, 3, 5))


@dataclass(frozen=True)
class Mp4:
    """H.264 by the program ffmpeg, which reads raw pictures."""

    def write(self, pictures: Iterator[Any], path: Path, fps: float) -> None:
        """Write them all, so many a second."""
        first = next(pictures, None)
        if first is None:
            return
        height, width = first.shape[:2]
        command = [
            ffmpeg(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
            "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "-", "-an",
            # players want even sizes and this form of colours
            "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p",
            "-c:v", "libx264", "-movflags", "+faststart", str(path),
        ]  # fmt: skip
        with tempfile.TemporaryFile() as said:
            with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said) as process:
                try:
                    _feed(process, first, pictures)
                except BaseException:
                    process.kill()
                    raise
            if process.returncode:
                said.seek(0)
                words = said.read().decode(errors="replace").strip() or "no message"
                raise InputError(f"ffmpeg could not write {path.name}: {words}")


def _feed(process: "subprocess.Popen[bytes]", first: Any, rest: Iterator[Any]) -> None:
    """Hand pictures on as they are made; an ffmpeg that has given up says itself why."""
    with contextlib.suppress(BrokenPipeError), process.stdin as pipe:  # type: ignore[union-attr]  # it is a pipe
        for picture in itertools.chain((first,), rest):
            pipe.write(picture.tobytes())


def ffmpeg() -> str:
    """Return where ffmpeg is."""
    found = shutil.which("ffmpeg")
    if found is None:
        raise InputError(
            "an .mp4 file needs the program ffmpeg, which is not on the PATH; install it (such as"
            " `apt install ffmpeg`, `brew install ffmpeg`), or write a .gif file."
        )
    return found


ENCODERS: Final[MappingProxyType[str, Encoder]] = MappingProxyType({".gif": Gif(), ".mp4": Mp4()})
"""By the ending of the file."""


def encoder_of(path: Path) -> Encoder:
    """Return what writes a file of that name, or say why nothing does.

    Examples
    --------
    >>> encoder_of(Path("cart.gif"))
    Gif()
    """
    suffix = path.suffix.lower()
    if suffix not in ENCODERS:
        known = ", ".join(ENCODERS)
        raise InputError(f"an animation is written as one of {known}, got {path.name!r}.")
    if suffix == ".mp4":
        ffmpeg()  # before the frames are drawn
    return ENCODERS[suffix]


# Animations of runs: a scene to scale beside time plots, as GIF or MP4.

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
        How it is drawn, if not as `stickslip.show.plots.animation.scenes.scene_of` says.

    Returns
    -------
    callable
        Draws it, as `stickslip.show.plots.save` and `standalone_svg` take it.

    Raises
    ------
    InputError
        If an argument cannot be used, or the run is not one of the mechanism.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> from stickslip.show.plots import standalone_svg
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> "slip forward" in standalone_svg(draw_scene(run, rig, 0.1), size=(880, 400))
    True
    """
    theme.check_scene(run, mechanism, scene)
    theme.number("t", t)
    first, last = run.span
    if not first <= t <= last:
        raise InputError(f"t must lie between {first:g} and {last:g} s, got {t:g} s.")

    def draw(figure: Figure, narrow: bool) -> None:
        stage = Stage(figure, run, mechanism, until=last, scene=scene, narrow=narrow)
        stage.show(moments_of(run, mechanism, np.array([t]))[0])

    return draw


def picture_of(run: Trajectory, mechanism: Drawn, t: float, *, size: Size) -> Pixels:
    """Return what `draw_scene` draws as a picture (height, width, 3) in RGB."""
    theme.check_scene(run, mechanism)
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
        How the mechanism is drawn, if not as `stickslip.show.plots.animation.scenes.scene_of` says.
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
    theme.check_scene(run, mechanism, scene)
    path = theme.file_of(path)
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
    theme.check_scene(run, mechanism)
    theme.number("fps", fps)
    theme.number("speed", speed)
    first, last = run.span
    if until is not None:
        theme.number("until", until)
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
    with theme.house_style():
        figure = Figure(figsize=(size[0] / 72, size[1] / 72), dpi=dpi, layout="constrained")
        figure.set_facecolor(theme.SURFACE)
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
        with theme.house_style():  # not across a yield: others may draw in between
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
    theme.number("fps", fps)
    theme.number("dpi", dpi)
    theme.check_size(size)
    if encoder is ENCODERS[".gif"] and fps > FASTEST:
        raise InputError(
            f"a GIF shows at most {FASTEST:g} frames a second, got fps={fps:g}; write an .mp4."
        )
    if not (min(size) >= 200 and max(size) * dpi / 72 <= 8000):
        raise InputError(
            f"size must be at least 200 by 200 px and, times dpi / 72, at most 8000 px, got"
            f" {size[0]:g} by {size[1]:g} px at {dpi:g} dpi."
        )


# Animations inside HTML: a GIF of bounded size on screen, a still picture in print.

MOST_BYTES: Final = 1_500_000
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
    most_bytes: int = MOST_BYTES,
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
