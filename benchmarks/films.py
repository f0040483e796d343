"""Films of a capsule at seven frequencies, and whether bands of its mean speed hold the truth.

A simulated student films a vibro-impact capsule (`docs/howto/files/films.zip` is one such set):
tracked positions with noise, frames that are late, and lost ones; the law of the ground is drawn
from inside and outside those that are compared. ``python -m benchmarks.films --count 20`` prints,
of 45 frequencies, the share at which three bands of 95 % hold: that of a verdict the true mean
velocity of a film, that of readings a new film, and that of a sweep over drawn laws the settled
speed; ``--write DIR`` writes the films of the tutorial.
"""

import argparse
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np
from numpy.typing import NDArray

from stickslip import Capsule, load_rig, select, simulate
from stickslip.errors import StickslipError
from stickslip.friction import (
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    FrictionLaw,
    LuGre,
    Stribeck,
)
from stickslip.friction import law as composed
from stickslip.identify import PredictionBand
from stickslip.identify.fits import durations
from stickslip.identify.kinds.travels import TravelVerdict
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import Sine
from stickslip.study.sweep import VelocityBand, average_velocity, velocity_band

FREQUENCY = "mechanism.drive.drive.frequency"
FILMED = (4.0, 5.5, 7.0, 9.0, 11.0, 13.0, 15.0)
"""Frequencies of the films [Hz]."""
ASKED = np.linspace(4.0, 15.0, 45)
"""Frequencies at which bands are compared with the truth [Hz]."""
LASTS = 2.0
"""Length of a film [s]."""
COMPARED = ("coulomb", "coulomb-viscous", "stribeck", "direction-dependent")
"""Laws that are compared: the usual ones without bristles, which take long."""
DRAWN = 24
"""Laws that are drawn of those that the films do not exclude."""
RIG = """title = "Filmed capsule"

[mechanism]
type = "capsule"
capsule_mass = "80 g"
inner_mass = "20 g"
stiffness = "60 N/m"
damping = "0.03 N s/m"
drive_on = "inner mass"

[mechanism.upper_soft_stop]
place = "2 mm"
stiffness = "3000 N/m"
damping = "0.1 N s/m"

[mechanism.drive]
type = "torque"
drive = { type = "sine", amplitude = "0.2 N", frequency = "8 Hz" }

[data]
columns = { position = "x" }
"""


def capsule(frequency: float = 8.0) -> Capsule:
    """Return the capsule."""
    return Capsule(
        capsule_mass=0.08,
        inner_mass=0.02,
        stiffness=60.0,
        damping=0.03,
        drive=Torque(drive=Sine(amplitude=0.2, frequency=frequency)),
        drive_on="inner mass",
        upper_soft_stop=SoftStop(place=2e-3, stiffness=3000.0, damping=0.1),
    )


def truths(rng: np.random.Generator) -> Mapping[str, FrictionLaw]:
    """Return laws of the ground, with parameters drawn anew; the last three are outside."""
    mu = rng.uniform(0.12, 0.25)
    mixed: Callable[..., FrictionLaw] = composed("level + stribeck + viscous + drag")
    values = {"kinetic_coefficient": mu, "static_coefficient": 1.25 * mu}
    values |= {"stribeck_velocity": 0.02, "viscous_coefficient": 0.5, "quadratic_coefficient": 2.0}
    return {
        "coulomb": Coulomb(kinetic_coefficient=mu),
        "stribeck": Stribeck(
            kinetic_coefficient=mu,
            static_coefficient=mu * rng.uniform(1.1, 1.5),
            stribeck_velocity=10 ** rng.uniform(-2.3, -1.3),
            viscous_coefficient=rng.uniform(0.0, 0.8),
        ),
        "film": CoulombViscous(
            kinetic_coefficient=rng.uniform(0.02, 0.06), viscous_coefficient=rng.uniform(1.0, 4.0)
        ),
        "anisotropic": DirectionDependent(
            forward_kinetic_coefficient=mu,
            backward_kinetic_coefficient=mu * rng.uniform(1.1, 1.6),
        ),
        "lugre": LuGre(
            kinetic_coefficient=mu,
            static_coefficient=1.3 * mu,
            stribeck_velocity=0.02,
            bristle_stiffness=10 ** rng.uniform(4.0, 5.0),
            bristle_damping=10.0,
        ),
        "mixed": mixed(**values),
    }


@dataclass(frozen=True, kw_only=True)
class Camera:
    """How runs are filmed."""

    rate: float = 120.0
    """Frames a second."""
    noise: float = 8e-5
    """Of a tracked position [m]."""
    late: float = 2e-4
    """By which frames are late or early [s]."""
    lost: float = 0.01
    """Share of frames without a marker."""
    lasts: float = LASTS
    """Length of a film [s]."""


