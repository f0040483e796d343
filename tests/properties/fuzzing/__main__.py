"""``python -m tests.properties.fuzzing``: run random cases and say what became of them."""

import argparse
import dataclasses
import json
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from tests.properties.fuzzing.campaign import Campaign, Outcome, outcome_of
from tests.properties.fuzzing.cases import Case
from tests.properties.fuzzing.reports import classes, reproducer, violated
from tests.properties.fuzzing.shrinking import shrunk
from tests.properties.fuzzing.workers import outcomes_side_by_side

import stickslip
from stickslip import EventDriven

MOST_DOUBTFUL, ENOUGH = 0.02, 200
"""Share of runs that may not be certified, of so many: sizes over many decades leave little."""
UNFINISHED = ("ZENO", "STEP_TOO_SMALL", "NOT_FINITE")
"""Names of statuses that call for a look."""


def _progress(done: list[Outcome], total: int) -> None:
    wrong = sum(bool(one.violations) for one in done)
    open_ = sum(bool(one.reason) for one in done)
    print(
        f"\r{len(done)} of {total} cases, {wrong} violate a check, {open_} not certified",
        end="" if len(done) < total else "\n",
        file=sys.stderr,
        flush=True,
    )


def _kept(path: Path) -> Iterator[Outcome]:
    """Outcomes in a file of results; a last line that was cut off does not count."""
    for line in path.read_text(encoding="utf-8").splitlines(keepends=True):
        if line.endswith("\n"):
            row = json.loads(line)
            yield Outcome(**row | {"violations": tuple(map(tuple, row["violations"]))})


def _outcomes(campaign: Campaign, indices: list[int], asked: argparse.Namespace) -> list[Outcome]:
    """Run the cases whose outcome is not kept yet, and keep theirs."""
    path: Path | None = asked.results
    wanted = set(indices)
    done = [one for one in _kept(path) if one.index in wanted] if path and path.exists() else []
    if path and path.exists():  # without what was cut off
        path.write_text("".join(_line(one) for one in _kept(path)), encoding="utf-8")
    known = {one.index for one in done}
    left = [index for index in indices if index not in known]
    for outcome in outcomes_side_by_side(campaign, left, asked.processes) if left else ():
        done.append(outcome)
        if path:
            with path.open("a", encoding="utf-8") as file:
                file.write(_line(outcome))
        if len(done) % 50 == 0 or len(done) == len(indices):
            _progress(done, len(indices))
    return sorted(done, key=lambda one: one.index)


def _line(outcome: Outcome) -> str:
    return json.dumps(dataclasses.asdict(outcome)) + "\n"


def _shrunk(campaign: Campaign, outcome: Outcome) -> Case:
    """Return a simpler case with the same trouble."""
    names = {name for name, _ in outcome.violations}

    def is_wrong(case: Case) -> bool:
        again = outcome_of(0, case, campaign.solver, campaign.seconds)
        if names:
            return bool(names & {name for name, _ in again.violations})
        return (again.status, again.reason) == (outcome.status, outcome.reason)

    return shrunk(campaign.case(outcome.index), is_wrong)


def _details(campaign: Campaign, outcome: Outcome, *, shrink: bool) -> str:
    case = _shrunk(campaign, outcome) if shrink else campaign.case(outcome.index)
    lines = [f"# case {outcome.index}: {outcome.title}, {outcome.status} {outcome.reason}".rstrip()]
    lines += [f"# not one that {name}: {words}" for name, words in outcome.violations]
    return "\n".join([*lines, reproducer(case, campaign.solver)])


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.properties.fuzzing", description=__doc__)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tier", choices=("python", "compiled", "auto"), default="python")
    parser.add_argument("--several", action="store_true", help="one to six contacts")
    parser.add_argument("--loops", action="store_true", help="contacts whose slips close loops")
    parser.add_argument("--tiers", type=int, default=0, help="every which case runs in both tiers")
    parser.add_argument("--structures", type=int, help="sets of equations; compiled: 40")
    parser.add_argument("--steps", type=int, default=1000, help="step limit of a case")
    parser.add_argument("--seconds", type=float, default=10.0, help="time limit of a case")
    parser.add_argument("--processes", type=int, default=1, help="processes side by side")
    parser.add_argument("--results", type=Path, help="file of outcomes; a killed run goes on there")
    parser.add_argument("--compare", type=int, default=10, help="every which case runs twice")
    parser.add_argument("--only", type=int, nargs="+", help="run these cases and print them")
    parser.add_argument("--shrink", action="store_true", help="simplify what is printed")
    parser.add_argument("--each", type=int, default=3, help="reproducers of each violated check")
    return parser.parse_args()


def _chosen(done: list[Outcome], each: int) -> list[Outcome]:
    """Return the first few outcomes of each violated check and of each kind of unfinished run."""
    shown: Counter[str] = Counter()
    chosen = []
    for outcome in done:
        names = [name for name, _ in outcome.violations]
        if outcome.reason or outcome.status in UNFINISHED:
            names.append(f"{outcome.status} {outcome.reason}")
        if any(shown[name] < each for name in names):
            chosen.append(outcome)
            shown.update(names)
    return chosen


def main() -> int:
    """Run the cases; return 1 if a check failed."""
    asked = _arguments()
    default = 40 if asked.tier == "compiled" else 0
    campaign = Campaign(
        seed=asked.seed,
        structures=default if asked.structures is None else asked.structures,
        solver=EventDriven(max_steps=asked.steps, tier=asked.tier),
        seconds=asked.seconds,
        compare=asked.compare,
        several=asked.several,
        loops=asked.loops,
        tiers=asked.tiers,
    )
    indices = asked.only or campaign.order(asked.cases)
    done = _outcomes(campaign, list(indices), asked)
    print(f"stickslip {stickslip.__version__} of {Path(stickslip.__file__).parent}")
    print(classes(done), violated(done), sep="\n\n")
    for outcome in done if asked.only else _chosen(done, asked.each):
        print("\n" + _details(campaign, outcome, shrink=asked.shrink))
    doubtful = sum(bool(outcome.reason) and outcome.status != "refused" for outcome in done)
    if len(done) >= ENOUGH and doubtful > MOST_DOUBTFUL * len(done):
        print(f"{doubtful} runs are not certified: more than {MOST_DOUBTFUL:.0%} of all.")
        return 1
    return int(any(outcome.violations for outcome in done))


if __name__ == "__main__":
    sys.exit(main())
