"""The how-to for mechanisms of one's own does what it shows."""

import contextlib
import io
import re
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs/howto/own-mechanism.md"
CELLS = re.findall(r"```\{code-cell\}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """Run the page up to its first picture; return its names and what it printed."""
    folder = tmp_path_factory.mktemp("page")
    names, printed = {"__name__": "page"}, io.StringIO()
    sys.path.insert(0, str(folder))
    sys.modules["page"] = type(sys)("page")
    try:
        for cell in CELLS[: next(i for i, cell in enumerate(CELLS) if ".plot()" in cell)]:
            head, _, rest = cell.partition("\n")
            if head.startswith("%%writefile"):
                (folder / head.split()[1]).write_text(rest, encoding="utf-8")
                continue
            with contextlib.redirect_stdout(printed):
                exec(compile(cell, str(PAGE), "exec"), names)
        yield names, printed.getvalue()
    finally:
        sys.path.remove(str(folder))
        del sys.modules["page"]
        sys.modules.pop("my_arm", None)


def test_the_arm_is_a_file_of_less_than_forty_lines():
    (arm,) = (cell for cell in CELLS if cell.startswith("%%writefile my_arm.py"))
    assert len(arm.strip().splitlines()) - 1 < 40


@pytest.mark.slow
def test_the_arm_runs_compiled_with_the_derivatives_that_differences_give(shown):
    names, printed = shown
    assert names["run"].status.complete
    assert "certified: True" in printed
    slope, ends = names["slope"], names["ends"]
    # 1e-6 squared is left out by the difference, and 1e-11 of the runs stands over it
    assert slope == pytest.approx((ends[1] - ends[0]) / 2e-6, rel=1e-4)
    assert abs(slope) > 0.1


def test_the_arm_by_matrices_moves_as_the_arm_by_energies(shown):
    names, _ = shown
    energies, matrices = names["Arm"], names["MatrixArm"]
    ends = [
        names["simulate"](kind(**names["numbers"]), names["joint"], t_end=1.0)["elbow"][-1]
        for kind in (energies, matrices)
    ]
    assert ends[1] == pytest.approx(ends[0], rel=1e-9)  # the solver's 1e-12 a step
    assert names["again"].certificate.certified


def test_the_certificate_of_the_mistyped_arm_tells_the_imbalance_of_energy(shown):
    names, _ = shown
    assert not names["wrong"].certificate.certified
    assert any("energy" in problem for problem in names["wrong"].certificate.problems)