def write_films(
    folder: Path,
    law: FrictionLaw,
    rng: np.random.Generator,
    camera: Camera,
    *,
    wrong: int | None = None,
) -> Path:
    """Write films in the format of Tracker and their rig file; one may state a wrong frequency."""
    text = RIG
    for k, frequency in enumerate(FILMED):
        times = np.arange(0.0, camera.lasts, 1.0 / camera.rate)
        run = simulate(capsule(frequency), law, t_end=camera.lasts)
        shown = np.clip(times + rng.normal(0.0, camera.late, times.size), 0.0, camera.lasts)
        x = 0.012 + run.at(shown)["x"] + rng.normal(0.0, camera.noise, times.size)
        y = 0.040 + rng.normal(0.0, camera.noise, times.size)
        kept = rng.random(times.size) >= camera.lost
        rows = [
            f"{a:.5f}\t{1e3 * b:.3f}\t{1e3 * c:.3f}"
            for a, b, c in zip(times[kept], x[kept], y[kept], strict=True)
        ]
        name = f"capsule_{frequency:g}Hz.txt"
        head = ["capsule", "t\tx (mm)\ty (mm)"]
        (folder / name).write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
        stated = frequency + 2.0 if k == wrong else frequency
        text += f'\n[[trial]]\nfile = "{name}"\nset = {{ {FREQUENCY} = "{stated:g} Hz" }}\n'
    rig = folder / "capsule.toml"
    rig.write_text(text, encoding="utf-8")
    return rig


def films_of_tutorial() -> bytes:
    """Return the films of the tutorial, on a ground that no law of `select` describes, as a ZIP."""
    rng, packed = np.random.default_rng(4), BytesIO()
    with TemporaryDirectory() as place, ZipFile(packed, "w", ZIP_DEFLATED) as archive:
        write_films(Path(place), truths(rng)["mixed"], rng, Camera())
        for path in sorted(Path(place).glob("*.txt")):
            archive.writestr(ZipInfo(path.name), path.read_bytes(), ZIP_DEFLATED)
    return packed.getvalue()


def student(seed: int, kind: str | None = None, lasts: float = LASTS) -> tuple[str, list[float]]:
    """Return a line on one student, and the shares of the asked frequencies that bands hold."""
    rng = np.random.default_rng(seed)
    known = truths(rng)
    name = kind or [*known][seed % len(known)]
    law = known[name]
    rate = float(rng.choice([60.0, 120.0, 240.0]))
    camera = Camera(
        rate=rate, noise=rng.uniform(3e-5, 2e-4), lost=rng.uniform(0.0, 0.04), lasts=lasts
    )
    begun = time.process_time()
    with TemporaryDirectory() as place:
        rig = load_rig(write_films(Path(place), law, rng, camera))
    assert rig.measurement is not None
    verdict = select(rig.mechanism, list(COMPARED), rig.measurement, route="travel")
    assert isinstance(verdict, TravelVerdict)
    asked = verdict.judgement.at(ASKED)
    last = durations(asked, verdict.t_end)
    runs = [simulate(item.mechanism, law, t_end=end) for item, end in zip(asked, last, strict=True)]
    filmed = np.array([run["x"][-1] - run["x"][0] for run in runs])
    read = filmed + verdict.judgement.noise(ASKED) * rng.normal(size=filmed.shape)
    settled = velocity_band(
        rig.mechanism, verdict.sample(DRAWN), {FREQUENCY: ASKED}, error=verdict.prediction_error,
        settle=30, cycles=10,
    )  # fmt: skip
    true = average_velocity(rig.mechanism, law, {FREQUENCY: ASKED}, settle=30, cycles=10).velocity
    pairs: list[tuple[NDArray[np.float64], PredictionBand | VelocityBand]] = [
        (filmed, verdict.band(ASKED)), (read, verdict.readings(ASKED)), (true, settled),
    ]  # fmt: skip
    inside = [float(np.mean((x >= band.low) & (x <= band.high))) for x, band in pairs]
    half = 0.5 * float(np.median((pairs[0][1].high - pairs[0][1].low) / last))
    line = (
        f"{seed:4d} {name:12} {rate:3.0f}/s {1e3 * camera.noise:.2f} mm  inside"
        f" {inside[0]:.2f} {inside[1]:.2f} {inside[2]:.2f}  half-width {1e3 * half:6.2f} of"
        f" {1e3 * np.abs(filmed / last).max():5.1f} mm/s  {verdict.closest.name:18}"
        f" {'' if verdict.explained else 'NO LAW '}{time.process_time() - begun:5.0f} s"
    )
    return line, inside


def main() -> None:
    """Print a line for each student, and the coverage of all."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--kind")
    parser.add_argument("--lasts", type=float, default=LASTS)
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    if asked.write is not None:
        asked.write.mkdir(parents=True, exist_ok=True)
        (asked.write / "films.zip").write_bytes(films_of_tutorial())
        return
    held = list[list[float]]()
    for seed in range(asked.seed, asked.seed + asked.count):
        try:
            line, inside = student(seed, asked.kind, asked.lasts)
            held.append(inside)
        except StickslipError as error:
            line = f"{seed:4d} refused: {error}"
        print(line, flush=True)
    shares = ", ".join(f"{share:.3f}" for share in np.mean(held, axis=0))
    print(f"inside: {shares} (films, new readings, settled) of {len(held)} students")


if __name__ == "__main__":
    main()
