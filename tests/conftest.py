import os
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings

os.environ.setdefault("MPLBACKEND", "Agg")
# generated modules of the tests stay out of the user's cache, and are shared by its processes
os.environ.setdefault("STICKSLIP_CACHE", str(Path(tempfile.gettempdir()) / "stickslip-tests"))

settings.register_profile("dev", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
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


@pytest.fixture(autouse=True, scope="session")
def sections_raise() -> None:
    """What fails in a section of a report becomes a line for users; in tests it is an error."""
    from stickslip.report.core import documents

    documents.CAUGHT = ()
