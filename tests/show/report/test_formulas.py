"""Equations as plain text, and as branches that a page sets without a stretched brace."""

import re
from unicodedata import normalize

import pytest
from tests.friction.test_composition import FREE
from tests.support import for_all

from stickslip.errors import InputError
from stickslip.friction import PRINTED_EQUATIONS, law, laws
from stickslip.show.report import Math, Page, Section, render
from stickslip.show.report.markup import branches, formula_text, symbol_text

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


def test_rows_of_unlike_length_and_a_last_break_are_no_error():
    cut = branches(r"x = \begin{cases} a & b \\ c \\ \end{cases}, y")
    assert cut is not None
    assert cut.rows == (("a", "b"), ("c", ""))
    assert cut.after == ", y"
    assert branches("x = 1") is None
    # an escaped ampersand parts no cells
    assert branches(r"\begin{cases} a \& b & c \end{cases}").rows == ((r"a \& b", "c"),)


@for_all(LATEX)
def test_the_page_sets_a_brace_that_needs_no_font_with_tall_glyphs(latex):
    section = Section(id="a", nav="A", heading="A", blocks=(Math(latex=latex, tag="(1)"),))
    page = render(Page(title="A", subject="", kicker="", sections=(section,), footer=""))
    body = page.partition("<main")[2]
    assert "<mtable" not in body
    assert body.count('<svg class="brace"') == latex.count(r"\begin{cases}")
    assert body.count(' class="on"') == latex.count(r"\quad {}")


def test_a_fraction_in_an_exponent_is_not_set_at_half_size():
    section = Section(id="a", nav="A", heading="A", blocks=(Math(latex="x"),))
    page = render(Page(title="A", subject="", kicker="", sections=(section,), footer=""))
    rule = re.search(r"\.math msup > :nth-child\(2\):has\(mfrac\) \{([^}]*)\}", page)
    assert rule is not None
    assert "math-style: normal" in rule[1]
    # on a phone too letters are no smaller than 12 px in the exponent, 16 px of which .82 are left
    size = float(re.search(r"font-size: (\.\d+)em", rule[1])[1])
    phone = page[page.index("@media", page.index(".math msup")) :]
    assert size * float(re.search(r"\.math \{ font-size: (\d+)px", phone)[1]) > 12.0


def test_a_sum_keeps_its_sign_and_what_it_is_over():
    assert formula_text(r"F = \textstyle\frac{\sigma_0}{4} \sum_i z_i N") == "F = (σ₀/4) ∑_i z_i N"


def test_an_index_of_two_letters_stays_one_index_and_a_power_above_it_is_kept():
    assert formula_text(r"|k_{ms} \tau_m| + q_e \tau_e^2") == "|k_ms τ_m| + q_e τ_e²"
    text = formula_text(
        r"Q = \begin{cases} a & x > 0 \\ b & x < 0 \end{cases} \text{ where } y = 0"
    )
    assert text.splitlines()[-1].endswith("x < 0  where y = 0")
