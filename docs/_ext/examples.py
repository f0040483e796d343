"""Where examples run: this environment's command, a plain terminal, nobody's IPython profile."""

import contextlib
import logging
import os
import sys
import tempfile
from pathlib import Path

import commands
from sphinx.application import Sphinx

CONFIGURATION = """\
c = get_config()
c.InteractiveShell.xmode = "Minimal"  # an error is its message
c.IPKernelApp.log_level = "ERROR"
"""
INLINE = "module://matplotlib_inline.backend_inline"
"""What a kernel sets, which is too late where Matplotlib is loaded before."""
STARTUP = '''\
import subprocess

from IPython.core.magic import register_cell_magic


@register_cell_magic
def sh(_, cell):
    """Show what a script printed at once; the usual magic cuts it into pieces."""
    done = subprocess.run(["sh", "-c", cell], capture_output=True, encoding="utf-8")
    print(done.stdout + done.stderr, end="")
'''


def setup(app: Sphinx) -> dict[str, bool]:
    until_finished = contextlib.ExitStack()
    folder = Path(until_finished.enter_context(tempfile.TemporaryDirectory()))
    app.connect("build-finished", lambda *_: until_finished.close())
    (folder / "bin").mkdir()
    places = [str(folder / "bin"), str(Path(sys.executable).parent), os.environ["PATH"]]
    os.environ |= {"IPYTHONDIR": str(folder), "PATH": os.pathsep.join(places)}
    os.environ |= {"COLUMNS": "96", "NO_COLOR": "1", "TERM": "dumb"}
    os.environ |= {"JUPYTER_PATH": str(folder / "bin"), "MPLBACKEND": INLINE}
    until_finished.enter_context(commands.commands(folder / "bin"))
    profile = folder / "profile_default"
    (profile / "startup").mkdir(parents=True)
    (profile / "ipython_kernel_config.py").write_text(CONFIGURATION, encoding="utf-8")
    (profile / "startup" / "sh.py").write_text(STARTUP, encoding="utf-8")
    logging.getLogger("traitlets").setLevel(logging.WARNING)  # a line for each kernel
    return {"parallel_read_safe": True, "parallel_write_safe": True}
