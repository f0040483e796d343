"""``stickslip animate``."""

import re
from pathlib import Path
from typing import Any

from rich.text import Text

from stickslip.cli import inputs
from stickslip.cli.console import print_json, refuse_overwriting, stdout
from stickslip.cli.options import AnimateOptions
from stickslip.cli.progress import Drawing
from stickslip.data import Rig
from stickslip.engine.simulation import simulate
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError
from stickslip.show.documents import document

SIZE = re.compile(r"(\d+)\s*[x×]\s*(\d+)")


def run(options: AnimateOptions) -> None:
    """Simulate, draw, show; a run that ends early is shown up to its end."""
    from stickslip.show.plots import animate, encoder_of, frame_times

    output, fps, speed = options.output, options.fps, options.speed
    size = _size(options.size)
    encoder_of(output)
    refuse_overwriting(output, output.parent, force=options.force)
    rig, chosen = inputs.rig_and_friction(options)
    law = inputs.friction_of(chosen)
    end = rig.t_end if options.t_end is None else options.t_end
    start = rig.start(law)
    seen = simulate(rig.mechanism, law, t_end=end, y0=start, throw=False)
    count = frame_times(seen, rig.mechanism, fps=fps, speed=speed).size
    output.parent.mkdir(parents=True, exist_ok=True)
    with Drawing() as progress:
        animate(
            seen,
            rig.mechanism,
            output,
            fps=fps,
            speed=speed,
            size=size,
            dpi=options.dpi,
            progress=progress,
        )
    if options.as_json:
        print_json(document("animate", _content(rig, chosen, seen, int(count), output)))
    else:
        _show(rig, inputs.friction_title(chosen), seen, int(count), output)


def _content(
    rig: Rig,
    chosen: inputs.ChosenLaw | inputs.ChosenLaws,
    seen: Trajectory,
    count: int,
    output: Path,
) -> dict[str, Any]:
    return {
        **inputs.rig_content(rig, chosen),
        "status": seen.status.name,
        "meaning": seen.ending,
        "certified": seen.certificate.certified,
        "frames": count,
        "file": str(output),
    }


def _show(rig: Rig, friction: str, seen: Trajectory, count: int, output: Path) -> None:
    console = stdout()
    console.print(Text.assemble((rig.heading, "bold"), f", {friction} friction"))
    console.print(seen.ending)
    for problem in seen.certificate.problems:
        console.print(f"Not certified: {problem}")
    console.print(f"\nAnimation: {output}, {count} frames")


def _size(text: str) -> tuple[float, float]:
    match = SIZE.fullmatch(text.strip())
    if match is None:
        raise InputError(f"--size takes WIDTHxHEIGHT such as 880x400, got {text!r}.")
    return float(match[1]), float(match[2])
