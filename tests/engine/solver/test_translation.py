"""Text that LLVM compiles against the same text in plain Python: the same bits.

Where plain Python refuses a number (a division by zero, the logarithm of -1), compiled code gives
what the C library and the processor give; the judge is then the same text over NumPy's scalars and
the C library's functions.
"""

import ast
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

from stickslip.engine.formulation.model import function
from stickslip.engine.kernels.backend import rare
from stickslip.engine.kernels.state_layout import NUMBERS
from stickslip.engine.solver.compile.object_code import _compiled, _linked
from stickslip.engine.solver.compile.programs import EquationsCode
from stickslip.engine.solver.compile.translation import (
    FUNCTIONS,
    REAL,
    TRUTH,
    VECTOR,
    WHOLE,
    Function,
    Signature,
    exported,
    translated,
)
from stickslip.errors import CompilationError

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
    w_type = ctypes.POINTER(real), whole
    bare = ctypes.CFUNCTYPE(None, *[whole] * 3, real, *w_type, whole, whole)(code.address)

    def call(mode, flags, t, w, at, to, number=7):
        vector = (real * len(w))(*w)
        bare(number, mode, flags, t, vector, len(w), at, to)
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
    agree(text, [*strange, *draws(50)], library)


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


REFUSED = {
    "while flags:\n        pass": "pass",
    "for i in range(mode, at, to):\n        w[to + i] = 0.0": "needs a constant step",
    "for i in range(2):\n        c = 0.0\n    w[to] = c": "'c' has no value here",
    "for i in w:\n        w[to] = 0.0": "for i in w",
    "for i, j in range(2):\n        w[to] = 0.0": "for i, j",
    "import os": "import os",
    "w[to] = __import__('os')": "__import__",
    "w[to] = math.gamma(t)": "math.gamma(t)",
    "w[to] = math.sin(t, t)": "math.sin(t, t)",
    "w[to] = math.sin(x=t)": "math.sin(x=t)",
    "w[to] = cmath.sin(t)": "cmath.sin(t)",
    "w[to] = t % 2.0": "t % 2.0",
    "w[to] = t // 2.0": "t // 2.0",
    "w[to] = flags ** 2": "flags ** 2",
    "w[to] = t & 1": "t & 1",
    "w[to] = 'a'": "'a'",
    "w[to] = (mode == 1) + 1.0": "(mode == 1) + 1.0",
    "w[to] = c": "'c' has no value here",
    "w[to] = w.size": "'w.size' has no value here",
    "w[to] = layout.TIME": "'layout.TIME' has no value here",
    "w[to] = w": "w[to]",
    "w[t] = 1.0": "'t' is no whole number",
    "w[to:at] = 1.0": "to:at",
    "c = w[to:at:2]": "to:at:2",
    "c = w[to:]": "w[to:]",
    "c = w[0:2]\n    c = w[1:2]": "is a vector that is named twice",
    "w[18446744073709551616] = 1.0": "too large",
    "v[to] = 1.0": "'v' has no value here",
    "t[to] = 1.0": "'t' is no vector",
    "a = b = 1.0": "a = b = 1.0",
    "a, b = 1.0, 2.0, 3.0": "1.0, 2.0, 3.0",
    "a, *b = 1.0, 2.0": "*b",
    "c = 1\n    c = 1.0": "was a whole number and becomes a real number",
    "c = 1.0 if mode == 1 else 2": "is a real number or a whole number",
    "return 1.0": "does not return nothing",
    "return\n    w[to] = 1.0": "never reached",
    "break": "break",
    "while True:\n        break\n    else:\n        return": "while True",
    "if w:\n        return": "'w' is no condition",
    "if t:\n        return": "'t' is no condition",
    "if mode is 1:\n        return": "mode is 1",
    "if w == 1.0:\n        return": "w == 1.0",
    "if flags & 1:\n        c = 1.0\n    w[to] = c": "'c' has no value here",
    "f(mode)": "f(mode)",
    "def g():\n        pass": "def g()",
    "del w": "del w",
    "pass": "pass",
}


@pytest.mark.parametrize(("line", "named"), REFUSED.items(), ids=REFUSED)
def test_what_is_not_known_is_refused_by_line_and_words(line, named):
    with pytest.raises(CompilationError, match=r"equations, line \d+: ") as caught:
        EquationsCode("a test", f"{HEAD}    {line}\n", (("f", 0),)).text()
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
        EquationsCode("a test", text, ()).text()


# --- what kernels use beside: functions of whole numbers i, j, reals x, y and a vector w

