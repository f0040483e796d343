"""Equations that LLVM compiles against the same text in plain Python: the same bits.

Where plain Python refuses a number (a division by zero, the logarithm of -1), compiled code gives
what the C library and the processor give; the judge is then the same text over NumPy's scalars and
the C library's functions.
"""

import ctypes
import ctypes.util
import itertools
import math
import random
import struct
from types import SimpleNamespace

import numpy as np
import pytest
import symengine as se

from stickslip.errors import CompilationError
from stickslip.formulation.code_printer import function
from stickslip.kernels.state_layout import NUMBERS
from stickslip.solver.compile.equations_code import EquationsCode
from stickslip.solver.compile.translation import FUNCTIONS, translated

HEAD = "def f(mode, flags, t, w, at, to):\n"
STRANGE = [0.0, -0.0, math.inf, -math.inf, math.nan, 1.0, -1.0, 5e-324, -2.5e-310, 1e308, -1e308]
ROOM = 16
SIZE = NUMBERS + 8 + ROOM


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "cache"))


@pytest.fixture(scope="module")
def library():
    """Return `math` as compiled code has it: nothing raises."""
    found = ctypes.CDLL(ctypes.util.find_library("m"))

    def real(name, count):
        bare = getattr(found, name)
        bare.restype, bare.argtypes = ctypes.c_double, [ctypes.c_double] * count
        return lambda *numbers: np.float64(bare(*numbers))

    return SimpleNamespace(**{name: real(name, count) for name, (_, count) in FUNCTIONS.items()})


def compiled(text):
    """Return the function ``f`` of a text as a Python function over a list."""
    code = EquationsCode("a test", text, (("f", 7),))
    code.load()
    whole, real = ctypes.c_int64, ctypes.c_double
    kind = ctypes.CFUNCTYPE(None, whole, whole, whole, real, ctypes.POINTER(real), whole, whole)
    bare = kind(code.address)

    def call(mode, flags, t, w, at, to, number=7):
        vector = (real * len(w))(*w)
        bare(number, mode, flags, t, vector, at, to)
        w[:] = vector

    return call


def executed(text, namespace):
    module = {"math": namespace}
    exec(text, module)
    return module["f"]


def bits(numbers):
    """Return numbers as comparable bits; one NaN is as good as another."""
    return [math.nan if math.isnan(x) else struct.pack(">d", x) for x in map(float, numbers)]


def agree(text, calls, library):
    """Compare a compiled text with plain Python, and where that raises with the C library."""
    fast, plain, exact = compiled(text), executed(text, math), executed(text, library)
    raised = 0
    for mode, flags, t, numbers, at, to in calls:
        got, expected = list(numbers), list(numbers)
        fast(mode, flags, t, got, at, to)
        try:
            plain(mode, flags, t, expected, at, to)
        except (ArithmeticError, ValueError):
            raised += 1
            expected = [np.float64(x) for x in numbers]
            with np.errstate(all="ignore"):
                exact(mode, flags, np.float64(t), expected, at, to)
        assert list(map(str, bits(got))) == list(map(str, bits(expected)))
    return raised


def draws(count, size=SIZE, seed=1):
    """Yield arguments: ordinary numbers, large and small ones, and strange ones."""
    dice = random.Random(seed)

    def number():
        scale = dice.choice([1.0, 1.0, 10.0, 1e-3, 1e3, 1e-150, 1e150])
        return dice.choice(STRANGE) if dice.random() < 0.3 else dice.gauss(0.0, 1.0) * scale

    for _ in range(count):
        numbers = [number() for _ in range(size)]
        yield dice.choice([-1, 0, 1, 2]), dice.randrange(8), number(), numbers, 2, size - ROOM


@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_function_gives_the_bits_of_the_c_library(name, library):
    arguments = ["w[at]", "w[at + 1]"][: FUNCTIONS[name][1]]
    text = f"{HEAD}    w[to] = math.{name}({', '.join(arguments)})\n"
    text += f"    w[to + 1] = math.{name}({', '.join(['0.7', '0.3'][: len(arguments)])})\n"
    strange = [(1, 0, 0.0, [a, b, 0.0, 0.0], 0, 2) for a, b in itertools.product(STRANGE, STRANGE)]
    agree(text, [*strange, *draws(200)], library)


