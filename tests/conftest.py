import functools
import gc
import os
import pickle
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from tests.support import sketched

os.environ.setdefault("MPLBACKEND", "Agg")
# Generated modules of the tests stay out of the user's cache, and are shared by its processes.
# Hypothesis looks for constants in all modules but those in a folder of this name: of hundreds of
# generated ones that takes half a minute.
CACHE = Path(tempfile.gettempdir()) / "stickslip" / "tests"
os.environ.setdefault("STICKSLIP_CACHE", str(CACHE))

os.environ.setdefault("STICKSLIP_BACKGROUND", "0")

settings.register_profile("dev", deadline=None, max_examples=25)
settings.register_profile("ci", deadline=None, max_examples=25, derandomize=True)
settings.register_profile("thorough", deadline=None, derandomize=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "dev"))


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Folder of measured records; without it tests are skipped, or fail under REQUIRE_DATA=1."""
    value = os.environ.get("STICKSLIP_DATA", "")
    folder = Path(value)
    if value and folder.is_dir():
        return folder
    reason = f"STICKSLIP_DATA names no folder of measured records, got {value!r}."
    if os.environ.get("REQUIRE_DATA") == "1":
        pytest.fail(reason)
    pytest.skip(reason)


def pytest_collection_finish() -> None:
    """Look for garbage less often, and not among what stays: thousands of tests, all modules."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 50)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup() -> None:
    """Let a section of a report that fails raise in tests; for users it becomes one line.

    Hooks of set-up and teardown hold for this folder alone: the examples in docstrings, which may
    run in the same process, see what users see.
    """
    from stickslip.show.report import blocks

    blocks.CAUGHT = ()


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown() -> None:
    from stickslip.show.report import blocks

    blocks.CAUGHT = (Exception,)


@pytest.fixture
def sketches() -> Iterator[None]:
    """Leave out what makes text of a drawing: other tests look at the figures of pages."""
    with sketched():
        yield


@pytest.fixture(autouse=True)
def no_figure_is_left() -> Iterator[None]:
    """Close figures before a test too: examples in docstrings leave some in the same process."""
    _close_figures()
    yield
    _close_figures()


@pytest.fixture(autouse=True, scope="module")
def what_a_module_keeps_ends_with_it(request: pytest.FixtureRequest) -> Iterator[None]:
    """Clear caches of functions of a test module: verdicts in them are of no use to the next."""
    yield
    for value in vars(request.module).values():
        if hasattr(value, "cache_clear") and value.__module__ == request.module.__name__:
            value.cache_clear()


def _close_figures() -> None:
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close("all")


PARTS_OF_THE_AUDIT = ("requirements", "step_travels", "consequences", "bristle_rows")
"""What takes long of the audit of the paper, which many commands on the bundled rig make."""


@pytest.fixture(autouse=True, scope="session")
def parts_of_the_audit_are_made_once() -> None:
    """Keep what follows from the paper's numbers alone, for all pages of a session."""
    from stickslip.paper import printed

    for name in PARTS_OF_THE_AUDIT:
        setattr(printed, name, _remembered(getattr(printed, name)))


def _remembered(function: Callable[..., Any]) -> Callable[..., Any]:
    made: dict[bytes, Any] = {}

    @functools.wraps(function)
    def call(*arguments: Any, **settings: Any) -> Any:
        key = pickle.dumps((arguments, settings))
        if key not in made:
            made[key] = function(*arguments, **settings)
        return made[key]

    return call
