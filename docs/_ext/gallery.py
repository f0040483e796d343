"""The gallery of laws: a page each, with its figures, written before pages are read."""

import dataclasses
import hashlib
import inspect
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from pathlib import Path
from typing import Any

from generated import Generated, symbol, table
from sphinx.application import Sphinx

from stickslip.friction import LAWS, FrictionLaw, bound, said_of, with_typical_values
from stickslip.identify.fits import starting_law
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import fields_of
from stickslip.show.plots import draw_characteristics, draw_presliding
from stickslip.show.plots.svg import Draw, standalone_svg

HERE = Path(__file__).parent
FOLDER = HERE.parent / "gallery"
KEPT = HERE.parent / "_build" / "gallery"
PACKAGE = HERE.parents[1] / "src" / "stickslip"
DECIDING = ("engine", "friction", "show/plots/laws.py", "study/presliding.py")
"""Folders and files of the package that decide what a page shows."""
FIGURE, THUMBNAIL = (620, 270), (200, 130)
"""Sizes [CSS px]."""
SEEN, USUAL_SPEED = 20.0, 1e-3
"""Fastest sliding over the speed at which friction changes, and that speed where a law has none
[m/s]."""
COLUMNS = 4
"""Thumbnails beside each other."""
INPUTS = {"temperature": (20.0, 60.0), "position": (0.0, 0.26)}
"""Values of inputs that pages show, a tooth and a gap; others are 0 and of their usual size."""
BACKWARD = 0.7
"""Levels backwards over those forwards, where nobody knows how a law's directions differ."""

SYMPTOMS = (
    (
        "It hunts: under integral action it swings about its target",
        "a static level above that of sliding",
        ("coulomb-viscous-static", "stribeck", "lugre"),
    ),
    (
        "It sticks and slips, or squeals, on a slow or soft drive",
        "friction that falls with speed, or a static level",
        ("stribeck", "tustin", "hess-soom", "lugre"),
    ),
    (
        "It overshoots or springs back after a reversal; small moves are elastic",
        "a contact that deflects before it slides",
        ("dahl", "dahl-stribeck", "lugre", "maxwell-slip", "gms"),
    ),
    (
        "It errs after small swings on top of a motion",
        "a memory of all turns, not of the last one",
        ("maxwell-slip", "gms"),
    ),
    (
        "It creeps: in a simulation a parked load moves",
        "a law that is smooth at rest; take one that holds",
        ("coulomb-viscous", "stribeck", "maxwell-slip"),
    ),
    (
        "It drifts: in a simulation vibration moves a load below break-away",
        "bristles that yield at any force; take a contact with an elastic range",
        ("elasto-plastic", "maxwell-slip", "gms"),
    ),
    (
        "It starts the more easily the faster the force grows",
        "bristles beside a static level",
        ("lugre", "elasto-plastic"),
    ),
    (
        "It drifts when warm: a fit of the morning is wrong at noon",
        "friction that depends on the temperature",
        ("warm-viscous", "joint-load-temperature"),
    ),
    (
        "It takes more force one way than the other",
        "levels for each direction",
        ("direction-dependent", "directional-stribeck", "directional-dahl"),
    ),
    (
        "Its friction grows with the torque that the gear transmits",
        "levels that depend on the transmitted torque",
        ("bam-m3", "bam-m4", "bam-m6", "lugre-gear"),
    ),
    (
        "A simulation with fixed steps is slow or unstable",
        "stiff bristles, or a steep start at rest",
        ("coulomb-viscous", "stribeck", "tanh"),
    ),
)
"""What is seen, its cause, and laws that show it or cure it."""


def code_digest() -> str:
    """Return a hash of the code that decides what pages show."""
    found = hashlib.sha256(Path(__file__).read_bytes())
    for place in DECIDING:
        path = PACKAGE / place
        if not path.exists():
            raise FileNotFoundError(f"{path}: no file or folder decides what pages show")
        for file in [path] if path.is_file() else sorted(path.rglob("*.py")):
            found.update(file.read_bytes())
    return found.hexdigest()


