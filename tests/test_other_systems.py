"""Windows and macOS as far as Linux can tell: object code of their formats, Python without POSIX.

What this cannot show is whether the code computes the same there.
"""

import ast
import os
import re
import subprocess
import sys
import textwrap
import time
from collections.abc import Set
from pathlib import Path
from types import SimpleNamespace

import pytest
from llvmlite import binding
from tests.support import BLOCK_RIG, for_all

import stickslip
from stickslip import LuGre, SpringBlock, Stribeck
from stickslip.engine.formulation import formulate
from stickslip.engine.solver.compile import object_code
from stickslip.engine.solver.compile.programs import KERNELS, code_of
from stickslip.show import documents
from stickslip.show.documents import PRIVATE, is_free, private_folder

PACKAGE = Path(stickslip.__file__).parent

SYSTEMS = {
    "Windows": ("x86_64-pc-windows-msvc", "x86-64", ""),
    "macOS on Intel": ("x86_64-apple-darwin", "x86-64", ""),
    "macOS on Arm": ("arm64-apple-darwin", "generic", ""),
    "Linux on Arm": ("aarch64-unknown-linux-gnu", "generic", ""),
}
STANDARD = frozenset(
    [
        "acos",
        "asin",
        "asinh",
        "atan",
        "atan2",
        "ceil",
        "cos",
        "cosh",
        "exp",
        "expm1",
        "fabs",
        "floor",
        "fmod",
        "hypot",
        "log",
        "log1p",
        "log2",
        "memcpy",
        "memmove",
        "memset",
        "pow",
        "sin",
        "sinh",
        "sqrt",
        "tan",
        "tanh",
    ]
)
"""Functions of the C library that every system has."""
OF_SYSTEM = {"Windows": set[str](), "macOS": {"bzero"}, "Linux": {"sincos"}}
BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAWS = (
    Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01),
    LuGre(
        kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01,
        bristle_stiffness=1e5, bristle_damping=300.0,
    ),
)  # fmt: skip


def check_links(code: object_code.ObjectCode, system: str, standard: Set[str] = STANDARD) -> None:
    """Put object code of another system into memory, beside a C library that is empty.

    Names without an underscore are found in that of this process too.
    """
    binding.initialize_all_targets()
    binding.initialize_all_asmprinters()
    image = object_code._compiled(code.text(), SYSTEMS[system])
    under = "_" if system.startswith("macOS") else ""  # before each name in C
    there = standard | OF_SYSTEM[system.partition(" ")[0]]
    text = "".join(f"define void @{under}{name}() {{ ret void }}\n" for name in there)
    library = binding.JITLibraryBuilder().add_object_img(image)
    library = library.add_object_img(object_code._compiled(text))
    for symbol in code.symbols:
        library.export_symbol(under + symbol)
    linked = library.link(object_code._linker(), f"{code.name}.{system}.{len(standard)}")
    assert all(linked[under + symbol] for symbol in code.symbols)


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_equations_link_on_other_systems_with_the_standard_library_alone(system, law):
    check_links(code_of(formulate(BLOCK, law)), system)


@pytest.mark.slow
@pytest.mark.parametrize("system", SYSTEMS)
def test_kernels_link_on_other_systems_with_the_standard_library_alone(system):
    check_links(KERNELS, system)


def test_a_function_that_a_system_lacks_is_noticed():
    with pytest.raises(RuntimeError, match="Failed to materialize symbols"):
        check_links(code_of(formulate(BLOCK, LAWS[0])), "macOS on Arm", STANDARD - {"cos"})


PLACES = re.compile(r"/(bin|dev|etc|home|opt|proc|tmp|usr|var)(/|$)")
"""Beginnings of paths that Windows does not have, macOS partly."""


class PlacesOfPosix(ast.NodeVisitor):
    """What names a place of POSIX, or splits paths at colons, outside ``if sys.platform ...``."""

    def __init__(self) -> None:
        self.found: list[str] = []

    def visit_If(self, node: ast.If) -> None:
        if "sys.platform" not in ast.unparse(node.test):
            self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):  # a docstring
            self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, str) and PLACES.match(node.value):
            self.found.append(f"line {node.lineno}: {node.value!r}")

    def visit_Call(self, node: ast.Call) -> None:
        text = ast.unparse(node)
        if re.search(r"environ.*split\(':'\)|':'\.join\(.*(sys\.path|environ)", text):
            self.found.append(f"line {node.lineno}: {text}")
        self.generic_visit(node)


