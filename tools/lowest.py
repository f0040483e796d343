"""Print the lowest versions that pyproject.toml allows, as requirements: lowest.py EXTRA ...

Only the direct dependencies of the package and of the extras that are named: what these depend on
is the newest that they allow. A bound has to be a version that exists, or pip finds none.
"""

import re
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path

BOUND = re.compile(r"(?P<name>[\w.-]+(\[[\w,-]+\])?)>=(?P<version>[\d.]+)(?P<marker>\s*;.*)?")
PYPROJECT = Path(__file__).resolve().parent.parent / "pyproject.toml"


def lowest(extras: Sequence[str]) -> list[str]:
    """Return a requirement of exactly the lowest version for each dependency."""
    project = tomllib.loads(PYPROJECT.read_text(encoding="utf-8"))["project"]
    optional = project["optional-dependencies"]
    given = [*project["dependencies"], *(line for extra in extras for line in optional[extra])]
    result = []
    for line in given:
        bound = BOUND.fullmatch(line)
        if bound is None:
            sys.exit(f"{PYPROJECT.name}: {line!r} must be NAME>=VERSION, whose version is tested.")
        result.append(f"{bound['name']}=={bound['version']}{bound['marker'] or ''}")
    return result


if __name__ == "__main__":
    print(*lowest(sys.argv[1:]), sep="\n")
