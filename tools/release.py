"""Refuse a tag that is not the version; print its notes: python -m tools.release TAG.

The version stands in pyproject.toml, CITATION.cff, codemeta.json and recipe/recipe.yaml; its notes
are the section of CHANGELOG.md.
"""

import json
import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def versions() -> dict[str, str]:
    """Return the version by the file that states it."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    codemeta = json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))
    result = {"pyproject.toml": project["version"], "codemeta.json": codemeta["version"]}
    for name in ("CITATION.cff", "recipe/recipe.yaml"):
        text = (ROOT / name).read_text(encoding="utf-8")
        (result[name],) = re.findall(r"^\s*version: \"?([\d.]+)\"?$", text, re.MULTILINE)
    return result


def notes(version: str) -> str:
    """Return what the changelog says of a version; empty if it has no section."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    heading = re.compile(rf"^## \[{re.escape(version)}\].*$", re.MULTILINE)
    result = heading.search(text)
    return "" if result is None else text[result.end() :].partition("\n## [")[0].strip()


def main(tag: str) -> str | None:
    version = tag.removeprefix("v")
    wrong = [f"{name} has {item}" for name, item in versions().items() if item != version]
    if wrong:
        return f"The tag is {tag}, but {', '.join(wrong)}."
    if not notes(version):
        return f"CHANGELOG.md has no section [{version}]."
    print(notes(version))
    return None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
