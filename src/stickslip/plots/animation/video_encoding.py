"""Pictures one after the other as a GIF, by Pillow, or as an MP4, by ffmpeg."""

import contextlib
import io
import itertools
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Protocol, final

from stickslip.errors import InputError
from stickslip.plots.core.theme import C1, C2, C3, C4, INK, LINE, MUTED, SLIP_BACK, STICK, SURFACE

PAPERS: Final = (SURFACE, STICK, SLIP_BACK)
INKS: Final = (INK, MUTED, C1, C2, C3, C4)
SHADES: Final = 9
"""Steps from each paper to each ink, for smooth edges. One palette for all frames makes a GIF a
fraction of the size: only what changes is kept of a frame."""


class Encoder(Protocol):
    """Writes pictures (height, width, 3) into a file."""

    def write(self, pictures: Iterator[Any], path: Path, fps: float) -> None:
        """Write them all, so many a second."""


@final
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
    found.add(_rgb(LINE))  # too pale for shades, which would be taken for paper
    return [level for colour in sorted(found, reverse=True) for level in colour]


def _rgb(colour: str) -> tuple[int, ...]:
    return tuple(int(colour[i : i + 2], 16) for i in (1, 3, 5))


@final
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
