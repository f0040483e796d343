"""Tutorials as notebooks to download, made of their pages when these are built."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import nbformat
from docutils import nodes
from myst_nb.core.read import read_myst_markdown_notebook
from sphinx.application import Sphinx

FOLDER = "tutorials/"
CELLS = "```{code-cell}"
ROLE = re.compile(r"\{([a-z:]+)\}`([^`]*)`")
TARGET = re.compile(r"(?P<text>.*?)\s*<(?P<target>.*)>", re.DOTALL)
DIRECTIVE = re.compile(r"^```\{([a-z-]+)\} *([^\n]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
OPTION = re.compile(r"^:[a-z-]+:.*\n", re.MULTILINE)

Title = Callable[[str], str]
"""Gives the title of a page by its name, such as "howto/plan"."""


def role(kind: str, text: str, page: str, title: Title) -> str:
    """Return what a role shows, as Markdown that needs no Sphinx."""
    given = TARGET.fullmatch(text)
    target = given["target"] if given else text
    if kind == "doc":
        name = target[1:] if target.startswith("/") else str(Path(page).parent / target)
        return given["text"] if given else f"*{title(name)}*"
    if kind == "math":
        return f"${text}$"
    if kind == "cite":
        return f"[{text}]"
    if kind == "download":
        return f"`{Path(target).name}`"
    if kind == "py:obj":
        return f"`{given['text'] if given else text.removeprefix('~stickslip.')}`"
    raise ValueError(f"role {kind!r} has no counterpart in a notebook")


def directive(kind: str, argument: str, body: str, folder: Path) -> str:
    """Return what a directive shows, as Markdown that needs no Sphinx."""
    body = OPTION.sub("", body).strip()
    if kind == "literalinclude":
        return f"```\n{(folder / argument).read_text(encoding='utf-8').strip()}\n```"
    if kind in {"note", "warning"}:
        return "\n".join(f"> {line}".rstrip() for line in body.splitlines())
    if kind == "figure":
        return body
    raise ValueError(f"directive {kind!r} has no counterpart in a notebook")


def notebook(text: str, page: str, source: Path, title: Title) -> nbformat.NotebookNode:
    """Return a page as a notebook without results.

    Parameters
    ----------
    text : str
        The page, with its head.
    page : str
        Its name, such as ``"tutorials/emps-axis"``.
    source : Path
        Folder of all pages.
    title : callable
        Gives the title of another page.
    """
    folder = (source / page).parent
    made = read_myst_markdown_notebook(text)
    for index, cell in enumerate(made.cells):
        cell["id"] = f"cell-{index}"  # those of nbformat are drawn at random
        if cell["cell_type"] == "markdown":
            plain = DIRECTIVE.sub(lambda m: directive(m[1], m[2], m[3], folder), cell["source"])
            cell["source"] = ROLE.sub(lambda m: role(m[1], m[2], page, title), plain)
    made["metadata"] = {
        "kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"},
        "language_info": {"name": "python"},
    }
    nbformat.validate(made)
    return made


def offer(app: Sphinx, tree: nodes.document) -> None:
    """Put the link to its notebook below the title of a tutorial."""
    page = app.env.docname
    if page.startswith(FOLDER) and CELLS in app.env.doc2path(page).read_text(encoding="utf-8"):
        name = f"{Path(page).name}.ipynb"
        link = nodes.reference("", "Download this page as a notebook", refuri=name)
        section = next(iter(tree.findall(nodes.section)), None)
        if section is not None:
            section.insert(1, nodes.paragraph("", "", link, nodes.Text(".")))


def write(app: Sphinx, failed: Exception | None) -> None:
    """Write the notebooks beside the pages."""
    if failed is not None or app.builder.format != "html":
        return
    for page in sorted(app.env.found_docs):
        text = app.env.doc2path(page).read_text(encoding="utf-8")
        if not page.startswith(FOLDER) or CELLS not in text:
            continue
        made = notebook(text, page, Path(app.srcdir), lambda name: app.env.titles[name].astext())
        path = Path(app.outdir) / f"{page}.ipynb"
        path.parent.mkdir(parents=True, exist_ok=True)
        nbformat.write(made, path)


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("doctree-read", offer)
    app.connect("build-finished", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
