"""Golden files: what the public commands write for rigs and records, kept to compare with.

``python -m benchmarks.golden record FOLDER`` runs the commands of every case of
`benchmarks.golden_cases` in a temporary folder and keeps in ``FOLDER/<case>/``, as plain text:

* what each command printed, with its exit code (``<command>.txt``; ``<command>.json`` for JSON),
* every file that it wrote: verdicts and checks (JSON), laws (TOML), simulated runs (CSV, at most
  200 rows) and the text of pages: headings, a sentence a line, tables as rows, titles of figures.

``python -m benchmarks.golden compare FOLDER`` runs them again and prints a unified diff of each
case, how many lines differ, and the largest relative difference between numbers in JSON. The exit
code is 1 if anything differs or a case fails; a case that fails does not stop the others.

Numbers in sentences stay as printed; those in JSON, TOML and CSV are rounded to 9 significant
digits. Versions, hashes, dates, paths and progress are replaced or dropped. Results are the same
to the last digit on one machine; another processor rounds otherwise, and searches amplify that, so
record on the commit before a change, or compare with ``--rtol 1e-6``, which takes lines for equal
whose numbers differ by less.

Golden files are recorded on the commit before a change and are not kept. Records come from the
folder that ``STICKSLIP_DATA`` names.
"""

import argparse
import difflib
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import stickslip
from benchmarks.golden_cases import CASES, PYTHON, Case, Command

ROOT = Path(__file__).parents[1]
DIGITS = 9
"""Significant digits of numbers that programs read."""
ROWS = 200
"""Rows of a simulated run that are kept, evenly spaced."""
PATIENCE = 900.0
"""Longest that a command may take [s]."""
WIDTH = "400"
"""Columns of the terminal: a remark is one line, so that a word that changes does not rewrap it."""
SHOWN = 80
"""Lines of a file's diff that are printed unless `--lines` says otherwise."""

NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
NOISE = (
    # two dots make a version, of which no number has more than one
    (re.compile(r"(?<![\w.])\d+\.\d+\.\d+(?:[.\w+-]*\w)?"), "<version>"),
    (re.compile(r"(?<!\w)[0-9a-f]{40}(?:[0-9a-f]{24})?(?!\w)"), "<hash>"),
    (re.compile(r"(?<![\w-])\d{4}-\d\d-\d\d(?:[T ]\d\d:\d\d(?::\d\d)?\S*)?"), "<date>"),
)
PROGRESS = re.compile(r" \.\.\.$")
"""Ends what a command says that it does now."""
PREPARING = threading.Lock()
"""Records are made one at a time; the commands are processes of their own."""
SENTENCE = re.compile(r"(?<=[a-z0-9%)”][.?!]) (?=[A-Z“])")


def plain(text: str, places: Mapping[str, str]) -> str:
    """Return text without what differs between two runs of the same code.

    Examples
    --------
    >>> plain("stickslip 0.1.0 wrote /tmp/a/law.toml: mu_k = 0.2548", {"/tmp/a": "<folder>"})
    'stickslip <version> wrote <folder>/law.toml: mu_k = 0.2548'
    """
    for place in sorted(places, key=len, reverse=True):
        text = text.replace(place, places[place])
    for pattern, name in NOISE:
        text = pattern.sub(name, text)
    return text


def rounded(text: str) -> str:
    """Return text with its numbers at `DIGITS` significant digits, where they have more.

    Examples
    --------
    >>> rounded("0.0,0.25484199796151420,1e-05")
    '0.0,0.254841998,1e-05'
    """

    def shorter(match: re.Match[str]) -> str:
        digits = re.sub(r"[eE].*|\D", "", match[0]).lstrip("0")
        return match[0] if len(digits) <= DIGITS else f"{float(match[0]):.{DIGITS}g}"

    return NUMBER.sub(shorter, text)


