"""Kinds whose readings only runs of laws tell: their fit, verdict, words and page.

A kind gives a `Simulated` problem (rows, runs of a law, what is unknown with its priors), seven
texts and its figures. One posterior weighs all laws (`stickslip.identify.simulated`), and
everything that is said is read from its draws:

* the most probable law is *named*, unless it contradicts what was measured (`SimulatedKind.fault`);
* laws within 100 : 1 of it cannot be distinguished, and those that contain it may hold as well;
* parameters have the quantiles of their draws, under the named law and over these laws.

A fit is the selection in which no other law is compared.
"""

from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar, Final, NamedTuple, Protocol, TypeAlias

import numpy as np

from stickslip.data import Checks, LawEstimates, Measurement, levels_at, with_order
from stickslip.errors import ConvergenceError, InputError
from stickslip.identify import (
    parameter_sentence,
    probability_text,
    sections_of,
)
from stickslip.identify.bands import ENDS, Array, PredictionBand, correlation_of
from stickslip.identify.candidates import (
    MOST,
    NOT_RULED_OUT,
    ONE_LAW,
    UNMEASURED,
    Candidate,
    JudgedFit,
    Verdict,
    Wording,
    cannot_rule_out,
    corrections,
    plain,
    score_text,
)
from stickslip.identify.fits import LAW, AnyLaw_co, Estimate, estimates_for
from stickslip.identify.judgement import RIVAL
from stickslip.identify.kinds.kind import (
    OVER_ALL_LAWS,
    Column,
    Columns,
    Comparison,
    FitSummary,
    Kind,
    Request,
    SeveralLaws,
    data_row,
    page_table,
    terminal_table,
)
from stickslip.identify.propose import WORTH
from stickslip.identify.selection import checked
from stickslip.identify.simulated import FamilyDraws, Readable, Simulated, SimulatedPosterior
from stickslip.quantities import Quantity
from stickslip.show.formatting import Scale, capital, count, joined, significant
from stickslip.show.report import Figure, Origin, Section, SectionMaker

if TYPE_CHECKING:
    from stickslip.show.display import Drawing, Target

PLAIN: Final = Scale(1.0, "")
"""What laws leave is shown as it is."""


class Weighed(Protocol):
    """Laws weighed by a posterior."""

    @property
    def cancelled(self) -> bool:
        """Whether the search was ended before its end."""

    @property
    def shares(self) -> Mapping[str, float]:
        """Posterior probabilities of the laws by name."""

    @property
    def families(self) -> Mapping[str, FamilyDraws]:
        """Draws of each law by name; the root mean square is infinite where no run works."""


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class SimulatedFit(JudgedFit[AnyLaw_co]):
    """A law whose runs have the readings of a measurement.

    Law and mechanism are those where the posterior is largest; intervals are quantiles of draws.
    """

    kind: "SimulatedKind" = field(repr=False)
    """The kind of measurement."""
    name: str
    """Name of the law among those that were compared."""
    problem: Any = field(repr=False)
    """The measurement as rows, and its priors."""
    posterior: Any = field(repr=False)
    """The posterior that all is read from."""
    derived: tuple[Estimate, ...] = ()
    """What follows from the parameters, such as a difference of them."""

    @property
    def family(self) -> Any:
        """What the posterior says of this law."""
        return self.posterior.families[self.name]

    @cached_property
    def draws(self) -> Mapping[str, Array]:
        """Draws (k,) of parameters, SI, by path."""
        result: Mapping[str, Array] = self.problem.read(
            self.name, self.family.points, self.family.coefficients
        )
        return result

    @cached_property
    def rms(self) -> float:
        """Root mean square of what the law leaves, in the unit of the verdict's scores."""
        return float(self.problem.leaves(self.family, self.name))

    @cached_property
    def details(self) -> Mapping[str, Any]:
        """What only fits of this kind say, as plain numbers and strings."""
        return self.kind.details(self)

    def judged(self, measurement: Measurement) -> Mapping[str, float]:
        """Return what the law is off on another record of the mechanism, by what is compared.

        Parameters
        ----------
        measurement : Measurement
            One record of the same kind.
        """
        return self.kind.errors(self, measurement)

    @property
    def correlation(self) -> tuple[tuple[float, ...], ...]:
        """Of the estimates (p, p); 0 with what is not told."""
        table = correlation_of(np.array([self.draws[estimate.path] for estimate in self.estimates]))
        np.fill_diagonal(table, 1.0)
        return tuple(map(tuple, table.tolist()))

    def law_estimates(self) -> LawEstimates:
        return estimates_for(
            self.law,
            self.estimates,
            np.array(self.correlation),
            levels=self.kind.levels or levels_at(self.mechanism),
            largest_speed=self.kind.largest_speed(self),
        )

    def to_dict(self) -> Mapping[str, Any]:
        drawn = {"effective_draws": self.family.effective, "cancelled": self.cancelled}
        return {**super().to_dict(), **drawn, **self.details}

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.show.plots import C1, DATA, MAP_SIZES, on_axes

        pieces, (what, unit) = self.kind.pieces(self, ()), self.kind.drawn
        if not pieces:
            return super()._plot(ax)
        _, t, measured, predicted = pieces[0]

        def draw(figure: Any, narrow: bool) -> None:  # noqa: ARG001
            axes = figure.subplots()
            axes.plot(t, measured, "o", color=DATA, markersize=2.2, label="measured")
            for title, y in predicted.items():
                axes.plot(t, y, color=C1, label=title)
            axes.set_xlabel("time, s")
            axes.set_ylabel(what if unit == "1" else f"{what}, {unit}")
            axes.legend()

        return on_axes(draw, ax, MAP_SIZES["wide"])