def written(name: str) -> dict[str, str]:
    """Return the files of a law by their names: its page and figures."""
    kind = LAWS[name]
    law = shown(kind)
    drawn = figures(law)
    files = {f"{name}.md": "\n".join(page(name, kind, law, drawn))}
    for figure, (heading, draw) in drawn.items():
        title = f"{kind.title}: {heading}"
        files[f"{name}-{figure}.svg"] = standalone_svg(draw, size=FIGURE, title=title)
    _, small = drawn.get("presliding", drawn["steady"])
    files[f"{name}-thumbnail.svg"] = standalone_svg(
        bare(small), size=THUMBNAIL, title=f"{kind.title}: steady sliding"
    )
    return files


def figures(law: FrictionLaw) -> dict[str, tuple[str, Draw]]:
    """Return the drawings of a law by their names, with their headings."""
    inputs = {one: INPUTS.get(one, (0.0, CONTACT_INPUTS[one].size)) for one in law.inputs}
    curves = {law.title: law}
    if inputs:  # a panel for each combination of values
        levels = [dict(zip(inputs, values, strict=True)) for values in product(*inputs.values())]
        curves = {
            ", ".join(f"{one} {value:g} {CONTACT_INPUTS[one].unit}" for one, value in at.items()): (
                bound(law, at)
            )
            for at in levels
        }
    speeds = [getattr(law, one) for one, at in fields_of(type(law)).items() if at.scale == "speed"]
    fastest = SEEN * min(filter(None, speeds), default=USUAL_SPEED)
    result = {"steady": ("steady sliding", draw_characteristics(curves, 1.0, fastest))}
    if law.states and not inputs:
        result["presliding"] = ("presliding", draw_presliding({law.title: law}))
    return result


def shown(kind: type[FrictionLaw]) -> FrictionLaw:
    """Return a law with typical values, whose directions differ if it has two."""
    law = with_typical_values(kind) or starting_law(kind, 1.0)
    levels = {
        name: getattr(law, name)
        for name, one in fields_of(kind).items()
        if one.scale == "level-" and getattr(law, name)
    }
    forward = [getattr(law, name.replace("backward", "forward")) for name in levels]
    if [*levels.values()] != forward:
        return law
    return dataclasses.replace(
        law, **{name: float(f"{BACKWARD * one:.4g}") for name, one in levels.items()}
    )


def bare(drawing: Draw) -> Draw:
    """Return a drawing without words: its first panel."""

    def draw(figure: Any, narrow: bool) -> None:
        drawing(figure, narrow)
        for axes in figure.axes:
            axes.set(xlabel="", ylabel="", xticks=[], yticks=[], title="")
            axes.minorticks_off()
            for text in axes.texts:
                text.set_visible(False)

    return draw


def page(
    name: str, kind: type[FrictionLaw], law: FrictionLaw, drawn: Mapping[str, tuple[str, Draw]]
) -> Iterator[str]:
    """Lines of the page of a law."""
    prose = inspect.cleandoc(vars(kind).get("__doc__") or "").partition("\n\nNotes\n-")[0]
    yield from (f"# {kind.title}", "", prose, "")
    for line in kind.formula.split(r", \quad "):
        yield from ("$$", line, "$$", "")
    when, not_when = uses(law)
    yield from ("## When, and when not", "")
    yield from table(("take it for", "not for"), [("<br>".join(when), "<br>".join(not_when))])
    for heading, text in said_of(kind):
        if heading in ("Passive", "Known defects", "Note"):
            yield from (f"**{heading}:** {text.removesuffix('.')}.", "")
    yield from ("## What it does", "")
    for figure, (heading, _) in drawn.items():
        yield from (f"**{heading.capitalize()}**:", "")
        yield from (f"![{heading.capitalize()} of {kind.title}]({name}-{figure}.svg)", "")
    rows = (
        (f"`{field}`", symbol(quantity.symbol), quantity.unit, f"{getattr(law, field)}")
        for field, quantity in fields_of(kind).items()
        if getattr(law, field) is not None
    )
    yield from ("The figures are of these values:", "")
    yield from table(("parameter", "symbol", "unit", "value"), rows)
    yield from code(name, kind, law)
    keys = ",".join(kind.sources)
    if keys:
        yield from (f"Sources: {{cite}}`{keys}`.", "")