HELPERS = """
TABLE = (0.5, -1.5, 2.5)
WORDS = (3, 5, 8)
LIMIT = 7
def swapped(i, j):
    return j, i + 1
@rare
def halved(start):
    if start > 1.0:
        return 0.5 * start
    return start
def is_even(i):
    return i % 2 == 0
"""
KINDS = {
    "swapped": ({"i": WHOLE, "j": WHOLE}, (WHOLE, WHOLE)),
    "halved": ({"start": REAL}, (REAL,)),  # a word that a label might be
    "is_even": ({"i": WHOLE}, (TRUTH,)),
}
PARAMETERS = {"i": WHOLE, "j": WHOLE, "x": REAL, "y": REAL, "w": VECTOR}
BODIES = {
    "division": "return 1.0 * (i // 3) + 10.0 * (i % 3) + 100.0 * (i // -4) + 1000.0 * (i % -4)",
    "both at once": "a, b = divmod(i, 5)\n    return a + 100.0 * b",
    "by a variable": "if j == 0:\n        return 0.0\n    return i // j + 0.001 * (i % j)",
    "true division": "return i / 4 + x / 2",
    "bits": "return 1.0 * (((i << 2) ^ j) & 255 | 1) + ((i >> 1) + ~j)",
    "least": "return min(x, y)",
    "greatest": "return max(y, x, 0.0)",
    "least of mixed": "return min(i, j, 3) + max(i, x)",
    "magnitudes": "return abs(x) + abs(i) + abs(-0.0)",
    "cut off": "return int(min(max(x, -9.0), 9.0)) + 0.5 * int(3.99) + float(i)",
    "upwards": "return math.ceil(math.log2(max(min(abs(x), 1e9), 1.0)))",
    "powers": "return 2.0**i + 3.0**2 if i < 9 else 0.0",
    "which is a number": "return 1.0 if math.isnan(x) else 2.0",
    "no further than it has to": "return 1.0 if 0 <= i < 3 and w[i] > 0.0 else 0.0",
    "or": "return 1.0 if i > 2 or i < 0 or w[i] > x else 0.0",
    "not": "return 1.0 if not (i and not j) else 0.0",
    "truth in a vector": "w[0] = x > y\n    w[1] = is_even(i)\n    return w[0] + w[1]",
    "truths": "c = x > y\n    return 1.0 if c == (i > j) else (2.0 if c != is_even(j) else 3.0)",
    "chains": "return 1.0 if 0.0 < x <= 2.0 < y else 0.5 if -1 <= i < j else 0.0",
    "among reals": "return 1.0 if 0 in (x, i) or y not in (1.0, j, -0.0) else 0.0",
    "among": "return 1.0 if i in (1, 2, LIMIT) else 2.0 if j not in (0, 3) else 0.0",
    "tables": "t = TABLE if i > 0 else TABLE\n    return t[i % 3] * WORDS[j % 3] + len(TABLE)",
    "loops": "s = 0.0\n    for k in range(i):\n        s += k * x\n    return s",
    "from and to": "s = 0\n    for k in range(j, i):\n        s += k\n    return float(s)",
    "downwards": "s = 0.0\n    for k in range(i, -2, -2):\n        s = s * 0.5 + k\n    return s",
    "leave out": (
        "s = 0.0\n    for k in range(9):\n        if k == j:\n            continue\n"
        "        if k > i:\n            break\n        s += x\n    return s"
    ),
    "of its own": "k = 0\n    for k in range(i % 4):\n        k += 5\n    return float(k)",
    "nested": (
        "s = 0\n    for a in range(4):\n        for b in range(a):\n            if b == j:\n"
        "                break\n            s += a * b\n        s += 1\n    return s + 0.0"
    ),
    "as long as": "k = 0\n    while k < i and k != 5:\n        k += 1\n    return k + 0.0",
    "until": (
        "k = i\n    while True:\n        k -= 1\n        if k < j or k < -20:\n"
        "            return 1.0 * k"
    ),
    "until it breaks": "k = 0\n    while True:\n        k += 2\n        if k > i:\n"
    "            break\n    return 1.0 * k",
    "two results": "a, b = swapped(i, j)\n    b, a = a, b\n    return a + 0.01 * b",
    "calls": "return halved(x) + halved(i) if is_even(j) else halved(halved(y))",
    "parts": "p = w[1:3]\n    return p[0] + 2.0 * p[1] + len(p) + len(w)",
    "places": "w[0] += x\n    w[i % 3] *= 2.0\n    a, w[1] = y, x\n    return w[0] + w[1] + a",
    "either way": "if x > 0.0:\n        c = 1.0\n    elif i:\n        c = 2.0\n"
    "    else:\n        return 9.0\n    return c + x",
    "a whole number in a real place": "s = x\n    if i > 0:\n        s = 3\n    return s * 0.5",
    "infinite": "return math.inf if i > 0 else -math.inf if i < 0 else math.nan",
}