AnyFit: TypeAlias = SimulatedFit[Any]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SimulatedCandidate(Candidate[AnyFit]):
    """A law of a selection: its fit, its probability, and what speaks against it."""

    kind: "SimulatedKind" = field(repr=False)
    """The kind of measurement."""
    probability: float = 0.0
    """Probability of the law among those compared."""
    second: Mapping[str, float] = field(default_factory=dict)
    """What it is off on the record given to validate, if there is one."""

    @property
    def share(self) -> float:
        """Share of the law in bands: its probability, if not replaced."""
        return self.probability

    @property
    def law(self) -> Any:
        """The fitted law; None without a fit."""
        return self.fit.law if self.fit else None

    @property
    def score(self) -> float | None:
        """Root mean square of what the law leaves."""
        return self.fit.rms if self.fit else None

    def to_row(self) -> Mapping[str, Any]:
        return data_row(self.kind.all_columns, self)

    def to_dict(self) -> Mapping[str, Any]:
        texts = {"title": self.title, "dropped": plain(self.dropped)}
        return {**super().to_dict(), **texts, "second_record": dict(self.second) or None}


@dataclass(frozen=True, kw_only=True, repr=False)
class SimulatedVerdict(Verdict[SimulatedCandidate]):
    """A verdict on a measurement whose readings only runs of laws tell."""

    kind: "SimulatedKind" = field(repr=False)
    """The kind of measurement."""
    near: tuple[str, ...]
    """Laws that cannot be distinguished from the named one, or contain it; that one first."""
    rivals: tuple[str, ...]
    """Names of those of them that may hold instead of it."""
    advised: tuple[Any, ...] = ()
    """Further records by what they would tell, the most telling first."""

    @property
    def route(self) -> str:
        return self.kind.routes[0]

    @property
    def score_unit(self) -> str:
        return "1"

    @property
    def fits(self) -> tuple[AnyFit, ...]:
        """Fits of the laws that are near, the named one first."""
        return tuple(
            candidate.fit
            for candidate in self.candidates
            if candidate.fit and candidate.name in self.near
        )

    @property
    def stated(self) -> Sequence[tuple[Estimate, Estimate]]:
        fit = self.fits[0]
        derived = [(item, self.kind.over_all(self.fits, item)) for item in fit.derived]
        return [*zip(fit.estimates, self.intervals, strict=True), *derived]

    def predict(self, setting: Any) -> PredictionBand:
        """Return the 95 % band of another record, over the laws that are near.

        Parameters
        ----------
        setting : Mechanism
            The mechanism as it is set for that record; other records are not foreseen by all kinds.

        Returns
        -------
        PredictionBand
            Limits and medians (m,) of what is compared, in its order; for stick-slip features
            frequency [Hz], mean and standard deviation of the force over the load, 0 as far as the
            block may slide steadily.
        """
        rows = [
            np.nanquantile(self.kind.foreseen(fit, setting), (ENDS[0], 0.5, ENDS[1]), axis=0)
            for fit in self.fits
        ]
        low, high = np.min([x[0] for x in rows], axis=0), np.max([x[2] for x in rows], axis=0)
        return PredictionBand(low=low, median=rows[0][1], high=high)

    def _details(self) -> Mapping[str, Any]:
        return {
            "not_distinguished_from": list(self.rivals),
            "parameters": [
                {**own.to_dict(), "low_any": over["low"], "high_any": over["high"]}
                for own, every in self.stated for over in [every.to_dict()]
            ],
            "checks": self.checks.to_dict(),
            "next_measurements": [item._asdict() for item in self.advised],
        }  # fmt: skip


