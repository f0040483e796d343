"""`stickslip` and kernels of examples: each runs in a copy of one process that has all loaded.

Most of what a short page takes is its start: modules to import, machine code to load.
"""

import contextlib
import json
import os
import select
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path

WARMED = ("simulate", "demo", "--json")
"""Command that loads what most others need."""
LOADED = (
    "ipykernel.kernelapp",
    "matplotlib.pyplot",
    "pandas",
    "scipy.stats",
    "stickslip",
    "stickslip.show.plots.dispatch",
    *(f"stickslip.cli.{name}" for name in ("judge", "check", "console")),
)
"""Modules that it leaves out, with all that they load when asked."""
KERNEL = {
    "display_name": "Python 3",
    "interrupt_mode": "message",  # a signal would reach the caller only
    "language": "python",
}
"""What is said of a kernel beside how it is started."""
WAITS = 2.0
"""Time after which it is looked whether whoever started the process is still there [s]."""
CALLER = """\
#!{python} -IS
import json, os, socket, sys
with socket.socket(socket.AF_UNIX) as one:
    one.connect({place!r})
    asked = json.dumps([sys.argv, os.getcwd(), dict(os.environ)]).encode()
    socket.send_fds(one, [len(asked).to_bytes(8, "big")], [0, 1, 2])
    one.sendall(asked)
    code = one.recv(8)
sys.exit(int(code) if code else 1)
"""


@contextlib.contextmanager
def commands(folder: Path) -> Iterator[None]:
    """Put command and kernel into a folder, which the process behind them serves."""
    place = folder / "socket"
    for caller in (folder / "stickslip", folder / "kernel"):
        caller.write_text(CALLER.format(python=sys.executable, place=str(place)), encoding="utf-8")
        caller.chmod(0o755)
    kernel = folder / "kernels" / "python3"
    kernel.mkdir(parents=True)
    started = [sys.executable, "-IS", str(folder / "kernel"), "-f", "{connection_file}"]
    (kernel / "kernel.json").write_text(json.dumps(KERNEL | {"argv": started}), encoding="utf-8")
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(place))
        listener.listen(64)
        given = listener.fileno()
        process = subprocess.Popen([sys.executable, __file__, str(given)], pass_fds=[given])
    try:
        yield
    finally:
        process.terminate()
        process.wait()


def serve(listener: socket.socket) -> None:
    """Run commands until the process that asked for this one has ended; load at the first."""
    parent, loaded = os.getppid(), False
    while os.getppid() == parent:
        asked = select.select([listener], [], [], WAITS)[0]
        with contextlib.suppress(ChildProcessError):  # copies that have ended leave nothing behind
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        if not asked:
            continue
        connection, _ = listener.accept()
        if not loaded:
            _load()
            loaded = True
        if os.fork() == 0:
            listener.close()
            _answer(connection)
        connection.close()


def _load() -> None:
    """Load package and machine code; the copies share it."""
    background = os.environ.get("STICKSLIP_BACKGROUND")
    os.environ["STICKSLIP_BACKGROUND"] = "0"  # a copy of a process has none of its threads
    with (
        Path(os.devnull).open("w") as nothing,
        contextlib.redirect_stdout(nothing),
        contextlib.redirect_stderr(nothing),
    ):
        _run("stickslip", WARMED)
    for name in LOADED:
        __import__(name, fromlist=["*"])
    # what pandas sets if it is loaded in a kernel
    sys.modules["pandas"].set_option("display.max_columns", 20)
    del os.environ["STICKSLIP_BACKGROUND"]
    if background is not None:
        os.environ["STICKSLIP_BACKGROUND"] = background


def _run(name: str, arguments: Sequence[str]) -> int:
    """Run a command or a kernel, which ends with the process that it is a copy of."""
    from stickslip.cli import main

    if name == "kernel":
        from ipykernel.kernelapp import launch_new_instance

        launch_new_instance([*arguments, f"--IPKernelApp.parent_handle={os.getppid()}"])
        return 0
    try:
        return main(arguments)
    except SystemExit as leaving:
        return leaving.code if isinstance(leaving.code, int) else int(leaving.code is not None)


def _answer(connection: socket.socket) -> None:
    """Run what is asked for as if it had been started there, and end with its code."""
    size, files, _, _ = socket.recv_fds(connection, 8, 3)
    asked = b""
    while len(asked) < int.from_bytes(size, "big"):
        asked += connection.recv(1 << 16)
    (called, *arguments), folder, environment = json.loads(asked)
    threading.Thread(target=_end_with, args=[connection], daemon=True).start()
    for target, file in enumerate(files):
        os.dup2(file, target)
        os.close(file)
    sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115  # to the end
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", closefd=False, buffering=1)  # noqa: SIM115
    name = Path(called).name
    sys.argv = [name, *arguments]
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    code = 1
    try:
        code = _run(name, arguments)
        sys.stdout.flush()
    finally:
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.flush()
        connection.sendall(str(code).encode())
        os._exit(code)


def _end_with(caller: socket.socket) -> None:
    """End as what was started there does, if whoever asked for it is killed."""
    caller.recv(1)
    os._exit(1)


if __name__ == "__main__":
    # an example does not see what is beside this file
    sys.path[:] = [one for one in sys.path if one != str(Path(__file__).parent)]
    serve(socket.socket(fileno=int(sys.argv[1])))