def test_a_power_is_that_of_the_c_library_whatever_is_known_of_it(library):
    bases, exponents = (2.0, 10.0, 0.5, math.e), (2.0, 0.5, -0.5, 1.5, 1 / 3, 3.0)
    powers = [f"math.pow({base!r}, w[at])" for base in bases]
    powers += [f"math.pow(w[at], {exponent!r})" for exponent in exponents]
    powers += [f"math.pow({a!r}, {b!r})" for a, b in itertools.product(bases, exponents)]
    lines = [f"    w[to + {i}] = {power}\n" for i, power in enumerate(powers)]
    room = [0.0] * len(powers)
    strange = [(1, 0, 0.0, [a, *room], 0, 1) for a in STRANGE]
    usual = [(*call[:3], [call[3][0], *room], 0, 1) for call in draws(200)]
    agree(HEAD + "".join(lines), [*strange, *usual], library)


def test_sine_and_cosine_of_one_number_may_be_joined_and_stay_the_same(library):
    text = (
        f"{HEAD}    c = w[at]\n    w[to] = math.sin(c)\n    w[to + 1] = math.cos(c)\n    return\n"
    )
    agree(text, draws(200), library)


ARITHMETIC = [
    "w[at] + w[at + 1] - w[at + 2]",
    "w[at] - (w[at + 1] - w[at + 2])",
    "w[at]*w[at + 1] + w[at + 2]",  # a fused product would round once
    "-w[at]*w[at + 1]",
    "-(w[at] + t)",
    "w[at]/w[at + 1]",
    "1.0/(w[at]*w[at + 1])",
    "w[at]/3.0",
    "w[at]*0.0 + 0.0",
    "w[at] - w[at]",
    "(c*c*c)/w[at + 1]",
    "-0.0",
    "-1.5e-320*w[at]",
    "w[3]",
]


def test_each_kind_of_arithmetic_gives_the_same_bits(library):
    lines = [f"    w[to + {i}] = {line}\n" for i, line in enumerate(ARITHMETIC)]
    agree(f"{HEAD}    c = w[at] + 0.1\n{''.join(lines)}", draws(200), library)


def test_a_long_sum_is_added_term_by_term(library):
    terms = [f"{sign} w[at + {i % 8}]" for i, sign in zip(range(2500), itertools.cycle("+-+"))]
    agree(f"{HEAD}    w[to] = {' '.join(terms).removeprefix('+ ')}\n", draws(20), library)


BRANCHES = """
    if mode == 1:
        y0 = w[at + 0]
        if flags & 2:
            c1 = y0*2.0
        else:
            if y0 < t:
                c2 = -y0
                c1 = c2
            else:
                c1 = math.atan(y0)
        c3 = 1.0
        if c1 < 0.0:
            c3 = c1
        w[to + 0] = c1
        w[to + 1] = c3
        return
    if mode == -1:
        for i in range(5):
            w[to + i] = 0.0
        w[to + 3] = t
        return
"""


def test_modes_flags_comparisons_and_loops_take_the_same_way(library):
    agree(HEAD + BRANCHES, draws(300), library)


def test_what_is_printed_for_any_expression_gives_the_same_bits(library):
    y = se.symbols("y0:4")
    p, t, s = se.symbols("p0:2"), se.Symbol("t"), se.Symbol("s1")
    inner = se.Piecewise((y[0] ** 2 / (1 + y[1]), y[0] < y[2]), (se.exp(-y[1]), True))
    cases = {
        1: [
            se.sin(y[0]) * se.cos(y[0]) + se.tanh(y[1] / p[0]) ** 3,
            se.Piecewise((inner + p[1], se.Lt(se.Integer(0), s)), (y[3] / t, True)),
            se.sqrt(y[0] * y[0] + 1) ** -1 - se.log(se.Abs(2) + y[1] ** 2) * -3,
            y[0] ** p[1] + se.atan(y[2]) ** se.Rational(-2, 3),
        ],
        -1: [se.Integer(0)] * 5 + [y[0] - y[1] + p[0] / y[2] / p[1]],
    }
    raised = agree(function("f", cases), draws(300), library)
    assert raised > 10  # so that the second judge was asked