def estimated(
    problem: Readable, name: str, family: FamilyDraws, sought: Mapping[str, Quantity]
) -> tuple[Estimate, ...]:
    """Return parameters of a law, by path: their values at the mode, and quantiles of draws."""
    draws = problem.read(name, family.points, family.coefficients)
    mode = problem.read(name, family.mode[None], family.usual[None])
    result = []
    for path, quantity in sought.items():
        value, (low, high) = float(mode[path][0]), np.quantile(draws[path], problem.ends).tolist()
        low, high = min(low, value), max(high, value)
        result.append(
            Estimate(path=path, quantity=quantity, value=value, low=low, high=high, interval="95 %")
        )
    return tuple(result)


def pooled(fits: Sequence[AnyFit], path: str) -> tuple[float, float]:
    """Return between which values a parameter lies, over the laws that have it."""
    ends = [np.quantile(fit.draws[path], ENDS) for fit in fits if path in fit.draws]
    return min(float(low) for low, _ in ends), max(float(high) for _, high in ends)


def _second(one: SimulatedCandidate) -> float | None:
    """Return the root mean square of what a law is off on a second record; None without one."""
    errors = [*one.second.values()]
    return float(np.sqrt(np.mean(np.square(errors)))) if errors else None


COLUMNS: Final[Columns[SimulatedCandidate]] = (
    Column(
        key="law", title="law", page="law", numeric=False,
        value=lambda item: item.name, text=lambda item: item.title,
        aside=lambda item: "" if item.outcome.endswith("probable") else item.outcome,
    ),
    Column(
        key="parameters", title="parameters", page="parameters", phone="label",
        value=lambda item: item.parameters,
        text=lambda item: str(item.parameters) if item.fit else None,
    ),
    Column(
        key="leaves", title="leaves", page="leaves", phone="label",
        value=lambda item: item.score, text=lambda item: score_text(PLAIN, item.score),
    ),
    Column(
        key="probability", title="probability", page="probability", phone="label",
        value=lambda item: item.probability,
        text=lambda item: probability_text(item.probability) if item.fit else None,
    ),
)  # fmt: skip
"""What tables say of each law of any kind, ..."""
LAST: Final[Columns[SimulatedCandidate]] = (
    Column(
        title="second record", page="second record", phone="label", optional=True,
        value=_second, text=lambda item: score_text(PLAIN, _second(item)),
    ),
    Column(key="outcome", value=lambda item: plain(item.outcome)),
)  # fmt: skip
"""... after what they say of some."""


