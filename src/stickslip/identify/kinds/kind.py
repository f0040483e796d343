"""What belongs to one kind of measurement, from its fit to its page."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Generic, Literal, TypeAlias

from typing_extensions import TypeVar

from stickslip.data import Checks, Measurement
from stickslip.friction import FrictionLaw, specification
from stickslip.identify.candidates import Candidate, Verdict
from stickslip.identify.fits import (
    LAW,
    AnyLaw,
    Estimate,
    Fit,
    Parameters,
    RecordSettings,
    known_inputs,
    names_of,
)
from stickslip.mechanisms import Mechanism
from stickslip.show.formatting import NO_VALUE, EstimateText, number, with_unit
from stickslip.show.report import Cell, Name, Number, Origin, Row, SectionMaker, Table
from stickslip.show.report import Column as PageColumn

# Tables of candidates: one list of columns for DataFrames, terminals and pages.

C = TypeVar("C", bound=Candidate[Any])
Shown: TypeAlias = str | EstimateText | None


@dataclass(frozen=True, kw_only=True)
class Column(Generic[C]):
    """What a table says of each candidate; a medium without a name for it leaves it out."""

    key: str = ""
    """Its name in a DataFrame."""
    title: str = ""
    """Its heading on a terminal."""
    page: str = ""
    """Its heading on a page; a line break stands before what is set small."""
    value: Callable[[C], object] = lambda _: None
    """Number [SI] or text for a DataFrame."""
    text: Callable[[C], Shown] = lambda _: None
    """What people read, without the unit; None where there is nothing."""
    aside: Callable[[C], str] = lambda _: ""
    """What a page says below the text."""
    unit: str = ""
    """Unit of the text, which a terminal says in the cell and a page in the heading."""
    why_empty: str = NO_VALUE
    """What a page says where there is nothing."""
    optional: bool = False
    """Whether the column is left out where all values are None."""
    numeric: bool = True
    """Whether a page aligns its cells to the right."""
    phone: Literal["show", "hide", "label"] = "show"
    """What becomes of it on a phone."""
    label: str = ""
    """Its label there, if not the heading."""

    def on_terminal(self, one: C) -> str:
        """Return the cell of a candidate on a terminal."""
        text = self.text(one)
        if text is None:
            return NO_VALUE
        return with_unit(text if isinstance(text, str) else " ".join(text).strip(), self.unit)

    def on_page(self, one: C) -> Cell:
        """Return the cell of a candidate on a page."""
        text = self.text(one)
        if text is None:
            return self.why_empty
        if aside := self.aside(one):
            return Name(text=str(text), aside=aside)
        return text if isinstance(text, str) else Number(value=text.value, doubt=text.doubt)


Columns: TypeAlias = Sequence[Column[C]]


def data_row(columns: Columns[C], one: C) -> dict[str, Any]:
    """Return a candidate as a row of a DataFrame."""
    return {column.key: column.value(one) for column in columns if column.key}


def terminal_table(columns: Columns[C], rows: Sequence[C]) -> tuple[list[str], list[list[str]]]:
    """Return headings and cells of a table on a terminal."""
    shown = [column for column in columns if column.title and _is_shown(column, rows)]
    return [item.title for item in shown], [
        [item.on_terminal(row) for item in shown] for row in rows
    ]


def page_table(columns: Columns[C], rows: Sequence[C], *, chosen: C | None, caption: str) -> Table:
    """Return the table of a page, with the row of a chosen candidate marked."""
    shown = [column for column in columns if column.page and _is_shown(column, rows)]
    heads = tuple(
        PageColumn(
            head=f"{column.page}\n{column.unit}" if column.unit else column.page,
            numeric=column.numeric,
            phone=column.phone,
            label=column.label,
        )
        for column in shown
    )
    cells = [tuple(column.on_page(row) for column in shown) for row in rows]
    marked = zip(cells, rows, strict=True)
    made = [Row(cells=x, chosen=row is chosen, muted=bool(row.dropped)) for x, row in marked]
    return Table(columns=heads, rows=tuple(made), caption=caption)


def _is_shown(column: Column[C], rows: Sequence[C]) -> bool:
    return not column.optional or any(column.value(row) is not None for row in rows)


F = TypeVar("F", bound="Fit[Any]")
V = TypeVar("V", bound=Verdict)
Law: TypeAlias = Any
"""A law, a type or a name, of the type that a kind fits: `FrictionLaw`, or `RateState`."""
SeveralLaws: TypeAlias = Any
"""A mapping or a sequence of such laws."""


@dataclass(frozen=True, kw_only=True)
class Request:
    """What `fit` and `select` are asked; None where nothing was said.

    Each kind uses some of the `OPTIONS`, see `Kind.uses`, and refuses the rest.
    """

    mechanism: Mechanism
    """Mechanism that was measured."""
    measurement: Measurement
    """Travels, records in time, measured friction, or the force of a spring."""
    law: Law = None
    """The law to fit: an instance, whose values are the start, a type, or a name."""
    laws: SeveralLaws = None
    """The candidates of a selection; the usual ones if None."""
    vary: str | Sequence[str] | None = None
    """Parameters to fit; ``"friction.*"`` if None."""
    fixed: Mapping[str, float] | None = None
    """Values of parameters that are held [SI], by the same names."""
    progress: Callable[..., object] | None = None
    """Called with the number of runs or the least residual so far, after the name of the law where
    several are compared; False ends searches in records."""
    route: str | None = None
    """Name of the route for records."""
    settings: RecordSettings | None = None
    """Hold of a force, starts and seed of laws by runs."""
    validate: Measurement | None = None
    """A second record, which no fit sees."""
    assumed: Mapping[str, Sequence[str]] | None = None
    """By name of the law, parameters whose values were assumed."""
    t_end: float | None = None
    """Time after which a body counts as stopped [s]."""
    tolerance: float | None = None
    """Share of friction by which a law that is named may be off."""

    def arguments(self, *names: str) -> dict[str, Any]:
        """Return arguments of a function that fits or selects: those that all take, and more."""
        of_all = ("mechanism", "measurement", "vary", "fixed")
        return {name: getattr(self, name) for name in (*of_all, *names)}

    def parameters(self, law: Any) -> Parameters[Any]:
        """Return what `vary` and `fixed` say of the mechanism and a law; None for several laws."""
        return Parameters.of(
            self.mechanism, law, self.vary, self.fixed, measurement=self.measurement
        )

    @property
    def given(self) -> tuple[str, ...]:
        """Names of the options that were given."""
        return tuple(name for name in OPTIONS if getattr(self, name) is not None)

    def only(self, names: Collection[str]) -> "Request":
        """Return the request without the options that have other names."""
        nothing: dict[str, Any] = dict.fromkeys({*self.given}.difference(names))
        return replace(self, **nothing)


OPTIONS = ("route", "settings", "validate", "assumed", "t_end", "tolerance")
"""What may be said of how; each kind uses some of it."""


OVER_ALL_LAWS = "Parameters of {}, over all laws"
"""Title of the parameters of a law, with the intervals to quote."""


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """The laws of a verdict beside each other, as a terminal shows them."""

    heads: Sequence[str]
    """Titles of the columns."""
    rows: Sequence[Sequence[str]]
    """Cells, a row for each law."""
    notes: Sequence[str] = ()
    """Lines below: what became of each law, and why a cell is empty."""
    checks: Checks | None = None
    """What is doubtful about the record."""
    fitted: tuple[str, Sequence[Estimate]] | None = None
    """The law that is named or closest, with its parameters, where the table does not have them."""


@dataclass(frozen=True, kw_only=True)
class FitSummary:
    """What a terminal shows of a fit below its estimates."""

    heads: Sequence[str] = ()
    """Titles of the columns of a table; empty for no table."""
    rows: Sequence[Sequence[str]] = ()
    """Cells of that table."""
    lines: Sequence[str] = ()
    """Residuals, remarks."""
    findings: Sequence[str] = ()
    """Errors of the model."""
    limits: Sequence[str] = ()
    """What limits each interval: the readings, or the rig."""
    open: tuple[str, Sequence[str]] = ("Limitations", ())
    """What is left open, below a heading."""
    second: float | Mapping[str, float] | None = None
    """Error on a second record, for documents."""


class Kind(ABC, Generic[F, V]):
    """How one kind of measurement is fitted, compared and shown; the only place that knows.

    A kind of one's own is a subclass, registered by an entry point ``stickslip.kinds``.
    """

    routes: ClassVar[tuple[str, ...]]
    """Ways to fit, which ``route=`` may ask for; each fit and verdict says one of these."""
    measured: ClassVar[str]
    """What was measured, in the plural, such as ``"travels"``."""
    content: ClassVar[str] = ""
    """What `Measurement.content` says of one of this kind, where `serves` is the usual one."""
    uses: ClassVar[frozenset[str]]
    """Names of the `OPTIONS` that are used."""
    settings: ClassVar[frozenset[str]] = frozenset()
    """Names of the fields of `RecordSettings` that are used; any makes `settings` an option."""
    has_criteria: ClassVar[bool] = False
    """Whether candidates meet or miss the criteria of runs to rest, which ``--enforce`` heeds."""
    counts_runs: ClassVar[bool] = False
    """Whether progress is a number of runs; else it is the least residual so far."""
    by_contact: ClassVar[bool] = False
    """Whether laws are given by the name of the contact."""
    fits: ClassVar[type] = FrictionLaw
    """Base class of the laws that are fitted."""
    usual_law: ClassVar[str] = "coulomb-viscous"
    """Law that a command fits where none is named."""
    simulated: ClassVar[bool] = True
    """Whether fitted laws can be simulated, and written as rig files."""
    conditions: ClassVar[frozenset[str]] = frozenset()
    """Names of the conditions of trials that are used, without their units."""

    def __init_subclass__(cls) -> None:
        """Check the names of options and settings: a misspelt one would never be used."""
        super().__init_subclass__()
        fields_ = [field.name for field in fields(RecordSettings)]
        known: Collection[str]
        for own, of, known in (
            ("uses", "option of Request", OPTIONS),
            ("settings", "field of RecordSettings", fields_),
        ):
            if wrong := sorted({*getattr(cls, own, ())}.difference(known)):
                raise TypeError(
                    f"{cls.__name__}.{own} has {wrong[0]!r}, which is no {of};"
                    f" known: {', '.join(sorted(known))}."
                )
        if cls.settings:
            cls.uses |= {"settings"}

    def serves(self, measurement: Measurement) -> bool:
        """Whether a measurement is of this kind, where nobody asks for a route."""
        return measurement.content == self.content

    def reads(self, measurement: Measurement) -> bool:
        """Whether another measurement is read as one of this kind where its route is asked for."""
        return False

    @abstractmethod
    def candidates(self, laws: SeveralLaws | None, measurement: Measurement) -> list[str]:
        """Return the names of the laws that are compared, as progress calls them."""

    def owner(self, law: Law) -> AnyLaw:
        """Return the law or the type whose parameters a law has that may be given by its name."""
        result: AnyLaw = law
        if isinstance(law, str):
            other: Any = self.fits
            result = specification(law).law if other is FrictionLaw else other
        return result

    def law_and_parameters(
        self, law: Law, vary: str | Sequence[str] | None, fixed: Collection[str] = ()
    ) -> tuple[Law, str | Sequence[str] | None]:
        """Return the law that a name stands for, with what is fitted of it put into `vary`.

        Names of other laws than `FrictionLaw` are left to the fit.
        """
        if not isinstance(law, str) or self.fits is not FrictionLaw:
            return law, vary
        result = specification(law)
        if result.free is None:
            return result.law, vary
        own = [
            f"friction.{item}" for item in result.free if not {item, f"friction.{item}"} & {*fixed}
        ]
        names = [LAW] if vary is None else names_of(vary)
        return result.law, [path for name in names for path in (own if name == LAW else [name])]

    @abstractmethod
    def fit(self, request: Request) -> F:
        """Fit a law."""

    @abstractmethod
    def select(self, request: Request) -> V:
        """Compare laws and name one."""

    @abstractmethod
    def comparison(self, verdict: V) -> Comparison:
        """Return the table of a verdict."""

    @abstractmethod
    def summary(self, fit: F, validate: Measurement | None = None) -> FitSummary:
        """Return what a terminal shows of a fit, with its error on a second record."""

    @abstractmethod
    def sections(self, verdict: V, origin: Origin, remark: str) -> tuple[SectionMaker, ...]:
        """Return what makes the sections of the page of a verdict."""

    def known_inputs(self, mechanism: Mechanism, measurement: Measurement) -> Collection[str]:
        """Return the contact inputs that laws may depend on."""
        return known_inputs(mechanism, measurement)

    def residual_text(self, error: float, request: Request) -> str:
        """Return the least residual so far in words; without what it is of, if not replaced."""
        return f"residual {number(error, 2)}"

    def resolved(self, request: Request) -> Request:
        """Return the request with what is chosen for this measurement, before any fit."""
        return request

    def why_unused(self, name: str, request: Request) -> str:
        """Return why an option or a setting that some kinds use has no effect here.

        It is the end of a sentence that begins with the name, and empty where nothing special is to
        be said.
        """
        return ""