def json_text(text: str) -> str:
    """Return a JSON document a key a line, lists of numbers in one line, numbers rounded."""

    def brief(value: Any) -> Any:
        if isinstance(value, float) and math.isfinite(value):
            return float(f"{value:.{DIGITS}g}")
        if isinstance(value, list):
            return [brief(item) for item in value]
        if isinstance(value, dict):
            return {key: brief(item) for key, item in value.items()}
        return value

    spread = json.dumps(brief(json.loads(text)), indent=1, ensure_ascii=False)
    return re.sub(
        r"\[\s+([^\[\]{}\"]+?)\s+\]", lambda item: f"[{' '.join(item[1].split())}]", spread
    )


def csv_text(text: str) -> str:
    """Return a table with at most `ROWS` evenly spaced rows, the first and last among them."""
    head, *rows = text.splitlines()
    if len(rows) > ROWS:
        rows = [rows[round(k * (len(rows) - 1) / (ROWS - 1))] for k in range(ROWS)]
    return rounded("\n".join([head, *rows]))


class Page(HTMLParser):
    """The text of an HTML page, a block or a sentence a line."""

    # fmt: off
    BLOCKS = frozenset((
        "h1", "h2", "h3", "h4", "h5", "h6", "p", "li", "dt", "dd", "pre", "caption", "figcaption",
        "figure", "header", "footer", "nav", "section", "div", "table", "tr", "summary", "details",
        "title",
    ))
    # fmt: on
    CELLS = frozenset(("td", "th"))
    VOID = frozenset(("br", "img", "meta", "link", "input", "hr", "source", "wbr"))
    HIDDEN = frozenset(("style", "script", "svg", "nav"))

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []
        self._text = ""
        self._hidden = 0
        """Open tags since what is not shown began."""
        self._row = False
        self._pre = False
        self._numbered = False
        """In a list of references, whose abbreviations would be taken for ends of sentences."""

    def handle_starttag(self, tag: str, attrs: Sequence[tuple[str, str | None]]) -> None:
        own = dict(attrs)
        if self._hidden:
            self._hidden += tag not in self.VOID
        elif tag in self.HIDDEN or own.get("aria-hidden") == "true":
            if tag == "svg":
                self._figure(own.get("aria-label"))
            self._hidden = 1
        elif tag == "img":
            self._figure(own.get("alt"))
        elif tag == "ol":
            self._numbered = True
        elif tag == "tr":
            self._flush()
            self._row = True
        elif tag in self.CELLS:
            self._text += " | "
        elif tag in self.BLOCKS and not self._row:
            self._flush()
            self._pre = tag == "pre"
            self._text = "#" * int(tag[1]) + " " if re.fullmatch(r"h\d", tag) else ""
            self._text += {"li": "- ", "dd": ": "}.get(tag, "")
        elif tag in self.BLOCKS or tag == "br" or tag.startswith("m"):
            self._text += " "  # elements of a formula, too
        else:
            self._text += {"sub": "_", "sup": "^", "span": " "}.get(tag, "")

    def handle_endtag(self, tag: str) -> None:
        if tag in self.VOID:
            return
        if self._hidden:
            self._hidden -= 1
        elif tag == "ol":
            self._numbered = False
        elif tag == "tr":
            self._text += " |"
            self._flush()
            self._row = False
        elif tag in self.BLOCKS and not self._row:
            self._flush()
            self._pre = False

    def handle_data(self, data: str) -> None:
        if not self._hidden:
            self._text += data

    def _figure(self, title: str | None) -> None:
        line = f"[figure: {title or 'without a title'}]"
        if self._row:
            self._text += f" {line}"
            return
        self._flush()
        if self.lines[-1:] != [line]:  # one for wide and one for narrow screens
            self.lines.append(line)

    def _flush(self) -> None:
        if self._pre:
            self.lines += [line.rstrip() for line in self._text.strip("\n").splitlines()]
        else:
            words = " ".join(self._text.split())
            if words.strip("#-: "):
                whole = self._row or self._numbered or words.startswith("#")
                first, *more = [words] if whole else SENTENCE.split(words)
                indent = "  " if first.startswith("- ") else ""
                self.lines += [first, *(indent + sentence for sentence in more)]
        self._text = ""


def page_text(text: str) -> str:
    """Return the text of a page.

    Examples
    --------
    >>> print(page_text("<h2>Runs</h2><p>One. <b>Two</b> of <i>x</i><sub>0</sub>.</p>"))
    ## Runs
    One.
    Two of x_0.
    """
    page = Page()
    page.feed(text)
    page.close()
    page._flush()
    return "\n".join(page.lines)


