"""What belongs to one kind of measurement, from its fit to its page."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, fields
from typing import ClassVar, Generic, TypeVar, final

from stickslip.experiments import Checks, Measurement
from stickslip.friction import FrictionLaw, specification
from stickslip.identification import Estimate, Fit, RecordSettings, TrialComparison
from stickslip.identification.records.route_choice import RouteChoice
from stickslip.identification.validation import LAW, Laws, names_of
from stickslip.mechanisms import Mechanism
from stickslip.report.core.documents import Origin, SectionMaker
from stickslip.selection import Verdict
from stickslip.selection.records import PurposeName

__all__ = [
    "Comparison",
    "FitRequest",
    "FitSummary",
    "Options",
    "Progress",
    "Request",
    "Route",
    "SelectRequest",
]

F = TypeVar("F", bound=Fit)
V = TypeVar("V", bound=Verdict)
Progress = Callable[[str, float], object]
"""Called with the name of a law and how far its search is; False ends searches in records."""


@final
@dataclass(frozen=True, kw_only=True)
class Options:
    """What `fit` and `select` may be told beside the request; None where nothing was said.

    Each route uses some of it, `Route.uses`, and refuses the rest.
    """

    route: str | RouteChoice | None = None
    settings: RecordSettings | None = None
    purpose: PurposeName | None = None
    horizon: float | None = None
    validate: Measurement | None = None
    assumed: Mapping[str, Sequence[str]] | None = None
    t_end: float | None = None

    @property
    def given(self) -> tuple[str, ...]:
        """Names of what was said."""
        return tuple(f.name for f in fields(self) if getattr(self, f.name) is not None)

    def only(self, names: Collection[str]) -> "Options":
        """Return what was said under some names."""
        return Options(**{name: getattr(self, name) for name in self.given if name in names})


@dataclass(frozen=True, kw_only=True)
class Request:
    """What was measured, and what is fitted beside the laws."""

    mechanism: Mechanism
    measurement: Measurement
    vary: str | Sequence[str] | None = None
    fixed: Mapping[str, float] | None = None


@final
@dataclass(frozen=True, kw_only=True)
class FitRequest(Request):
    """A law to fit."""

    law: FrictionLaw | type[FrictionLaw]
    progress: Callable[[float], object] | None = None


@final
@dataclass(frozen=True, kw_only=True)
class SelectRequest(Request):
    """Laws to compare."""

    laws: Laws | None
    progress: Progress | None = None
    executor: Executor | None = None


@final
@dataclass(frozen=True, kw_only=True)
class Comparison:
    """The laws of a verdict beside each other, as a terminal shows them."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    notes: Sequence[str] = ()
    """Lines below: what became of each law, and why a cell is empty."""
    checks: Checks | None = None
    """What is doubtful about the record."""
    fitted: tuple[str, Sequence[Estimate]] | None = None
    """The law that is named or closest, with its parameters, where the table does not have them."""
    trials: TrialComparison | None = None
    """Whether several trials share one law."""


@final
@dataclass(frozen=True, kw_only=True)
class FitSummary:
    """What a terminal shows of a fit below its estimates."""

    heads: Sequence[str] = ()
    rows: Sequence[Sequence[str]] = ()
    lines: Sequence[str] = ()
    """Residuals, restarts, remarks."""
    findings: Sequence[str] = ()
    """Errors of the model."""
    limits: Sequence[str] = ()
    """What limits each interval: the readings, or the rig."""
    open: tuple[str, Sequence[str]] = ("Limitations", ())
    """What is left open, below a heading."""
    second: float | Mapping[str, float] | None = None
    """Error on a second record, for documents."""
    trials: TrialComparison | None = None
    """Whether several trials share the law."""


class Route(ABC, Generic[F, V]):
    """How one kind of measurement is fitted, compared and shown; the only place that knows.

    A route of one's own is a subclass, registered by an entry point ``stickslip.routes``.
    """

    names: ClassVar[tuple[str, ...]]
    """What ``route=`` may ask for; each fit and verdict says one of these."""
    measured: ClassVar[str]
    """What was measured, in the plural, such as ``"travels"``."""
    uses: ClassVar[frozenset[str]]
    """Names of `Options`, and of fields of `RecordSettings`, that are used."""
    counts_runs: ClassVar[bool] = False
    """Whether progress is a number of runs; else it is the least residual so far."""

    @abstractmethod
    def serves(self, measurement: Measurement) -> bool:
        """Whether a measurement is of this kind, where nobody asks for a route."""

    @abstractmethod
    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        """Return the names of the laws that are compared, as progress calls them."""

    def law_and_parameters(
        self,
        law: FrictionLaw | type[FrictionLaw] | str,
        vary: str | Sequence[str] | None,
        fixed: Collection[str] = (),
    ) -> tuple[FrictionLaw | type[FrictionLaw], str | Sequence[str] | None]:
        """Return the law that a name stands for, with what is fitted of it put into `vary`.

        Parameters
        ----------
        law : FrictionLaw, type or str
            A law, or a name such as ``"dahl-exponent"``, which also says what is free.
        vary : str or sequence of str, optional
            What is asked to be fitted.
        fixed : collection of str
            Names of what is held.
        """
        if not isinstance(law, str):
            return law, vary
        found = specification(law)
        if found.free is None:
            return found.law, vary
        own = [f"friction.{one}" for one in found.free if not {one, f"friction.{one}"} & {*fixed}]
        names = [LAW] if vary is None else names_of(vary)
        return found.law, [path for one in names for path in (own if one == LAW else [one])]

    @abstractmethod
    def fit(self, request: FitRequest, options: Options) -> F:
        """Fit a law."""

    @abstractmethod
    def select(self, request: SelectRequest, options: Options) -> V:
        """Compare laws and name one."""

    @abstractmethod
    def comparison(self, verdict: V) -> Comparison:
        """Return the table of a verdict."""

    @abstractmethod
    def summary(
        self, fit: F, validate: Measurement | None = None, horizon: float | None = None
    ) -> FitSummary:
        """Return what a terminal shows of a fit, with its error on a second record."""

    @abstractmethod
    def sections(self, verdict: V, origin: Origin, remark: str) -> tuple[SectionMaker, ...]:
        """Return what makes the sections of the page of a verdict."""

    def residual_text(self, error: float, measurement: Measurement, options: Options) -> str:
        """Return the least residual so far in words."""
        raise NotImplementedError  # where runs are counted, nobody asks

    def resolved(
        self, request: Request, options: Options, law: FrictionLaw | type[FrictionLaw] | None = None
    ) -> Options:
        """Return the options with what is chosen for this measurement, before any fit.

        Parameters
        ----------
        request : Request
            What was measured.
        options : Options
            What was said.
        law : FrictionLaw or type, optional
            The law, where only one is fitted.
        """
        return options

    def why_unused(self, name: str, options: Options) -> str:
        """Return why an option or a setting that some routes use has no effect here.

        It is the end of a sentence that begins with the name, and empty where nothing special is to
        be said.

        Parameters
        ----------
        name : str
            One of `Options`, or a field of `RecordSettings`.
        options : Options
            With what was chosen for the measurement.
        """
        return ""
