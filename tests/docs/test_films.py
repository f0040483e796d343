"""The films of the tutorial can be made again, and its page shows what its commands print."""

import re
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest
from benchmarks.films import FILMED, films_of_tutorial

DOCS = Path(__file__).parents[2] / "docs"
KEPT = DOCS / "howto/files/films.zip"
PAGE = DOCS / "tutorials/film-to-speed.md"


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


def test_the_commands_of_the_tutorial_are_those_that_init_names() -> None:
    text = PAGE.read_text(encoding="utf-8")
    (said,) = re.findall(r"^The rig file is .*$", text, re.MULTILINE)
    _, *following = " ".join(said.partition("Next: ")[2].split()).split("; ")
    assert len(following) == 2
    for command in following:
        assert f"```sh\n{command}\n```" in text


@pytest.mark.slow
def test_the_tutorial_shows_what_its_commands_print() -> None:
    subprocess.run([sys.executable, DOCS / "run_page.py", PAGE], check=True)
