"""What a selection on records of several joints gives back, and its words."""

import itertools
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, final

from typing_extensions import override

from stickslip.experiments import Checks
from stickslip.formatting import Scale, capital, count, joined
from stickslip.friction import CandidateSpec
from stickslip.kinds.joints.joint_verdict import BlockwiseVerdict, RecordVerdict
from stickslip.selection import Wording, corrections, in_sentence, longer, score_scale, score_text

Lines: TypeAlias = Callable[[Wording], Sequence[str]]
"""Some lines of the words of a verdict."""

NUMBERS = re.compile(r" \([^()]*\)")
"""What stands in brackets."""
MOST = 3
"""Items of a list at most."""


def combination_of(chosen: Mapping[str, CandidateSpec | None]) -> str:
    """Return the key of a combination of laws, as ``--law`` takes it.

    Examples
    --------
    >>> from stickslip.friction import specification
    >>> combination_of({"hip": specification("dahl"), "knee": specification("coulomb")})
    'hip=dahl,knee=coulomb'
    """
    return ",".join(f"{name}={one.name if one else ''}" for name, one in chosen.items())


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class JointVerdict(BlockwiseVerdict):
    """A verdict on records of several joints: a verdict for each, and one fit of all.

    The candidates are the combinations of laws that were compared. The fit of each has the laws
    of all joints.
    """

    joints: Mapping[str, RecordVerdict]
    """By contact, the candidates for its law, compared with the laws of the others as named."""
    sweeps: int
    """How often the joints were gone through."""
    settled: bool
    """Whether the last sweep changed no choice."""

    @property
    @override
    def score_unit(self) -> str:
        units = {one.score_unit for one in self.joints.values()}
        return units.pop() if len(units) == 1 else ""

    @property
    def scale(self) -> Scale:
        """The multiple of the unit in which scores of combinations are shown."""
        shown = {one.shown for one in self.joints.values()}
        common = shown.pop() if len(shown) == 1 else None
        return common or score_scale([one.score for one in self.candidates], self.score_unit)

    @override
    def _basis(self) -> str:
        return f"; {count(self.sweeps, 'sweep')} over {count(len(self.joints), 'joint')}"

    @override
    def _details(self) -> Mapping[str, Any]:
        return {
            "sweeps": self.sweeps,
            "settled": self.settled,
            "seed": self.settings.seed,
            "folds": self.plan.folds,
            "gap": self.plan.gap,
            "horizon": self.plan.horizon,
            "unit": self.score_unit,
            "joints": {name: one.to_dict() for name, one in self.joints.items()},
            "checks": self.checks.to_dict(),
        }


def joint_wording(
    verdicts: Mapping[str, RecordVerdict],
    sweeps: int,
    *,
    settled: bool,
    checks: Checks,
    compared: int,
    resting: Sequence[str] = (),
    assumptions: Sequence[str] = (),
) -> Wording:
    """Put a selection for several joints into words."""
    wrong = checks.of("joint columns")
    said = [f"{short_verdict(name, one)}." for name, one in verdicts.items()]
    verdict = " ".join([*said, *resting])
    if wrong:
        verdict = f"No law is recommended. {wrong[0].sentence}"
    return Wording(
        verdict=verdict,
        lede=" ".join([_lede(verdicts, sweeps, settled=settled, compared=compared), *assumptions]),
        settles=_spread(verdicts, lambda words: words.settles),
        cannot_tell=_spread(verdicts, lambda words: words.cannot_tell),
        measure_next=_next(verdicts, checks),
        no_score="",
    )


def short_verdict(name: str, verdict: RecordVerdict) -> str:
    """Return the verdict on one joint without its numbers, which the lede has."""
    text = verdict.words.verdict.removesuffix(".").partition(": ")[0]
    return f"{joint_label(name)}: {in_sentence(NUMBERS.sub('', text))}"


def _lede(
    verdicts: Mapping[str, RecordVerdict], sweeps: int, *, settled: bool, compared: int
) -> str:
    errors = []
    for name, one in verdicts.items():
        text = " ".join(score_text(one.scale, one.closest.score, one.closest.score_error)).strip()
        part = f"{text} {one.scale.unit} at the {name}"
        if one.on_second is not None:
            part += f" ({one.scale.error(one.on_second.error)} on the second record)"
        errors.append(part)
    text = f"Held-out error of the force: {joined(errors)}."
    for name, one in verdicts.items():
        own = one.words.verdict
        if in_sentence(own).removesuffix(".") not in short_verdict(name, one):
            text += f" {joint_label(name)}: {in_sentence(own)}"
    text += f" {count(sweeps, 'sweep')} over the joints compared {count(compared, 'combination')}"
    text += " of laws" + (
        "; the last sweep changed no choice."
        if settled
        else "; the choices had not settled, so that another combination may predict as well."
    )
    return text


def _spread(verdicts: Mapping[str, RecordVerdict], lines: Lines) -> tuple[str, ...]:
    """Return lines of all joints in turn, three at most; what all say stands once, at the end."""
    own = {name: lines(one.words) for name, one in verdicts.items()}
    shared = [
        line for line in next(iter(own.values()), ()) if all(line in each for each in own.values())
    ]
    shared = shared if len(own) > 1 else []
    columns = [
        [f"{joint_label(name)}: {line}" for line in each if line not in shared]
        for name, each in own.items()
    ]
    turns = itertools.zip_longest(*columns)
    mixed = [line for turn in turns for line in turn if line is not None]
    return tuple([*mixed, *shared][:MOST])


def _next(verdicts: Mapping[str, RecordVerdict], checks: Checks) -> tuple[str, ...]:
    return (
        *corrections(checks),
        *longer(checks),
        *_spread(verdicts, lambda words: words.measure_next),
    )[:MOST]


def joint_label(name: str) -> str:
    """Return the name of a joint at the start of a line; one that is a code stays as it is.

    Examples
    --------
    >>> joint_label("elbow"), joint_label("q1")
    ('Elbow', 'q1')
    """
    return capital(name) if name.isalpha() and name.islower() else name
