"""Texts of any length are read or refused in a time that grows with their length.

No test looks at a clock: the timer counts the processor time of the test alone, and what is
quadratic takes a hundred times its limit. Regular expressions are ended by the signal.
"""

import contextlib
import json
import signal

import numpy as np
import pytest

from stickslip import load_measurement, load_rig
from stickslip.data import guess_data
from stickslip.data.readers.csv_reader import read_serial
from stickslip.data.readers.layout import is_number, is_stamp, layout_of, seconds_of
from stickslip.data.readers.tracks import seconds
from stickslip.data.units import read_gain
from stickslip.errors import InputError
from stickslip.exports.applying import read_model
from stickslip.friction import law
from stickslip.show.formatting import printable, unbroken
from stickslip.units import is_unit, number_in

LENGTH = 99_000
"""Characters: longer lines are refused before anything is sought in them."""
SECONDS = 1.0
"""Processor time after which a text has taken too long [s]: four times what the slowest takes."""
ATOMS = (
    *"a1 _.[({<\"'-:/,;\t\\#+±=@", "a ", "1 ", "a_", "a.", "1.", "1,", "1e", "1.111", "1,111", "/*",
    "/* ", '"""', "//", "[ ", "( ", "[]", "()", " in ", "in", "+-", "± ", "m*", "m ", "1/", "0:00",
    "1:", "2024-01-01 ", "<a ", "a=", "a=[]", 'over "j" {}\n', "é", "\u202f", "\ud800", "\0",
)  # fmt: skip
FRAMES = (("", ""), ("a", "!"), ("1", "x"), ("a [", ""), ("1 ", "]"), ("2024-01-01 ", "12:00:00 x"))
TEXTS = [
    before + atom * (LENGTH // len(atom)) + after
    for number, atom in enumerate(ATOMS)
    for before, after in (FRAMES[0], FRAMES[1 + number % (len(FRAMES) - 1)])
]


class TooLongError(Exception):
    """A text takes more processor time than it may."""


@contextlib.contextmanager
def limited(what):
    """End what takes too much processor time."""
    if not hasattr(signal, "setitimer"):
        pytest.skip("no timer of processor time")

    def end(*_):
        raise TooLongError(what)

    before = signal.signal(signal.SIGVTALRM, end)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def stamps(text):
    import pandas as pd

    return seconds_of(pd.Series(["2024-01-01 12:00:00", text], dtype=object))


READERS = {
    "number": is_number,
    "stamp": is_stamp,
    "stamps": stamps,
    "tracked": seconds,
    "unit": is_unit,
    "value": lambda text: number_in(text, "m"),
    "gain": read_gain,
    "law": law,
    "serial": lambda text: read_serial(f"1:00:00 -> {text}\n1:00:01 -> 1 2\n1:00:02 -> 1 2\n"),
    "printable": lambda text: unbroken(printable(text)),
    "layout": lambda text: layout_of(f"t,x\n0,{text}\n1,2\n", "utf-8"),
    "layout of numbers": lambda text: layout_of("t;x\n" + "0;1\n" * 20 + f"1;{text}\n", "utf-8"),
}


@pytest.mark.parametrize("reader", READERS)
def test_a_value_of_any_length_is_read_or_refused_at_once(reader):
    for text in TEXTS[:: 3 if reader.startswith("layout") else 1]:
        with limited(text[:40]), contextlib.suppress(InputError):
            READERS[reader](text)


@pytest.mark.parametrize("place", ["header", "cell", "line above", "last cell"])
def test_a_cell_of_any_length_is_read_or_refused_at_once(place, tmp_path):
    rows = [
        f"{t:.3f},{x:.6f}" for t, x in zip(np.arange(20) / 100, np.arange(20) ** 2, strict=True)
    ]
    file = tmp_path / "a.csv"
    for text in TEXTS[::9]:
        lines = {
            "header": [f"time,{text}", *rows],
            "cell": ["time,position", *rows[:9], f"0.1,{text}", *rows[9:]],
            "line above": [text, "time,position", *rows],
            "last cell": ["time,position", *rows, f"9,{text}"],
        }[place]
        file.write_bytes("\n".join(lines).encode("utf-8", "replace"))
        for read in (load_measurement, guess_data):
            with limited(text[:40]), contextlib.suppress(InputError):
                read(file)


@pytest.mark.parametrize("place", ["value", "key", "text"])
def test_a_value_of_a_rig_file_of_any_length_is_read_or_refused_at_once(place, tmp_path):
    file = tmp_path / "rig.toml"
    for text in TEXTS[::9]:
        quoted = json.dumps(text.encode("utf-8", "replace").decode())
        line = {
            "value": f'type = "spring-block"\nmass = {quoted}',
            "key": f'type = "spring-block"\n{quoted} = 1',
            "text": f"type = {quoted}",
        }[place]
        file.write_text(f"[mechanism]\n{line}\n", encoding="utf-8")
        with limited(text[:40]), contextlib.suppress(InputError):
            load_rig(file)


MODELS = {
    "usd": ('#usda 1.0\n{text}\ndef PhysicsRevoluteJoint "j" {{ }}\n', "physx"),
    "usd comment": ('#usda 1.0\n# {text}\ndef PhysicsRevoluteJoint "j" {{ }}\n', "physx"),
    "mjcf": ("<mujoco><worldbody><body><joint {text}/></body></worldbody></mujoco>", "mjcf"),
    "mjcf text": (
        '<mujoco><worldbody><body><joint name="j"{text}/></body></worldbody></mujoco>',
        "",
    ),
    "urdf": ('<robot><joint name="j" type="{text}"><a/></joint></robot>', "urdf"),
}


@pytest.mark.parametrize("kind", MODELS)
def test_a_model_of_any_length_is_read_or_refused_at_once(kind, tmp_path):
    file = tmp_path / "model.xml"
    for text in TEXTS[::5]:
        file.write_text(MODELS[kind][0].format(text=text), "utf-8", errors="replace")
        with limited(text[:40]), contextlib.suppress(InputError):
            model = read_model(file, "physx" if kind.startswith("usd") else None)
            joint = model.joint("j")
            model.edits(joint, {"damping": "1"})


def test_the_time_of_a_scene_grows_with_its_prims(tmp_path):
    file = tmp_path / "model.usda"
    prims = 'def PhysicsRevoluteJoint "j" { }\n' * 12_500
    file.write_text(f"#usda 1.0\n{prims}")
    with limited("prims"):
        *_, last = read_model(file, "physx").stage.prims
    assert last.line == 12_501
