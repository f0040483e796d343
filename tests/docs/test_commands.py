"""Commands and kernels of examples, copies of one process, do what they do when started alone."""

import importlib.util
import os
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.support import BLOCK_RIG

EXTENSION = Path(__file__).parents[2] / "docs/_ext/commands.py"
Shell = Callable[[str], tuple[int, str, str]]


@pytest.fixture(scope="module")
def shell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shell]:
    """Run a script of the shell in a folder with a rig."""
    pytest.importorskip("ipykernel", reason="documentation is built with the extra dev")
    spec = importlib.util.spec_from_file_location("commands", EXTENSION)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    folder, own = tmp_path_factory.mktemp("bin"), tmp_path_factory.mktemp("example")
    (own / "rig.toml").write_text(BLOCK_RIG)
    environment = os.environ | {"PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}

    def run(script: str) -> tuple[int, str, str]:
        done = subprocess.run(
            ["sh", "-c", script], cwd=own, env=environment, capture_output=True, check=False
        )
        return done.returncode, done.stdout.decode(), done.stderr.decode()

    with module.commands(folder), pytest.MonkeyPatch.context() as own_environment:
        own_environment.setenv("JUPYTER_PATH", str(folder))
        own_environment.setenv("IPYTHONDIR", str(own / "ipython"))
        yield run


def test_a_command_reads_and_writes_in_the_folder_of_its_example(shell: Shell) -> None:
    code, out, _ = shell("stickslip simulate rig.toml -o run.csv > seen.txt && ls")
    assert (code, out.split()) == (0, ["rig.toml", "run.csv", "seen.txt"])


def runs(number: int) -> bool:
    """Whether there is a process of a number."""
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.usefixtures("shell")
@pytest.mark.slow
def test_a_kernel_runs_in_the_folder_of_its_page_and_ends_with_whoever_started_it(
    tmp_path: Path,
) -> None:
    from jupyter_client import KernelManager

    manager = KernelManager(kernel_name="python3")
    (tmp_path / "beside.py").write_text("name = __name__")
    manager.start_kernel(cwd=str(tmp_path))
    client = manager.blocking_client()
    client.start_channels()
    try:
        client.wait_for_ready()
        script = "import os, beside; open('seen', 'w').write(f'{os.getpid()} {beside.name}')"
        client.execute_interactive(script)
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)  # kills the caller, which is all that Jupyter knows
    number, name = (tmp_path / "seen").read_text().split()
    assert name == "beside"
    until = time.monotonic() + 600.0  # a loaded machine takes a while
    while (there := runs(int(number))) and time.monotonic() < until:
        time.sleep(0.02)
    assert not there