def places(text: str) -> list[str]:
    visitor = PlacesOfPosix()
    visitor.visit(ast.parse(text))
    return visitor.found


@for_all(sorted(PACKAGE.rglob("*.py")))
def test_no_place_of_posix_is_taken_for_granted(path: Path) -> None:
    assert not places(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "code",
    [
        'open("/tmp/x")',
        'Path("/proc") / "self"',
        'environ["PATH"].split(":")',
        '":".join(sys.path)',
    ],
)
def test_a_place_of_posix_is_noticed(code):
    assert places(code)
    assert not places(f'if sys.platform == "linux":\n    {code}')


WITHOUT_POSIX = """
import os, sys, types
import stickslip.cli.app, stickslip.engine.solver.compile.object_code as object_code
from stickslip.show import documents
locked = set()

class msvcrt(types.ModuleType):
    LK_NBLCK = 2
    @staticmethod
    def locking(file, mode, many):
        place = os.fstat(file).st_ino
        if place in locked:
            raise PermissionError(13, "Permission denied")
        locked.add(place)

sys.modules["msvcrt"] = msvcrt("msvcrt")
for name in ("fcntl", "grp", "pwd", "resource", "termios"):
    sys.modules[name] = None
for name in ("getuid", "geteuid", "getgid", "getegid", "fork", "nice", "killpg", "O_NONBLOCK",
             "O_NOFOLLOW"):
    delattr(os, name)
for module in (documents, object_code):
    module.sys = types.SimpleNamespace(platform="win32")
from stickslip.cli import main
for arguments in {arguments!r}:
    try:
        main(arguments)
    except SystemExit as leaving:
        if leaving.code:
            raise
"""
CAMPAIGN = """
rigs = "block.toml"
t_end = "1 s"
design = "sobol"
runs = 8
[factors]
friction.kinetic_coefficient = {low = 0.1, high = 0.3}
[outputs]
travel = {final = "x"}
"""


@pytest.mark.slow
def test_runs_reports_and_campaigns_need_no_posix(tmp_path):
    (tmp_path / "block.toml").write_text(BLOCK_RIG)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    arguments = [
        ["simulate", "block.toml", "-o", "run.csv", "--report"],
        ["simulate", "block.toml", "-o", "again.csv", "--report", "--force"],
        ["sweep", "campaign.toml"],
    ]
    code = textwrap.dedent(WITHOUT_POSIX).replace("{arguments!r}", repr(arguments))
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "stickslip-run" / "index.html").is_file()
    assert [*(tmp_path / "stickslip-campaign/runs").glob("*.parquet")]


@pytest.fixture
def windows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Take away locks and users of POSIX; give locks of Windows, which are made of the former.

    The folder is made before, by users.
    """
    fcntl = pytest.importorskip("fcntl", reason="Windows has its own locks")

    def locking(file: int, mode: int, many: int) -> None:
        assert (mode, many) == (2, 1)
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)

    locks = SimpleNamespace(LK_NBLCK=2, locking=locking)
    monkeypatch.setitem(sys.modules, "msvcrt", locks)
    monkeypatch.setattr(documents, "sys", SimpleNamespace(platform="win32"))
    monkeypatch.delattr(os, "getuid")


@pytest.mark.usefixtures("windows")
def test_a_lock_of_windows_is_held_until_its_file_is_closed(tmp_path):
    path = tmp_path / "lock"
    with path.open("wb") as one, path.open("rb") as other:
        assert is_free(one.fileno())
        assert not is_free(other.fileno())
    with path.open("rb") as third:
        assert is_free(third.fileno())


@pytest.mark.usefixtures("windows")
def test_what_a_killed_process_left_is_removed_and_what_another_holds_is_not(tmp_path, monkeypatch):
    monkeypatch.setattr(documents.tempfile, "tempdir", str(tmp_path))
    old = time.time() - 10.0 * documents.YOUNG
    for name in ("left", "held"):
        folder = tmp_path / f"{PRIVATE}{name}"
        folder.mkdir()
        (folder / ".lock").touch()
        (folder / "large").write_text("x")
        os.utime(folder, (old, old))
    with (tmp_path / f"{PRIVATE}held/.lock").open("rb") as lock:
        assert is_free(lock.fileno())
        with private_folder() as own:
            there = {*tmp_path.iterdir()}
    assert there == {tmp_path / f"{PRIVATE}held", own}
