"""The verb `select` for travels."""

from collections.abc import Mapping, Sequence

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.friction import LAWS, FrictionLaw
from stickslip.identification import starting_law
from stickslip.identification.compiling import compile_for
from stickslip.identification.travel import trials_of
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters
from stickslip.selection.admissibility import mark_passed_over
from stickslip.selection.scoring import simpler_within_doubt
from stickslip.selection.separation import separations
from stickslip.selection.specifications import check_apart
from stickslip.selection.travel_candidates import Watch, try_law
from stickslip.selection.verdict import Candidate, TravelVerdict
from stickslip.selection.words import wording
from stickslip.solver import Progress

__all__ = ["select_travels"]

PLAIN = tuple(name for name, law in LAWS.items() if not law.on_request)
"""What a few travels can be compared with: they have no direction and no more than a slope."""


def select_travels(
    mechanism: Mechanism,
    measurement: Measurement,
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw]] | None = None,
    *,
    t_end: float = 10.0,
    watch: Watch | None = None,
    compiling: Progress | None = None,
) -> TravelVerdict:
    """Fit every law to measured travels, compare them, and say what the data cannot tell.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    measurement : Measurement
        One travel or several trials.
    laws : mapping or sequence, optional
        The candidates; instances bring start values and assumptions, types take ordinary ones.
        If not given, the six that the source paper compares.
    t_end : float
        Time after which a body counts as stopped [s].
    watch : callable, optional
        Called with the name of a law and the number of its runs so far.
    compiling : callable, optional
        Called as the `progress` of `stickslip.solver.warm_up`, if equations have to be compiled.

    Returns
    -------
    TravelVerdict
        Candidates, the law to use, what the data settle and what they cannot tell.

    Raises
    ------
    InputError
        If there is no law to try or the measurement has no travel.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, Viscous
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> verdict = select_travels(rig, reading, [Coulomb, Viscous])
    >>> verdict.best.name, verdict.ranked
    ('coulomb', False)
    """
    trials = trials_of(mechanism, measurement)
    named = _named(laws)
    if not named:
        raise InputError("there is no friction law to try: give at least one in `laws`.")
    scored = len({trial.setting for trial in trials}) > 1
    ordinary = _ordinary(laws)
    compile_for(trials, named.values(), progress=compiling)
    candidates = [
        try_law(name, law, trials, t_end=t_end, ordinary=name in ordinary, watch=watch)
        for name, law in named.items()
    ]
    candidates, best = _ranked(candidates) if scored else (candidates, _plainest(candidates))
    fitted = {c.name: c.fit.law for c in candidates if c.fit and not c.dropped}
    predictions = separations(mechanism, fitted, t_end=t_end, trials=trials)
    words = wording(trials, candidates, best, predictions, ranked=scored)
    return TravelVerdict(
        mechanism=mechanism,
        measurement=measurement,
        candidates=tuple(candidates),
        best=best,
        ranked=scored and best is not None,
        separations=predictions,
        words=words,
        t_end=t_end,
    )


def _named(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw]] | None,
) -> dict[str, FrictionLaw]:
    if isinstance(laws, Mapping):
        return dict(laws)
    chosen = [LAWS[name] for name in PLAIN] if laws is None else list(laws)
    made = [starting_law(law) if isinstance(law, type) else law for law in chosen]
    check_apart([law.name for law in made])
    return {law.name: law for law in made}


def _ordinary(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw]] | None,
) -> set[str]:
    """Return the names of the laws whose values nobody gave."""
    if isinstance(laws, Mapping):
        return set()
    chosen = [LAWS[name] for name in PLAIN] if laws is None else list(laws)
    return {law.name for law in chosen if isinstance(law, type)}


def _plainest(candidates: Sequence[Candidate]) -> Candidate | None:
    """Return the law that explains the data with the fewest parameters.

    Laws that can hold a body at rest come first, since it did come to rest.
    """
    explained = [c for c in candidates if not c.dropped]
    holding = [c for c in explained if c.law.break_away(1.0) > 0]
    return min(holding or explained, key=_size, default=None)


def _size(candidate: Candidate) -> int:
    return len(list(parameters(candidate.law, "friction")))


def _ranked(candidates: Sequence[Candidate]) -> tuple[list[Candidate], Candidate | None]:
    """Order by held-out score; take a simpler law that is no worse within doubt."""
    scored = mark_passed_over([c for c in candidates if c.score is not None])
    scored.sort(key=lambda c: c.score or 0.0)
    rest = [c for c in candidates if c.score is None]
    if not scored:
        return rest, None
    admissible = [c for c in scored if not c.passed_over]
    best = admissible[0]
    for other in sorted(admissible, key=_size):
        if other is best:
            break
        if simpler_within_doubt(other.held_out, best.held_out):
            best = other
            break
    ordered = [best, *[c for c in scored if c is not best], *rest]
    return ordered, best
