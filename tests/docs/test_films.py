"""The films of the tutorial are those that the script in `benchmarks` makes."""

from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import numpy as np
from benchmarks.films import FILMED, films_of_tutorial

KEPT = Path(__file__).parents[2] / "docs/howto/files/films.zip"


def tables(archive: ZipFile) -> dict[str, np.ndarray]:
    """Times and positions of each film (n, 3)."""
    return {
        name: np.loadtxt(archive.read(name).decode().splitlines()[2:], delimiter="\t")
        for name in archive.namelist()
    }


def test_the_films_of_the_tutorial_can_be_made_again() -> None:
    with ZipFile(KEPT) as kept, ZipFile(BytesIO(films_of_tutorial())) as made:
        old, new = tables(kept), tables(made)
    assert sorted(old) == sorted(f"capsule_{one:g}Hz.txt" for one in FILMED) == sorted(new)
    for name, table in old.items():
        # positions have three digits of a millimetre, of which rounding may move the last
        np.testing.assert_allclose(new[name], table, atol=2e-3)