FORMS = {
    ".json": json_text, ".csv": csv_text, ".toml": rounded, ".html": page_text,
    **dict.fromkeys((".h", ".c", ".m", ".mo", ".xml", ".urdf"), rounded),
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Output:
    """What a case wrote, or why it failed."""

    case: str
    files: Mapping[str, str]
    seconds: float
    failure: str = ""


def run(case: Case) -> Output:
    """Run a case in a temporary folder."""
    began = time.perf_counter()
    files: dict[str, str] = {}
    failure = ""
    with tempfile.TemporaryDirectory(prefix="golden-") as name:
        folder = Path(name).resolve()
        places = {
            str(folder): "<folder>", name: "<folder>", str(ROOT): "<repository>",
            sys.prefix: "<python>", str(Path.home()): "<home>",
            os.environ.get("STICKSLIP_DATA") or "<data>": "<data>",
        }  # fmt: skip
        try:
            with PREPARING:
                case.prepare(folder)
            given = set(folder.rglob("*"))
            for command in case.commands:
                files |= printed(command, folder, places)
            for path in sorted(set(folder.rglob("*")) - given):
                form = FORMS.get(path.suffix)
                # of laws that are drawn, the verdict keeps the set, the shares and the band
                if form is not None and path.is_file() and path.name != "draws.json":
                    kept = path.relative_to(folder).as_posix()
                    kept = re.sub(r"\.html$", ".txt", kept)
                    files[kept] = plain(form(path.read_text(encoding="utf-8")), places)
        except Exception as error:  # whatever a case does, the others go on
            failure = f"{type(error).__name__}: {error}"
    seconds = time.perf_counter() - began
    return Output(case=case.name, files=files, seconds=seconds, failure=failure)


def printed(command: Command, folder: Path, places: Mapping[str, str]) -> dict[str, str]:
    """Run a command; return what it printed, by file."""
    first, *rest = command.line
    whole = [sys.executable, *(() if first == PYTHON else ("-m", first)), *rest]
    own = [Path(stickslip.__file__).parents[1], ROOT]
    environment = {
        **os.environ, "COLUMNS": WIDTH, "NO_COLOR": "1", "TERM": "dumb",
        "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONIOENCODING": "utf-8",
        "PYTHONPATH": os.pathsep.join([*map(str, own), os.environ.get("PYTHONPATH", "")]),
    }  # fmt: skip
    done = subprocess.run(
        whole, cwd=folder, env=environment, capture_output=True, text=True, encoding="utf-8",
        timeout=PATIENCE, check=False, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    if done.returncode not in command.codes:
        last = "\n".join(done.stderr.strip().splitlines()[-5:])
        raise RuntimeError(f"{' '.join(command.line)}: exit code {done.returncode}\n{last}")
    remarks = [line for line in done.stderr.splitlines() if not PROGRESS.search(line)]
    lines = [f"$ {' '.join(command.line)}", f"exit code {done.returncode}"]
    files = {}
    if done.stdout.startswith("{"):
        files[f"{command.name}.json"] = plain(json_text(done.stdout), places)
    else:
        lines += done.stdout.splitlines()
    lines += ["stderr:", *remarks] if remarks else []
    files[f"{command.name}.txt"] = plain("\n".join(line.rstrip() for line in lines), places)
    return files


def outputs(cases: Sequence[Case], jobs: int) -> Iterator[Output]:
    """Run cases side by side, the longest first; yield each when it is done."""
    ordered = sorted(cases, key=lambda case: -case.seconds)
    with ThreadPoolExecutor(jobs) as pool:
        for done in as_completed([pool.submit(run, case) for case in ordered]):
            yield done.result()


def save(output: Output, folder: Path) -> int:
    """Write the files of a case, in place of those that were there; return their size [B]."""
    shutil.rmtree(folder / output.case, ignore_errors=True)
    for name, text in output.files.items():
        path = folder / output.case / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "\n", encoding="utf-8")
    return sum(len(text.encode()) + 1 for text in output.files.values())


def load(folder: Path, case: str) -> dict[str, str]:
    """Return the golden files of a case, by name."""
    paths = (path for path in sorted((folder / case).rglob("*")) if path.is_file())
    return {
        path.relative_to(folder / case).as_posix(): path.read_text(encoding="utf-8").rstrip("\n")
        for path in paths
    }


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """How the files of a case differ from its golden files."""

    diff: tuple[str, ...]
    lines: int
    """That differ: changed, added or removed."""
    largest: float
    """Largest relative difference between numbers in JSON."""
    where: str
    unpaired: int
    """Numbers in JSON without a partner."""

    def __str__(self) -> str:
        if not self.lines:
            return "equal"
        parts = [f"{self.lines} {'line differs' if self.lines == 1 else 'lines differ'}"]
        if self.largest:
            parts.append(f"numbers by up to {self.largest:.2g} ({self.where})")
        if self.unpaired:
            parts.append(f"{self.unpaired} numbers without a partner")
        return "; ".join(parts)


def compare(
    golden: Mapping[str, str], new: Mapping[str, str], *, rtol: float = 0.0, shown: int = SHOWN
) -> Comparison:
    """Compare files, by name, with golden ones."""
    diff: list[str] = []
    count, largest, where, unpaired = 0, 0.0, "", 0
    for name in sorted({*golden, *new}):
        old, now = (files.get(name, "").splitlines() for files in (golden, new))
        now = settled(old, now, rtol)
        blocks = [block for block in matched(old, now).get_opcodes() if block[0] != "equal"]
        if not blocks and (name in golden) == (name in new):
            continue
        count += sum(max(i2 - i1, j2 - j1) for _, i1, i2, j1, j2 in blocks) or 1
        labels = (
            f"{side}/{name}" if name in files else f"{side}/{name} (no such file)"
            for side, files in (("golden", golden), ("new", new))
        )
        told = list(difflib.unified_diff(old, now, *labels, n=1, lineterm=""))
        diff += told[:shown]
        if len(told) > shown:
            diff.append(f"... and {len(told) - shown} more lines")
        if name.endswith(".json") and name in golden and name in new:
            pairs, alone = paired(*(json.loads(files[name]) for files in (golden, new)))
            unpaired += alone
            for path, a, b in pairs:
                if (apart := relative(a, b)) > largest:
                    largest, where = apart, f"{name}: {path}"
    return Comparison(
        diff=tuple(diff), lines=count, largest=largest, where=where, unpaired=unpaired
    )


def matched(old: Sequence[str], new: Sequence[str]) -> difflib.SequenceMatcher[str]:
    return difflib.SequenceMatcher(None, old, new, autojunk=False)


def settled(old: Sequence[str], new: Sequence[str], rtol: float) -> list[str]:
    """Return the new lines, those for the old that differ by no more than numbers within `rtol`."""
    lines = list(new)
    if rtol > 0.0:
        for tag, i1, i2, j1, j2 in matched(old, new).get_opcodes():
            if tag == "replace" and i2 - i1 == j2 - j1:
                for i, j in zip(range(i1, i2), range(j1, j2), strict=True):
                    lines[j] = old[i] if alike(old[i], new[j], rtol) else new[j]
    return lines


def alike(a: str, b: str, rtol: float) -> bool:
    """Return whether two lines differ in nothing but numbers, and these by less than `rtol`."""
    words = (" ".join(NUMBER.sub("0", line).split()) for line in (a, b))
    if len({*words}) > 1:
        return False
    pairs = zip(NUMBER.findall(a), NUMBER.findall(b), strict=True)
    return all(relative(float(x), float(y)) <= rtol for x, y in pairs)


def relative(a: float, b: float) -> float:
    """Return how far two numbers are apart, over the larger one.

    Examples
    --------
    >>> relative(2.0, 2.5)
    0.2
    """
    if a == b or (math.isnan(a) and math.isnan(b)):
        return 0.0
    size = max(abs(a), abs(b))
    return abs(a - b) / size if math.isfinite(size) else math.inf


def paired(old: Any, new: Any) -> tuple[list[tuple[str, float, float]], int]:
    """Return pairs of numbers with the path of each, and how many have no partner.

    Numbers of the same path are partners. The others are partners in turn if there are as many on
    both sides, as where a key was renamed.
    """
    before, after = dict(numbers(old)), dict(numbers(new))
    pairs = [(path, value, after[path]) for path, value in before.items() if path in after]
    left = [path for path in before if path not in after]
    right = [path for path in after if path not in before]
    if len(left) != len(right):
        return pairs, len(left) + len(right)
    moved = zip(left, right, strict=True)
    return [*pairs, *((path, before[path], after[there]) for path, there in moved)], 0


def numbers(value: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """Yield every number of a JSON document with its path."""
    if isinstance(value, bool):
        return
    if isinstance(value, int | float):
        yield path, float(value)
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from numbers(item, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from numbers(item, f"{path}[{index}]")


def report(number: int, total: int, output: Output, what: str) -> None:
    print(f"[{number}/{total}] {output.case:15} {output.seconds:5.0f} s  {what}", flush=True)


def record(cases: Sequence[Case], folder: Path, jobs: int) -> bool:
    """Keep what the cases write; return whether all of them ran."""
    sound, size = True, 0
    for number, output in enumerate(outputs(cases, jobs), 1):
        if output.failure:
            sound = False
            report(number, len(cases), output, f"failed, golden files unchanged: {output.failure}")
            continue
        written = save(output, folder)
        size += written
        report(number, len(cases), output, f"{len(output.files)} files, {written / 1e3:.0f} kB")
    print(f"{size / 1e6:.2f} MB in {folder}")
    return sound


def compare_all(
    cases: Sequence[Case], folder: Path, jobs: int, *, rtol: float, shown: int, kept: Path | None
) -> bool:
    """Print how the cases differ from their golden files; return whether none does."""
    summary = {}
    for number, output in enumerate(outputs(cases, jobs), 1):
        golden = load(folder, output.case)
        if output.failure:
            summary[output.case] = f"failed: {' / '.join(output.failure.splitlines())}"
        elif not golden:
            summary[output.case] = f"failed: no golden files in {folder / output.case}"
        else:
            result = compare(golden, output.files, rtol=rtol, shown=shown)
            summary[output.case] = str(result)
            print("\n".join(result.diff), end="\n" if result.diff else "")
        if kept is not None and not output.failure:
            save(output, kept)
        report(number, len(cases), output, summary[output.case])
    print()
    for case in cases:
        print(f"{case.name:15} {summary[case.name]}")
    return all(line == "equal" for line in summary.values())


def chosen(names: Iterable[str]) -> list[Case]:
    """Return the cases of these names, or all of them.

    Raises
    ------
    SystemExit
        If there is no such case.
    """
    known = {case.name: case for case in CASES}
    wanted = list(names) or list(known)
    for name in wanted:
        if name not in known:
            sys.exit(f"There is no case {name!r}; there are {', '.join(known)}.")
    return [known[name] for name in dict.fromkeys(wanted)]


def main(arguments: Sequence[str] | None = None) -> int:
    """Read the command line; return the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.golden", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument("action", choices=("record", "compare"))
    parser.add_argument("folder", type=Path, help="where the golden files are")
    parser.add_argument("--only", metavar="NAME", action="append", default=[], help="a case")
    parser.add_argument("--jobs", type=int, default=1, help="cases at the same time")
    parser.add_argument("--rtol", type=float, default=0.0, help="numbers this close are equal")
    parser.add_argument("--lines", type=int, default=SHOWN, help="lines of each file's diff")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep what compare found, too")
    asked = parser.parse_args(arguments)
    cases = chosen(asked.only)
    began = time.perf_counter()
    if asked.action == "record":
        good = record(cases, asked.folder, asked.jobs)
    else:
        good = compare_all(
            cases, asked.folder, asked.jobs, rtol=asked.rtol, shown=asked.lines, kept=asked.keep
        )
    spent = os.times()
    busy = spent.user + spent.system + spent.children_user + spent.children_system
    print(f"{time.perf_counter() - began:.0f} s, {busy:.0f} s of processor time")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
