"""Inline markup is readable and can carry no foreign HTML."""

import re
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markupsafe import Markup

from stickslip.show.report import markup


class Tags(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: set[str] = set()
        self.content = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.names.add(tag)
        assert {key for key, _ in attrs} <= {
            "class",
            "display",
            "mathvariant",
            "stretchy",
            "lspace",
            "rspace",
        }

    def handle_data(self, data):
        self.content += data


@pytest.mark.parametrize(
    ("name", "html", "text"),
    [
        ("mu_d", '<i class="v">μ</i><sub>d</sub>', "μ_d"),
        ("mu_s", '<i class="v">μ</i><sub>s</sub>', "μ_s"),
        ("sigma_0", '<i class="v">σ</i><sub>0</sub>', "σ₀"),
        ("F_v-", '<i class="v">F</i><sub>v−</sub>', "F_v−"),
        ("v", '<i class="v">v</i>', "v"),
        ("theta_phi", '<i class="v">θ</i><sub>φ</sub>', "θ_φ"),
        ("F_c_max", '<i class="v">F</i><sub>c,max</sub>', "F_c,max"),
    ],
)
def test_a_symbol_is_italic_with_an_upright_subscript(name, html, text):
    assert markup.symbol(name) == html
    assert markup.symbol_text(name) == text


def test_an_empty_symbol_is_refused():
    with pytest.raises(ValueError, match="begins with a letter, got '_0'"):
        markup.symbol("_0")


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("a < b & c", "a &lt; b &amp; c"),
        ("**$mu_d$ known**", '<b><i class="v">μ</i><sub>d</sub> known</b>'),
        ("`select **x**`", "<code>select **x**</code>"),
        ("10^{5} N/m, x_{0}", "10<sup>5</sup> N/m, x<sub>0</sub>"),
        ("$5 and $6", "$5 and $6"),
        ("2 ** 3 ** 4", "2 ** 3 ** 4"),
        ("snake_case_name", "snake_case_name"),
        ("3 × 10⁻¹⁵ m²", "3\xa0×\xa010<sup>−15</sup>\xa0m<sup>2</sup>"),
        ("`<b>`^{<i>}", "<code>&lt;b&gt;</code><sup>&lt;i&gt;</sup>"),
    ],
)
def test_the_small_markup_becomes_html_and_the_rest_is_escaped(text, html):
    assert markup.inline(text) == html


def test_markup_is_not_escaped_twice():
    assert markup.inline(markup.symbol("v")) == markup.symbol("v")
    assert markup.plain(Markup("<b>a</b> &lt; b")) == "a < b"


@pytest.mark.parametrize(
    ("text", "glued"),
    [
        ("10 N for 0.1 s", "10~N for 0.1~s"),
        ("158 ± 4 N s/m", "158~±~4~N~s/m"),
        ("1.9 % of 3 × 2", "1.9~% of 3~×~2"),
        ("6 models in 2 sets", "6 models in 2 sets"),
    ],
)
def test_no_line_break_parts_a_number_from_its_unit(text, glued):
    assert markup.inline(text).replace("\N{NO-BREAK SPACE}", "~") == glued


@given(st.text(alphabet=st.sampled_from("ab<>&\"'$*`^_{}0- \n\u202e"), max_size=40))
def test_no_text_can_make_a_tag_of_its_own(text):
    assert Tags(markup.inline(text)).names <= {"i", "b", "code", "sup", "sub"}


@given(st.text(alphabet="ab<>&\"' ", max_size=40))
def test_text_without_markup_reads_back_unchanged(text):
    assert Tags(markup.inline(text)).content == text
    assert markup.plain(text) == text


def test_an_equation_is_mathml_without_an_address():
    text = markup.mathml(r"F = \frac{\mu_d N}{1 + |v / v_s|^\delta} < 1")
    assert text.startswith('<math display="block">')
    assert "<mfrac>" in text
    assert "&lt;" in text
    assert "http" not in text


@pytest.mark.parametrize(
    "latex",
    [
        r"\text{<script>alert(1)</script>}",
        r"\href{javascript:alert(1)}{x}",
        r"\mathrm{&lt;img src=x onerror=alert(1)&gt;}",
        r"a < b > c & d",
    ],
)
def test_an_equation_cannot_carry_a_script(latex):
    text = markup.mathml(latex)
    assert not re.search(r"<(?!/?(math|m[a-z]+)\b)|href=", text)
    Tags(text)


@pytest.mark.parametrize(
    ("latex", "gaps"),
    [
        (r"\mu \sin\theta", [("sin", "0.17em", "0.17em")]),
        (r"a \operatorname{sgn}(v)", [("sgn", "0.17em", "0")]),
        (r"(\sin\theta - \cos(x))", [("sin", "0", "0.17em"), ("cos", "0.17em", "0")]),
    ],
)
def test_the_name_of_a_function_stands_apart_from_its_factors_and_close_to_brackets(latex, gaps):
    operators = re.findall(r'<mo lspace="([^"]*)" rspace="([^"]*)">([a-z]+)<', markup.mathml(latex))
    assert [(name, left, right) for left, right, name in operators] == gaps


def test_superscripts_and_subscripts_of_plain_text_are_not_read_as_other_numbers():
    assert markup.plain("10^{−6} m, x_{0}, |v|^{n}, e^{a+b}, F_{max}") == (
        "10⁻⁶ m, x₀, |v|^n, e^(a+b), F_max"
    )


def test_an_equation_that_cannot_be_read_is_refused_by_its_text():
    with pytest.raises(ValueError, match=r"cannot read the equation"):
        markup.mathml(r"x_1_2")
