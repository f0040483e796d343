"""Equations as plain text, and as branches that a page sets without a stretched brace."""

import re
from unicodedata import normalize

import pytest
from tests.friction.test_composition import FREE
from tests.support import for_all

from stickslip.errors import InputError
from stickslip.friction import PRINTED_EQUATIONS, law, laws
from stickslip.show.report.markup import formula_text, symbol_text

LATEX = [form.formula for form in (*PRINTED_EQUATIONS, *laws().values())]


@pytest.mark.parametrize(
    ("latex", "text"),
    [
        (r"-\mu N \operatorname{sgn}(\dot x)", "−μ N sgn(ẋ)"),
        (r"m l \dot\theta^2 (\sin\theta - \mu)", "m l θ̇² (sin θ − μ)"),
        (r"F_c + \sigma_0 z", "F_c + σ₀ z"),
        (r"\mu_d N - \mu_{+} v", "μ_d N − μ₊ v"),  # a subscript d is no differential
        (r"\frac{dz}{dt} = \frac{|v|}{F_c} Z", "dz/dt = (|v|/F_c) Z"),
        (r"\frac{a + b}{c d}", "(a + b)/(c d)"),
        (r"\frac{a + b}{c} x", "((a + b)/c) x"),
        (r"e^{-|v/v_s|^n}", "e^(−|v/v_s|^n)"),
        (r"|a| + |b| |c|", "|a| + |b| |c|"),
        (r"10^{-6} v_1", "10⁻⁶ v₁"),
        (r"\tfrac12 k x^2", "½ k x²"),
        (r"|F| \le \mu_s N \text{ at rest}", "|F| ≤ μ_s N at rest"),
        (r"F(v) \; \& \; x \neq 0", "F(v) & x ≠ 0"),
        (r"v / \sqrt{v^2 + v_t^2}", "v/√(v² + v_t²)"),
        (r"|v|/(\sqrt 2 v_b)", "|v|/(√2 v_b)"),
        (r"\sqrt[3]{x + 1}", "³√(x + 1)"),
        (r"a, \quad b = 1 \quad {} + c", "a,\nb = 1\n  + c"),
    ],
)
def test_an_equation_reads_as_one_writes_it_by_hand(latex, text):
    assert formula_text(latex) == text


def test_a_brace_has_its_rows_below_each_other_and_its_conditions_in_a_column():
    rows = r"F_x & |F_x| < F_s \\ F_s \operatorname{sgn}(F_x) & \text{else}"
    latex = rf"F = \begin{{cases}} {rows} \end{{cases}}"
    assert formula_text(latex).splitlines() == [
        "F = ⎧ F_x           |F_x| < F_s",
        "    ⎩ F_s sgn(F_x)  else",
    ]


@for_all(LATEX)
def test_no_command_of_latex_is_left_in_the_text(latex):
    assert re.findall(r"[\\{}$]", formula_text(latex)) == []


SHOWN = {
    "ddot": "\N{COMBINING DIAERESIS}", "dot": "\N{COMBINING DOT ABOVE}", "frac": "/", "ge": "≥",
    "le": "≤", "neq": "=\N{COMBINING LONG SOLIDUS OVERLAY}", "operatorname": "sgn|sign",
    "sqrt": "√", "sum": "∑", "tfrac": "[/½]",
}  # fmt: skip
"""What commands look like; all others are the names of letters and functions, or only set apart."""
APART = {"begin", "end", "left", "quad", "right", "text", "textstyle"}
NAMES = {"arctan", "cos", "ln", "max", "min", "sin", "tanh"}


@for_all([*LATEX, *(law(text).formula for text in FREE)])
def test_every_command_of_every_formula_is_seen_in_its_text(latex):
    text = normalize("NFD", formula_text(latex))
    for command in set(re.findall(r"\\([A-Za-z]+)", latex)) - APART:
        letter = rf"[{symbol_text(command)}]"
        shown = SHOWN.get(command, command if command in NAMES else letter)
        assert len(re.findall(shown, text)) >= len(re.findall(rf"\\{command}\b", latex)), command


@pytest.mark.parametrize(
    "latex",
    [
        r"\foo x", r"\hat x", r"\bar{x}", r"\binom{2}{3}", r"\boxed{x}", r"\phantom{x}",
        r"\underline{x}", r"\stackrel{a}{=}", r"\begin{matrix} 1 & 2 \\ 3 & 4 \end{matrix}",
    ],
)  # fmt: skip
def test_what_plain_text_cannot_show_is_refused_and_never_left_out(latex):
    with pytest.raises(InputError, match="not known"):
        formula_text(latex)
