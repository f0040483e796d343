"""What is around the package: versions, recipe, workflows and site agree with the project."""

import csv
import importlib.util
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from benchmarks import ratios
from tests.support import for_all, module_at
from tools import release
from tools.package import FIRST, FOR_CONTRIBUTORS

from stickslip.cli.app import app

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = sorted(PROJECT["optional-dependencies"].keys() - FOR_CONTRIBUTORS)
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
GITHUB = sorted((ROOT / ".github").rglob("*.yml"))
ON_CONDA = {"matplotlib": "matplotlib-base", "symengine": "python-symengine"}
COMMANDS = {command.name for command in app.registered_commands}


def text_of(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_the_version_is_the_same_in_every_file() -> None:
    assert set(release.versions().values()) == {PROJECT["version"]}


def test_a_tag_is_refused_that_is_not_the_version_or_has_no_notes(monkeypatch, tmp_path, capsys):
    assert "but pyproject.toml has" in str(release.main("v99.0"))
    (tmp_path / "CHANGELOG.md").write_text("# Changelog\n\n## [Unreleased]\n\n- x\n")
    monkeypatch.setattr(release, "ROOT", tmp_path)
    monkeypatch.setattr(release, "versions", lambda: {"pyproject.toml": "1.2.0"})
    assert "has no section [1.2.0]" in str(release.main("v1.2.0"))
    (tmp_path / "CHANGELOG.md").write_text("## [1.2.0] of today\n\n- new\n\n## [1.1.0]\n\n- old\n")
    assert release.main("v1.2.0") is None
    assert capsys.readouterr().out == "- new\n"


def test_the_recipe_asks_for_what_the_wheel_asks_for() -> None:
    recipe = text_of("recipe/recipe.yaml")
    run = recipe.partition("  run:\n")[2].partition("\n\n")[0]
    asked = {line.strip("- ") for line in run.splitlines()} - {"python >=${{ python_min }}"}
    wanted = (re.fullmatch(r"([\w-]+)>=([\d.]+)", one) for one in PROJECT["dependencies"])
    names = {(entry[1], entry[2]) for entry in wanted if entry is not None}
    assert len(names) == len(PROJECT["dependencies"])
    there = {
        f"{ON_CONDA.get(name, name.replace('typing-', 'typing_'))} >={low}" for name, low in names
    }
    assert asked == there
    assert f'python_min: "{PROJECT["requires-python"].removeprefix(">=")}"' in recipe


def test_what_is_said_of_the_software_is_that_of_the_project() -> None:
    found = json.loads(text_of("codemeta.json"))
    assert found["description"] == PROJECT["description"]
    assert found["keywords"] == PROJECT["keywords"]
    assert found["license"].endswith(f"/{PROJECT['license']}")
    citation = text_of("CITATION.cff")
    assert f"license: {PROJECT['license']}\n" in citation


@for_all(GITHUB)
def test_a_workflow_calls_targets_and_modules_that_exist(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    for target in re.findall(r"\bmake (\w+)", text):
        assert re.search(rf"^{target}: ", MAKEFILE, re.MULTILINE), target
    for module in re.findall(r"python -m ((?:tools|benchmarks)[\w.]*)", text):
        assert importlib.util.find_spec(module), module
    for command in re.findall(r"\bstickslip (\w+) ", text):
        assert command in COMMANDS, command
    for listed in re.findall(r"\.\[([\w,]+)\]", text):
        assert set(listed.split(",")) <= PROJECT["optional-dependencies"].keys()


@for_all(GITHUB)
def test_a_workflow_is_yaml_with_least_permissions(path: Path) -> None:
    yaml = pytest.importorskip("yaml", reason="PyYAML comes with the extra dev")
    found = yaml.safe_load(path.read_text(encoding="utf-8"))
    if path.parent.name == "workflows":
        assert found["permissions"] == {"contents": "read"}
        for job in found["jobs"].values():
            assert "uses" in job or job["timeout-minutes"] <= 350
            run = " ".join(step.get("run", "") for step in job.get("steps", ()))
            if job.get("permissions", {}).get("contents") == "write":  # what is installed runs code
                assert not re.search(r"\b(pip|make|pytest)\b", run)


def test_the_files_that_are_published_are_those_that_were_tested() -> None:
    yaml = pytest.importorskip("yaml", reason="PyYAML comes with the extra dev")
    tests, release = (
        yaml.safe_load(text_of(f".github/workflows/{name}.yml"))["jobs"]
        for name in ("tests", "release")
    )
    package, describe = tests["package"]["steps"], release["describe"]["steps"]
    (kept,) = [step["with"]["name"] for step in package if "upload" in step.get("uses", "")]
    (taken,) = [step["with"]["name"] for step in describe if "download" in step.get("uses", "")]
    assert taken == kept
    assert release["describe"]["needs"] == "tests"
    assert release["publish"]["needs"] == "describe"
    assert not re.search(r"-m (build|tools\.package)\b", text_of(".github/workflows/release.yml"))


def test_ratios_of_a_night_are_of_errors_found_in_that_night() -> None:
    text = text_of(".github/workflows/nightly.yml")
    (made,) = re.findall(r"benchmarks\.friction .*--output (\S+)", text)
    assert f"benchmarks.ratios --friction {made}/results.csv --output" in text


def test_all_extras_are_tested_at_their_bounds_and_described() -> None:
    (line,) = re.findall(r"^EXTRAS := (.*)$", MAKEFILE, re.MULTILINE)
    assert sorted(line.split()) == EXTRAS
    page = text_of("docs/howto/install.md")
    assert re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE) == EXTRAS
    assert f"with {len(EXTRAS)} extras" in text_of("README.md")


def test_the_first_commands_of_the_readme_are_those_that_the_package_is_tried_with() -> None:
    found = FIRST.search(text_of("README.md"))
    assert found is not None
    first, *others = [line.partition("#")[0].split() for line in found[1].splitlines()]
    assert first == ["pip", "install", "-c", "constraints.txt", "-e", "."]
    assert all(name == "stickslip" and words[0] in COMMANDS for name, *words in others)


def test_the_paper_has_the_length_and_the_sources_that_its_journal_asks_for() -> None:
    body = text_of("paper/paper.md").split("---\n", 2)[2]
    assert 750 <= len(body.split()) <= 1750
    known = set(re.findall(r"^@\w+\{(\w+),$", text_of("paper/paper.bib"), re.MULTILINE))
    assert set(re.findall(r"@(\w+)", body)) == known
    headings = re.findall(r"^# (.*)$", body, re.MULTILINE)
    assert headings == [
        "Summary",
        "Statement of need",
        "State of the field",
        "Software design",
        "Research impact statement",
        "AI usage disclosure",
        "Acknowledgements",
        "References",
    ]


PAGES = {
    "index.html": '<a href="a/b.html#there">b</a><a href="https://x.y/z">z</a><img src="i.svg">',
    "a/b.html": '<p id="there"><a href="../index.html"></a><a href="#there"></a></p>',
    "search.html": "",
    "i.svg": "",
}


def put(folder: Path, pages: dict[str, str]) -> Path:
    for name, text in pages.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def run_site(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "tools.site", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_the_site_leads_to_the_newest_release(tmp_path):
    built = put(tmp_path / "built", PAGES)
    for version in ("dev", "0.9.0", "0.10.0"):
        done = run_site(built, tmp_path / "site", version, "--address", "https://x.y/s/")
        assert done.returncode == 0, done.stderr
    there = {path.name for path in (tmp_path / "site").iterdir()}
    assert {"dev", "0.9.0", "0.10.0", "404.html", "sitemap.xml", "versions.html"} < there
    first = (tmp_path / "site/index.html").read_text()
    assert "url=0.10.0/index.html" in first
    assert re.findall(r'href="([\w.]+)/index', first) == ["0.10.0", "0.9.0", "dev"]
    assert "<loc>https://x.y/s/0.10.0/a/b.html</loc>" in (tmp_path / "site/sitemap.xml").read_text()
    offline = module_at(ROOT / "docs/check_offline.py")
    assert offline.main(tmp_path / "site") is None


@pytest.mark.parametrize("link", ["nowhere.html", "a/b.html#nowhere", "#nowhere", "../out.html"])
def test_a_link_that_leads_nowhere_is_refused_before_anything_is_written(tmp_path, link):
    built = put(tmp_path / "built", PAGES | {"index.html": f'<a href="{link}">x</a>'})
    done = run_site(built, tmp_path / "site", "1.0")
    assert done.returncode == 1
    assert f"index.html: {link}" in done.stderr
    assert not (tmp_path / "site").exists()


RESULTS = """task,tool,error,unit,named
axis,stickslip,2.0,m,False
axis,stickslip,3.0,m,True
axis,scipy,6.0,m,False
free,stickslip,2.0,m,False
free,stickslip,4.0,m,False
free,scipy,1.0,m,False
free,lmfit,,m,False
"""


def test_ratios_of_errors_are_those_of_the_named_law_or_of_the_least(tmp_path):
    (tmp_path / "results.csv").write_text(RESULTS)
    found = {
        (error["task"], error["peer"]): error["ratio"]
        for error in ratios.errors(tmp_path / "results.csv")
    }
    assert found == {("axis", "scipy"): "2", ("free", "scipy"): "0.5"}


def test_ratios_of_each_version_stand_beside_each_other(tmp_path):
    for version, value in (("0.1.0", 4.0), ("0.2.0", 8.0)):
        with (tmp_path / f"{version}.csv").open("w", newline="") as file:
            writer = csv.DictWriter(file, ratios.FIELDS)
            writer.writeheader()
            writer.writerow(ratios.row("time", "decay", "scipy", 1.0, value, "s"))
    head, _, line = ratios.beside(tmp_path)
    assert head.split("|")[4:6] == [" 0.1.0 ", " 0.2.0 "]
    assert [text.strip() for text in line.split("|")[4:6]] == ["4.0", "8.0"]


def test_the_page_of_ratios_is_made_of_the_files_of_all_versions() -> None:
    page = text_of("docs/ratios.md").splitlines()
    assert page == ratios.beside(ROOT / "docs/_static/ratios")
    assert PROJECT["version"] in page[0]