def translate(bodies):
    """Return functions f0, f1, ... of (i, j, x, y, w), compiled together and in plain Python."""
    heads = [f"def f{k}(i, j, x, y, w):\n    {body}\n" for k, body in enumerate(bodies)]
    program = HELPERS + "".join(heads)
    module = {"math": math, "rare": rare}
    exec(program, module)
    signatures = {
        name: Signature(name, tuple(taken.items()), results)
        for name, (taken, results) in KINDS.items()
    }
    own = [f"f{k}" for k in range(len(bodies))]
    signatures |= {name: Signature(name, tuple(PARAMETERS.items()), (REAL,)) for name in own}

    def meaning(name):
        return signatures.get(name, module.get(name))

    functions = [
        Function(node, signatures[node.name], meaning, "kernels")
        for node in ast.parse(program).body
        if isinstance(node, ast.FunctionDef)
    ]
    outside = [exported(f"enter_{name}", signatures[name]) for name in own]
    image = _compiled("\n".join([translated(functions), *outside]))
    addresses, keeper = _linked("a test", image, [f"enter_{name}" for name in own])
    real, whole = ctypes.c_double, ctypes.c_int64
    kind = ctypes.CFUNCTYPE(real, whole, whole, real, real, ctypes.POINTER(real), whole)

    def fast(k):
        def call(i, j, x, y, w):
            vector = (real * len(w))(*w)
            result = kind(addresses[f"enter_f{k}"])(i, j, x, y, vector, len(w))
            w[:] = vector
            return result

        return call

    return [(fast(k), module[name]) for k, name in enumerate(own)], keeper


@pytest.fixture(scope="module")
def kernels():
    pairs, keeper = translate(BODIES.values())
    return dict(zip(BODIES, pairs, strict=True)), keeper


@pytest.mark.parametrize("name", BODIES)
def test_each_construct_of_the_kernels_gives_the_same_bits(kernels, name):
    fast, plain = kernels[0][name]
    dice = random.Random(name)
    seen = set()
    for _ in range(300):
        i, j = dice.randint(-12, 12), dice.randint(-3, 9)
        x, y = (
            dice.choice(STRANGE) if dice.random() < 0.2 else dice.gauss(0.0, 2.0) for _ in range(2)
        )
        if name in ("cut off", "upwards") and math.isnan(x):
            continue  # where Python raises
        expected = [dice.gauss(0.0, 1.0) for _ in range(3)]
        got = list(expected)
        value, other = fast(i, j, x, y, got), plain(i, j, x, y, expected)
        assert str(bits([value, *got])) == str(bits([other, *expected])), (i, j, x, y)
        seen.add(value)
    assert len(seen) > 1


def test_what_is_no_number_or_too_large_is_cut_off_to_some_whole_number():
    ((fast, _),), _keeper = translate(["return float(int(x))"])
    assert fast(0, 0, 1e300, 0.0, []) == 2.0**63
    assert fast(0, 0, -1e300, 0.0, []) == -(2.0**63)
    assert fast(0, 0, math.nan, 0.0, []) == 0.0


KERNELS_REFUSED = {
    "return i": None,  # a whole number serves as a real one
    "c = i": "may end without a result",
    "if i > 0:\n        return 1.0": "may end without a result",
    "return": "does not return a real number",
    "return x > y": None,
    "return w": "does not return a real number",
    "return swapped(i, j)": "has no result",
    "return halved(w)": "is a vector, where start is a real number",
    "return is_even(x)": "is a real number, where i is a whole number",
    "return halved(x, y)": "takes 1 arguments",
    "return TABLE": "does not return a real number",
    "return unknown(x)": "unknown(x)",
    "return x ** y ** w": "y ** w",
}


@pytest.mark.parametrize(("body", "reason"), KERNELS_REFUSED.items(), ids=KERNELS_REFUSED)
def test_kernels_of_other_kinds_are_refused(body, reason):
    if reason is None:
        translate([body])
        return
    with pytest.raises(CompilationError, match=r"^kernels, line \d+: ") as caught:
        translate([body])
    assert reason in str(caught.value)
