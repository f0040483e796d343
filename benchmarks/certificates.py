"""Certificates of verdicts on measured motions: runs of what is handed over, beside plain friction.

``python -m benchmarks.certificates`` judges both parts of every public set with a motion that the
folder in ``STICKSLIP_DATA`` or the catalogue has (``--only NAME`` those whose names begin so). A
line has the error of the run over the spread of the position in a stretch, that of Coulomb +
viscous friction by least squares, their ratio, the error that the posterior expects, and the share
of the work that the named friction takes.
"""

import argparse
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks.real_records import SETS, Case
from stickslip import Measurement, select
from stickslip.errors import StickslipError
from stickslip.identify import BandVerdict


def verdicts(case: Case, record: Measurement) -> Mapping[str, BandVerdict]:
    """Return the verdict on a part of a set; of several joints one for each."""
    vary = ["friction.*", *case.unknown] if case.unknown else None
    verdict: Any = select(case.mechanism, None, record, vary=vary, settings=case.settings)
    return getattr(verdict, "joints", None) or {"": verdict}


def lines(only: str = "") -> Iterator[tuple[str, float]]:
    """Yield a line for each part, and joint, and the error of the run over that of plain."""
    for made in SETS:
        for case in made():
            parts = {"first": case.first, **case.others} if case.name.startswith(only) else {}
            for part, record in parts.items():
                began = time.process_time()
                try:
                    found = verdicts(case, record)
                except StickslipError as error:
                    yield f"{case.name}, {part}: not judged: {error}", math.nan
                    continue
                seconds = (time.process_time() - began) / len(found)
                for joint, verdict in found.items():
                    name = ", ".join(filter(None, (case.name, part, joint)))
                    yield line(f"{name:42}", verdict, seconds)


def line(name: str, verdict: BandVerdict, seconds: float) -> tuple[str, float]:
    """Return the line of a verdict."""
    seen = verdict.certificate
    if seen is None:
        why = [x for x in verdict.words.cannot_tell if x.startswith("The law was not run")]
        return f"{name} none: {' '.join(why) or 'friction itself was measured'}", math.nan
    ratio = seen.run_error / seen.plain_error
    asserted = ", ".join(item.term for item in verdict.findings if item.asserted)
    return (
        f"{name} run {seen.run_error:.4f}, plain {seen.plain_error:.4f}, ratio {ratio:.2f},"
        f" expected {seen.expected_error:.4f}, work {seen.friction_work:.3f},"
        f" over {seen.duration:.3g} s, {seconds:.1f} s | {verdict.closest.title} |"
        f" {asserted}{' | BEATEN' * seen.is_beaten}"
    ), ratio


def main(arguments: Sequence[str] | None = None) -> None:
    """Print all lines and the median of the ratios."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.certificates")
    parser.add_argument("--only", default="", help="beginning of the names of records")
    ratios = []
    for text, ratio in lines(parser.parse_args(arguments).only):
        print(text, flush=True)
        ratios += [ratio] * math.isfinite(ratio)
    middle = np.median(ratios or [math.nan])
    print(f"{len(ratios)} runs: over plain {middle:.2f} in the median, above 1 on"
          f" {sum(x > 1.0 for x in ratios)}")  # fmt: skip


if __name__ == "__main__":
    main()
