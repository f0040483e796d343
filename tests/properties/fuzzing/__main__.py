"""``python -m tests.properties.fuzzing``: run random cases and say what became of them."""

import argparse
import sys
from collections import Counter
from pathlib import Path

from tests.properties.fuzzing.campaign import Campaign, Outcome
from tests.properties.fuzzing.reports import classes, reproducer, violated
from tests.properties.fuzzing.workers import outcomes_side_by_side

import stickslip
from stickslip import EventDriven

MOST_DOUBTFUL, ENOUGH = 0.02, 200
"""Share of runs that may not be certified, of so many: sizes over many decades leave little."""
UNFINISHED = ("ZENO", "STEP_TOO_SMALL", "NOT_FINITE")
"""Names of statuses that call for a look."""


def _outcomes(campaign: Campaign, indices: list[int], processes: int) -> list[Outcome]:
    done: list[Outcome] = []
    for outcome in outcomes_side_by_side(campaign, indices, processes):
        done.append(outcome)
        if len(done) % 50 == 0 or len(done) == len(indices):
            wrong = sum(bool(one.violations) for one in done)
            open_ = sum(bool(one.reason) for one in done)
            print(
                f"{len(done)} of {len(indices)} cases, {wrong} violate a check, "
                f"{open_} not certified",
                file=sys.stderr,
            )
    return sorted(done, key=lambda one: one.index)


def _details(campaign: Campaign, outcome: Outcome) -> str:
    lines = [f"# case {outcome.index}: {outcome.title}, {outcome.status} {outcome.reason}".rstrip()]
    lines += [f"# not one that {name}: {words}" for name, words in outcome.violations]
    return "\n".join([*lines, reproducer(campaign.case(outcome.index), campaign.solver)])


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
    parser.add_argument("--compare", type=int, default=10, help="every which case runs twice")
    parser.add_argument("--only", type=int, nargs="+", help="run these cases and print them")
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
    done = _outcomes(campaign, list(indices), asked.processes)
    print(f"stickslip {stickslip.__version__} of {Path(stickslip.__file__).parent}")
    print(classes(done), violated(done), sep="\n\n")
    for outcome in done if asked.only else _chosen(done, asked.each):
        print("\n" + _details(campaign, outcome))
    doubtful = sum(bool(outcome.reason) and outcome.status != "refused" for outcome in done)
    if len(done) >= ENOUGH and doubtful > MOST_DOUBTFUL * len(done):
        print(f"{doubtful} runs are not certified: more than {MOST_DOUBTFUL:.0%} of all.")
        return 1
    return int(any(outcome.violations for outcome in done))


if __name__ == "__main__":
    sys.exit(main())
