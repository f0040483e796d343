"""Pages are run again when what they depend on has changed."""

from pathlib import Path
from types import ModuleType

import pytest
from tests.support import module_at

EXTENSION = Path(__file__).parents[2] / "docs/_ext/executed.py"


@pytest.fixture
def executed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The extension, in a project of one module."""
    pytest.importorskip("jupyter_cache", reason="documentation is built with the extra dev")
    own = ("src/package/module.py", "docs/_ext/examples.py", "docs/_ext/commands.py")
    for path in (tmp_path / one for one in own):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("one = 1\n")
    module = module_at(EXTENSION)
    monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(module, "EXTENSIONS", tmp_path / "docs/_ext")
    monkeypatch.setattr(module, "KEPT", tmp_path / "kept")
    return module


def test_what_was_printed_is_kept_while_nothing_changes(executed: ModuleType) -> None:
    folder = executed.kept()
    assert executed.kept() == folder
    assert Path(folder).is_dir()


@pytest.mark.parametrize("file", ["src/package/module.py", "src/package/new.py"])
def test_a_change_in_the_package_forgets_it(
    executed: ModuleType, tmp_path: Path, file: str
) -> None:
    before = executed.kept()
    (tmp_path / file).write_text("one = 2\n")
    after = executed.kept()
    assert after != before
    assert [str(path) for path in (tmp_path / "kept").iterdir()] == [after]


def test_records_that_are_elsewhere_forget_it(
    executed: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = executed.digest()
    monkeypatch.setenv("STICKSLIP_DATA", "elsewhere")
    assert executed.digest() != before


def test_how_examples_run_counts_and_what_python_writes_does_not(
    executed: ModuleType, tmp_path: Path
) -> None:
    before = executed.digest()
    (tmp_path / "src/package/__pycache__").mkdir()
    (tmp_path / "src/package/__pycache__/module.pyc").write_bytes(b"1")
    assert executed.digest() == before
    (tmp_path / "docs/_ext/examples.py").write_text("one = 3\n")
    assert executed.digest() != before