class OtherSetting(NamedTuple):
    """What fitted laws predict at another setting, and what a record there would tell."""

    name: str
    """What is set: ``"speed"``, ``"stiffness"`` or ``"load"``."""
    value: float
    """To which value [SI]."""
    predicted: Mapping[str, Mapping[str, float]]
    """Medians by name of the law: features, of which a frequency is 0 if the block slides on, or
    the coefficient of friction after a step, less that at the reference speed."""
    expected_width: float
    """Expected width of what is asked, over that of now: which law, or its parameters."""

    def expectation(self, others: Sequence[Any]) -> str:
        """Return what the uncertainty is expected to fall to, beside other laws or none."""
        unknown = "which law holds" if others else "its parameters"
        share = significant(100.0 * self.expected_width, 2)
        return f"the uncertainty about {unknown} is expected to fall to {share} %"


class SimulatedKind(Kind[AnyFit, SimulatedVerdict]):
    """What is measured, seven texts, and figures."""

    uses = frozenset({"route", "validate"})
    these: ClassVar[str] = "this record"
    """What was measured, as the subject of a sentence."""
    levels: ClassVar[Any] = None
    """What levels of the laws are over, if the mechanism does not say it."""
    drawn: ClassVar[tuple[str, str]]
    """What the figure shows, and its unit."""
    starts: ClassVar[int] = 4
    """Searches of each law that are followed to their end."""
    fit_class: ClassVar[type[SimulatedFit[Any]]] = SimulatedFit
    """Class of the fits ..."""
    verdict_class: ClassVar[type[SimulatedVerdict]] = SimulatedVerdict
    """... and of the verdicts."""

    # what is measured
    @abstractmethod
    def laws(self, laws: SeveralLaws | None) -> Mapping[str, Any]:
        """Return the laws that are compared by name: those given, or the usual ones."""

    def refused(self, law: Any) -> str:
        """Return why nothing that was measured tells a law; empty if something does."""
        return ""

    def problem(
        self, request: Request, laws: Mapping[str, Any], vary: str | Sequence[str] | None
    ) -> Simulated:
        """Return the measurement as rows, with laws and what is looked for of them."""
        raise NotImplementedError(f"{type(self).__name__} defines neither problem nor weighed")

    def weighed(
        self, request: Request, laws: Mapping[str, Any], vary: str | Sequence[str] | None
    ) -> tuple[Readable, Weighed]:
        """Return the measurement as rows, and the laws weighed by it."""
        settings, problem = request.settings, self.problem(request, laws, vary)
        starts = settings.starts if settings and "starts" in self.settings else self.starts
        return problem, SimulatedPosterior(
            problem, starts=starts, seed=settings.seed if settings else 0, watch=request.progress
        )

    def over_all(self, fits: Sequence[AnyFit], one: Estimate) -> Estimate:
        """Return an estimate of the closest law with its interval over the laws that have it."""
        low, high = pooled(fits, one.path)
        return replace(one, low=min(low, one.low), high=max(high, one.high))

    def errors(self, fit: AnyFit, measurement: Measurement) -> Mapping[str, float]:
        """Return what a law is off on another record, by what is compared."""
        raise InputError(f"other {self.measured} are not predicted: give them by validate instead.")

    # texts
    @abstractmethod
    def called(self, fit: AnyFit) -> str:
        """Return what a law is called within a sentence."""

    def fault(self, fit: AnyFit) -> str:
        """Return what the closest law does that contradicts the measurement, as a predicate."""
        return ""

    def doubt(self, fit: AnyFit) -> str:
        """Return why a law is closest, but not all that acts, as a clause; empty if it may be."""
        return ""

    def about(self, fit: AnyFit) -> str:
        """Return what is to be said first of the closest law, in sentences."""
        return f"The root mean square of its residuals is {self.left(fit)}."

    def left(self, fit: AnyFit) -> str:
        """Return the root mean square of what a fit leaves, with its unit if it has one."""
        return significant(fit.rms, 2)

    def settled(self, fit: AnyFit) -> Iterable[str]:
        """Return what the measurement tells beside the parameters, in sentences."""
        return ()

    def untold(self, fit: AnyFit) -> Iterable[str]:
        """Return what the measurement does not tell, in sentences."""
        return ()

    def advice(
        self, fit: AnyFit, others: Sequence[AnyFit], advised: Sequence[Any]
    ) -> Iterable[str]:
        """Return what to measure next, given which laws cannot be distinguished, in sentences."""
        return ()

    # further numbers and figures
    own_columns: ClassVar[Columns[SimulatedCandidate]] = ()
    """What tables say of each law beside what they say of all."""

    def details(self, fit: AnyFit) -> Mapping[str, Any]:
        """Return what only fits of this kind say, as plain numbers and strings."""
        return {}

    def largest_speed(self, fit: AnyFit) -> float | None:
        """Return the largest speed that was measured [m/s]; None if it is not known."""
        return None

    def advised(self, fits: Sequence[AnyFit]) -> Sequence[Any]:
        """Return further records by what they would tell, as named tuples."""
        return ()

    def foreseen(self, fit: AnyFit, setting: Any) -> Array:
        """Return draws (k, m) of what is compared, of another record."""
        raise InputError(f"other {self.measured} are not foreseen: give them by validate instead.")

    def pieces(
        self, fit: AnyFit, others: Sequence[AnyFit]
    ) -> Sequence[tuple[str, Array, Array, Mapping[str, Array]]]:
        """Return what the figure shows: name, times, measured, and by title what laws have (n,)."""
        return ()

    # what all kinds share
    @property
    def all_columns(self) -> Columns[SimulatedCandidate]:
        """What tables say of each law."""
        return (*COLUMNS, *self.own_columns, *LAST)

    def candidates(self, laws: SeveralLaws | None, measurement: Measurement) -> list[str]:
        return [*self.laws(laws)]

    def fit(self, request: Request) -> AnyFit:
        watch, laws = request.progress, self.laws([request.law])
        verdict = self._verdict(
            replace(request, progress=watch and (lambda _, rms: watch(rms))), laws, request.vary
        )
        assert verdict.closest.fit is not None
        return replace(verdict.closest.fit, verdict=verdict)

    def select(self, request: Request) -> SimulatedVerdict:
        varied = [LAW, *request.parameters(None).unknown]
        return self._verdict(request, self.laws(request.laws), varied)

    def _verdict(
        self, request: Request, laws: Mapping[str, Any], vary: str | Sequence[str] | None
    ) -> SimulatedVerdict:
        mechanism, measurement = request.mechanism, request.measurement
        checks = checked(mechanism, measurement, request.validate, conditions=self.conditions)
        refused = {name: why for name, law in laws.items() if (why := self.refused(law))}
        tried = {name: law for name, law in laws.items() if name not in refused}
        if laws and not tried:
            raise InputError(self._none(refused))
        problem, posterior = self.weighed(request, tried, vary)
        every = [self._candidate(name, problem, posterior, request) for name in posterior.families]
        every += [
            SimulatedCandidate(kind=self, name=name, title=laws[name].title, fit=None, dropped=why)
            for name, why in refused.items()
        ]
        if all(item.fit is None for item in every):
            raise ConvergenceError(self._none({item.title: item.dropped for item in every}))
        ordered = sorted(every, key=lambda item: (item.fit is None, -item.probability))
        return self._judged(ordered, request, checks)

    def _none(self, why: Mapping[str, str]) -> str:
        texts = "; ".join(f"{name}: {text}" for name, text in why.items())
        return f"no law can be compared with {self.these}: {texts}"

    def bare(self, problem: Any, name: str) -> SimulatedCandidate:
        """Return a candidate without its fit."""
        return SimulatedCandidate(kind=self, name=name, title=problem.title(name), fit=None)

    def _candidate(
        self, name: str, problem: Any, posterior: Weighed, request: Request
    ) -> SimulatedCandidate:
        """Return a candidate with its fit; one of which no run works has the reason."""
        bare, family = self.bare(problem, name), posterior.families[name]
        if not np.isfinite(family.rms):
            return replace(bare, dropped=problem.failed(name))
        mode = problem.read(name, family.mode[None], family.usual[None])
        law, mechanism = problem.result(name, {path: float(x[0]) for path, x in mode.items()})
        known, derived = problem.quantities(name), problem.derived(name)
        sought = {path: known[path] for path in problem.sought(name)}
        fit = self.fit_class(
            law=law,
            mechanism=mechanism,
            estimates=tuple(problem.told(family, name, estimated(problem, name, family, sought))),
            derived=estimated(problem, name, family, derived),
            cancelled=posterior.cancelled,
            kind=self,
            measurement=request.measurement,
            name=name,
            problem=problem,
            posterior=posterior,
        )
        second = {} if request.validate is None else fit.judged(request.validate)
        return replace(bare, fit=fit, probability=posterior.shares[name], second=second)

    def _judged(
        self,
        ordered: Sequence[SimulatedCandidate],
        request: Request,
        checks: Checks,
    ) -> SimulatedVerdict:
        """Return the verdict on candidates, the most probable first, in words."""
        closest, *others = ordered
        assert closest.fit is not None
        near = [
            other
            for other in others
            if other.fit and other.probability * RIVAL > closest.probability
        ]
        contains = closest.fit.problem.contains
        rivals = [item for item in near if not contains(item.name, closest.name)]
        fits = [closest.fit, *(item.fit for item in near if item.fit)]
        fault = self.fault(closest.fit)

        def outcome(one: SimulatedCandidate) -> str:
            if one is closest:
                return f"closest, but {fault}" if fault else "named"
            if one.fit is None:
                return f"not fitted: {one.dropped}"
            if one in near:
                return NOT_RULED_OUT if one in rivals else "contains the named law"
            return f"{probability_text(one.probability)} probable"

        told = [replace(item, outcome=outcome(item)) for item in ordered]
        advised = tuple(item for item in self.advised(fits) if item.expected_width < WORTH)
        intervals = tuple(self.over_all(fits, estimate) for estimate in closest.fit.estimates)
        return self.verdict_class(
            kind=self,
            mechanism=request.mechanism,
            measurement=request.measurement,
            words=self._words(closest, near, rivals, intervals, advised, checks, len(others)),
            candidates=tuple(told),
            best=None if fault else told[0],
            ranked=bool(others) and not rivals,
            checks=checks,
            intervals=intervals,
            near=tuple(item.name for item in fits),
            rivals=tuple(rival.name for rival in rivals),
            advised=advised,
        )

    def _words(
        self,
        closest: SimulatedCandidate,
        near: Sequence[SimulatedCandidate],
        rivals: Sequence[SimulatedCandidate],
        intervals: Sequence[Estimate],
        advised: Sequence[Any],
        checks: Checks,
        others: int,
    ) -> Wording:
        fit = closest.fit
        assert fit is not None
        alike = [rival.fit for rival in (closest, *rivals) if rival.fit]
        phrase, fault, doubt = self.called(fit), self.fault(fit), self.doubt(fit)
        if fault:
            verdict = f"No law compared explains {self.these}; the closest, {phrase}, {fault}."
        else:
            verdict = f"{capital(phrase)} is closest, but {doubt}" if doubt else f"Use {phrase}"
            names = [self.called(item) for item in alike[1:]]
            verdict += f"; {cannot_rule_out(names, self.these)}." if names else "."
        fits = [fit, *(item.fit for item in near if item.fit)]
        pairs = [*zip(fit.estimates, intervals, strict=True)]
        pairs += [(item, self.over_all(fits, item)) for item in fit.derived]
        shares = [
            f"{self.called(item.fit)} is {probability_text(item.probability)} probable"
            for item in near if item.fit
        ]  # fmt: skip
        is_weighed = bool(others) and not fault and not fit.problem.repeated
        which = "Which law" if rivals else "Whether there is more"
        cannot = [f"{which}: {joined(shares)}."] if shares and is_weighed else []
        cannot += fit.family.few_draws
        cannot += [
            f"${estimate.quantity.symbol}$: {estimate.reason}."
            for estimate in fit.estimates
            if estimate.reason
        ]
        cannot += self.untold(fit)
        if fit.cancelled:
            cannot.append("Whether there is a better fit: the search was stopped before its end.")
        further = [*self.advice(fit, fits[1:], advised), *corrections(checks)]
        share = f"{probability_text(closest.probability)} probable among {others + 1} laws. "
        several = list(map(self.called, alike))
        if len(several) > MOST + 1:
            several[MOST:] = [f"{len(several) - MOST} more"]
        same = joined(several)
        no_score = f"{capital(same)} cannot be ranked: each may hold." if rivals else ""
        return Wording(
            verdict=verdict,
            lede=share * is_weighed + self.about(fit),
            settles=() if fault else (
                *(parameter_sentence(own, every, phrase) for own, every in pairs if own.bounded),
                *self.settled(fit),
            ),
            cannot_tell=(*cannot, UNMEASURED),
            measure_next=with_order(further, checks.findings, MOST),
            no_score=no_score if others else ONE_LAW,
        )  # fmt: skip

    def comparison(self, verdict: SimulatedVerdict) -> Comparison:
        heads, rows = terminal_table(self.all_columns, verdict.candidates)
        closest = verdict.candidates[0]
        values = [every for _, every in verdict.stated]
        return Comparison(
            heads=heads,
            rows=rows,
            notes=[f"{candidate.title}: {candidate.outcome}" for candidate in verdict.candidates],
            checks=verdict.checks,
            fitted=(OVER_ALL_LAWS.format(closest.title), values) if values else None,
        )

    def summary(self, fit: AnyFit, validate: Measurement | None = None) -> FitSummary:
        assert fit.verdict is not None
        lines = [fit.verdict.words.verdict, fit.verdict.words.lede]
        second = {} if validate is None else fit.judged(validate)
        if second:
            errors = [f"{name.replace('_', ' ')} {significant(x, 2)}" for name, x in second.items()]
            lines.append(f"On the second record: {joined(errors)}")
        return FitSummary(
            lines=[*lines, *fit.remarks],
            open=("Limitations", fit.sentences),
            second=second or None,
        )

    def sections(
        self, verdict: SimulatedVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        middle = partial(figure_section, verdict), partial(laws_section, verdict)
        return sections_of(verdict, origin, remark, *middle)


def figure_section(verdict: SimulatedVerdict) -> Section | None:
    """Return the figure of what was measured and what laws have; None without any."""
    from stickslip.show.plots import Piece, draw_pieces, inline_svg, piece_sizes

    fit = verdict.fits[0]
    others = [candidate.fit for candidate in verdict.candidates[1:] if candidate.fit is not None]
    others.sort(key=lambda item: item.name not in verdict.rivals)
    pieces = [Piece(*piece) for piece in verdict.kind.pieces(fit, others[:1])]
    if not pieces:
        return None
    (what, unit), titles = verdict.kind.drawn, [*pieces[0].predicted]
    svg = inline_svg(
        draw_pieces(pieces, what, unit, chosen=fit.law.title),
        alt=f"{capital(what)} over time, measured and by {joined(titles)}",
        prefix="runs-figure",
        **piece_sizes(len(pieces)),
    )
    caption = (
        f"**{capital(what)}**, measured (grey) and by {joined(titles)}. Error: measured less that."
    )
    block = Figure(svg=svg, caption=caption)
    return Section(id="runs", nav="Runs", heading=f"Measured and fitted {what}", blocks=(block,))


def laws_section(verdict: SimulatedVerdict) -> Section:
    """Return the table of the laws."""
    table = page_table(
        verdict.kind.all_columns,
        verdict.candidates,
        chosen=verdict.best,
        caption="Probability: the likelihood of a law, averaged over its parameters, the uncertain"
        " values of the mechanism and a small discrepancy that no law describes, so that laws of"
        " many parameters gain nothing by them. A law is ruled out at odds of 100 to 1 against it."
        " Leaves: root mean square of the residuals. The effective sample size of the draws of the"
        f" closest law is {significant(verdict.fits[0].family.effective, 2)}.",
    )
    heading = f"{count(len(verdict.candidates), 'law')} by probability"
    if verdict.rivals:
        heading = f"{len(verdict.near)} laws are not ruled out by {verdict.kind.these}"
    return Section(id="models", nav="Laws", heading=heading, blocks=(table,))
