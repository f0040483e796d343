"""The gallery has a page for each law, and its guide leads to laws that exist."""

import sys
from pathlib import Path

import pytest

from stickslip.friction import LAWS, bound

EXTENSIONS = Path(__file__).parents[2] / "docs" / "_ext"


@pytest.fixture(scope="module")
def gallery():
    sys.path.insert(0, str(EXTENSIONS))
    try:
        import gallery as found
    finally:
        sys.path.remove(str(EXTENSIONS))
    return found


def test_the_page_of_a_law_says_what_it_does_and_links_to_its_figures(gallery):
    files = gallery.written("coulomb")
    page = files["coulomb.md"]
    assert page.startswith("# Coulomb\n")
    assert "\n----" not in page  # no section of the docstring
    assert page.count("F = \\mu_k N") == 1
    assert "**Passive:** always." in page
    for name in files:
        assert name in page or name in ("coulomb.md", "coulomb-thumbnail.svg")
    assert set(files) == {"coulomb.md", "coulomb-steady.svg", "coulomb-thumbnail.svg"}
    assert all(text.startswith("<svg") for name, text in files.items() if name.endswith("svg"))


def test_the_guide_names_laws_that_exist(gallery):
    for _, _, names in gallery.SYMPTOMS:
        assert any(name in LAWS for name in names)
    text = "\n".join(gallery.guide())
    assert "[Stribeck](stribeck.md)" in text
    assert "(nonsense.md)" not in text
    assert all(f"{name}.md" in "\n".join(gallery.thumbnails()) for name in LAWS)


def test_the_figures_of_a_law_show_what_tells_its_directions_and_inputs_apart(gallery):
    for name in ("directional-stribeck", "directional-dahl", "directional-lugre"):
        law = gallery.shown(LAWS[name])
        back, ahead = (law.towards(side).break_away(1.0) for side in (-1, 1))
        assert back == pytest.approx(gallery.BACKWARD * ahead)
    at_tooth, at_gap = (
        bound(gallery.shown(LAWS["cogging"]), {"position": x}).break_away(1.0)
        for x in gallery.INPUTS["position"]
    )
    assert at_gap < 0.6 * at_tooth


def test_a_law_that_deflects_has_its_loop_and_one_with_inputs_a_panel_for_each_value(gallery):
    assert set(gallery.figures(gallery.shown(LAWS["dahl"]))) == {"steady", "presliding"}
    page = gallery.written("warm-viscous")
    assert "temperature 20" in page["warm-viscous-steady.svg"]
    assert "temperature 60" in page["warm-viscous-steady.svg"]
