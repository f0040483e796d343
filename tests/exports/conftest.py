"""FMUs that several files of tests run, made once."""

from pathlib import Path

import pytest
from tests.exports.fmus import BLOCK, CAPSULE, COULOMB, LUGRE, made, need_tools


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need_tools()
    return tmp_path_factory.mktemp("fmu")


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need_tools()
    return tmp_path_factory.mktemp("shared")


@pytest.fixture(scope="session")
def block(shared: Path) -> Path:
    return made(shared, "block", BLOCK, COULOMB)


@pytest.fixture(scope="session")
def capsule(shared: Path) -> Path:
    return made(shared, "capsule", CAPSULE, LUGRE, fmi=2)
