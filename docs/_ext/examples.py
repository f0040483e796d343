"""Where examples run: this environment's command, a plain terminal, nobody's IPython profile."""

import logging
import os
import sys
import tempfile
from pathlib import Path

from sphinx.application import Sphinx

CONFIGURATION = """\
c = get_config()
c.InteractiveShell.xmode = "Minimal"  # an error is its message
c.IPKernelApp.log_level = "ERROR"
"""
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
    folder = tempfile.TemporaryDirectory()
    app.connect("build-finished", lambda *_: folder.cleanup())
    profile = Path(folder.name) / "profile_default"
    (profile / "startup").mkdir(parents=True)
    (profile / "ipython_kernel_config.py").write_text(CONFIGURATION, encoding="utf-8")
    (profile / "startup" / "sh.py").write_text(STARTUP, encoding="utf-8")
    commands = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    os.environ |= {"IPYTHONDIR": folder.name, "PATH": commands}
    os.environ |= {"COLUMNS": "96", "NO_COLOR": "1", "TERM": "dumb"}
    logging.getLogger("traitlets").setLevel(logging.WARNING)  # a line for each kernel
    return {"parallel_read_safe": True, "parallel_write_safe": True}