def test_what_has_no_number_does_nothing():
    call = compiled(f"{HEAD}    w[to] = 1.0\n    return\n")
    w = [0.0]
    call(0, 0, 0.0, w, 0, 0, number=8)
    assert w == [0.0]
    call(0, 0, 0.0, w, 0, 0)
    assert w == [1.0]


REFUSED = {
    "while flags:\n        pass": "while flags",
    "for i in range(mode):\n        w[to + i] = 0.0": "range(mode)",
    "for i in range(0):\n        w[to + i] = 0.0": "range(0)",
    "for i in range(2):\n        c = 0.0": "c = 0.0",
    "for i in w:\n        w[to] = 0.0": "for i in w",
    "import os": "import os",
    "w[to] = __import__('os')": "__import__",
    "w[to] = math.gamma(t)": "math.gamma(t)",
    "w[to] = math.sin(t, t)": "math.sin(t, t)",
    "w[to] = math.sin(x=t)": "math.sin(x=t)",
    "w[to] = cmath.sin(t)": "cmath.sin(t)",
    "w[to] = t ** 2.0": "t ** 2.0",
    "w[to] = t % 2.0": "t % 2.0",
    "w[to] = 1": "'1'",
    "w[to] = True": "True",
    "w[to] = 'a'": "'a'",
    "w[to] = mode": "'mode' is a whole number",
    "w[to] = c": "'c' has no value here",
    "w[to] = w": "'w' has no value here",
    "w[t] = 1.0": "'t' is no whole number",
    "w[to - 1] = 1.0": "to - 1",
    "w[to:at] = 1.0": "to:at",
    "w[18446744073709551616] = 1.0": "too large",
    "v[to] = 1.0": "v[to]",
    "w[to] += 1.0": "w[to] += 1.0",
    "a = b = 1.0": "a = b = 1.0",
    "a, b = 1.0, 2.0": "a, b",
    "t = 1.0": "t = 1.0",
    "return 1.0": "return 1.0",
    "return\n    w[to] = 1.0": "never reached",
    "w[to] = 1.0 if mode == 1 else 2.0": "if mode == 1",
    "if t == 1.0:\n        return": "'t' is no whole number",
    "if t <= 1.0:\n        return": "t <= 1.0",
    "if 0.0 < t < 1.0:\n        return": "0.0 < t < 1.0",
    "if mode == 1 and flags & 2:\n        return": "mode == 1 and",
    "if flags & 1:\n        c = 1.0\n    w[to] = c": "'c' has no value here",
    "def g():\n        pass": "def g()",
    "del w": "del w",
    "pass": "pass",
}


@pytest.mark.parametrize(("line", "named"), REFUSED.items(), ids=REFUSED)
def test_what_the_printer_does_not_use_is_refused_by_line_and_words(line, named):
    with pytest.raises(CompilationError, match=r"equations, line \d+: ") as caught:
        translated(f"{HEAD}    {line}\n", {"f": 0})
    assert named in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "x = 1.0\n",
        "def f(mode, t, w):\n    return\n",
        "def f(mode, flags, t, w, at, to=1):\n    return\n",
        "def f(mode, flags, t, w, at, to, *more):\n    return\n",
        "@jit\ndef f(mode, flags, t, w, at, to):\n    return\n",
        "async def f(mode, flags, t, w, at, to):\n    return\n",
    ],
)
def test_only_functions_of_the_usual_arguments_are_taken(text):
    with pytest.raises(CompilationError, match=r"equations, line [12]: "):
        translated(text, {})