def uses(law: FrictionLaw) -> tuple[list[str], list[str]]:
    """Return what a law is for and what not, as its equations tell."""
    when, not_when = [], []
    at = bound(law, {one: INPUTS.get(one, (0.0, 0.0))[0] for one in law.inputs})
    sticks = max(float(at.towards(side).break_away(1.0)) for side in (-1, 1)) > 0.0
    if law.states:
        when.append("positioning, reversals and swings below break-away")
    elif sticks:
        when.append("motion that sticks and slips, where the contact's deflection does not matter")
        not_when.append("spring-back at reversals: below break-away it is rigid")
    else:
        when.append("fast motion in fixed steps")
        not_when.append("rest: a body under it never sticks")
    if law.directional:
        when.append("screws, cable drives and preloaded guides, which differ between directions")
    if law.inputs:
        when.append(f"records with {' and '.join(law.inputs)}, or a mechanism that computes it")
        not_when.append(f"records in which the {' and '.join(law.inputs)} does not vary")
    return [f"{one}." for one in when], [f"{one}." for one in not_when] or ["—"]


def code(name: str, kind: type[FrictionLaw], law: FrictionLaw) -> Iterator[str]:
    """Lines with the law in Python, in a rig file and on the command line."""
    given = {
        one: value for one in fields_of(kind) if isinstance(value := getattr(law, one), float | int)
    }
    values = "\n".join(f"    {one}={value!r}," for one, value in given.items())
    yield from ("## Code", "", "```python", f"from stickslip import {kind.__name__}", "")
    yield from (f"law = {kind.__name__}(", values, ")", "```", "")
    yield from ("```toml", f"[friction.{name}]")
    yield from (f"{one} = {value!r}" for one, value in given.items())
    yield from ("```", "")
    yield f"Composition: `{kind.composition}`. All parameters: {{ref}}`{kind.title} <law-{name}>`."
    yield ""


def kept(name: str, code: str) -> dict[str, str]:
    """Return the files of a law, made anew only where the law or the code has changed."""
    kind = LAWS[name]
    text = repr((name, str(kind.composition), kind.__doc__, shown(kind), code))
    path = KEPT / f"{name}-{hashlib.sha256(text.encode()).hexdigest()[:24]}.json"
    if path.exists():
        return dict(json.loads(path.read_text(encoding="utf-8")))
    files = written(name)
    KEPT.mkdir(parents=True, exist_ok=True)
    for old in KEPT.glob(f"{name}-{'?' * 24}.json"):
        old.unlink()
    path.write_text(json.dumps(files), encoding="utf-8")
    return files


def write_pages(_app: Sphinx) -> None:
    """Write the pages of all laws; files that are as before are left alone."""
    digest = code_digest()
    names = list(LAWS)
    with ProcessPoolExecutor(max_workers=min(os.cpu_count() or 1, 2)) as pool:
        made = list(pool.map(kept, names, [digest] * len(names), chunksize=4))
    files = {name: text for one in made for name, text in one.items()}
    for path in FOLDER.iterdir():
        if path.name != "index.md" and path.name not in files:
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    for file, text in files.items():
        path = FOLDER / file
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def guide() -> Iterator[str]:
    """The decision guide: from the symptom to laws."""
    rows = []
    for seen, behind, names in SYMPTOMS:
        known = ", ".join(f"[{LAWS[name].title}]({name}.md)" for name in names if name in LAWS)
        rows.append((seen, behind, known or "—"))
    yield from table(("what is seen", "what is behind it", "laws"), rows)


def thumbnails() -> Iterator[str]:
    """A table of small figures, each a link to the page of its law."""
    cells = [
        f"[![{law.title}]({name}-thumbnail.svg)]({name}.md)<br>[{law.title}]({name}.md)"
        for name, law in LAWS.items()
    ]
    cells += [""] * (-len(cells) % COLUMNS)
    rows = [tuple(cells[i : i + COLUMNS]) for i in range(0, len(cells), COLUMNS)]
    yield from table(("",) * COLUMNS, rows)


CONTENT = {"guide": guide, "thumbnails": thumbnails}


class Gallery(Generated):
    """``{gallery} guide``: the decision guide, or the thumbnails."""

    written = CONTENT


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("builder-inited", write_pages)
    app.add_directive("gallery", Gallery)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
