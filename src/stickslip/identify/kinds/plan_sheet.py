"""What `plan` returns: runs to rest, or readings to make, with a table to fill in."""

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.data import Layout, Measurement, Reading, gain_factor
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify import BandVerdict, Verdict
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds.travels import unit_of, words_of
from stickslip.identify.ladder import readings_sentence
from stickslip.identify.problems.tables import TableProblem
from stickslip.identify.selection import (
    further_readings,
    settings_of,
    with_readings,
)
from stickslip.identify.wording import nothing_further
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, parameters
from stickslip.show.described import Described
from stickslip.show.display import Tabular, html_of, summary_of_table
from stickslip.show.formatting import (
    capital,
    count,
    fixed,
    joined,
    number,
    percent,
    quantity,
    significant,
)
from stickslip.show.report import (
    Block,
    Column,
    KeyValue,
    KeyValues,
    Name,
    Note,
    Paragraph,
    Row,
    Section,
    Table,
)
from stickslip.units import converted, is_of

if TYPE_CHECKING:
    import pandas as pd

NUMBER = Quantity("n", low=1, high=300)
"""Readings that a plan may have."""
TRAVEL_COLUMN = "travel [mm]"
"""Column of the table of runs that is filled in."""
BLOCK = 6
"""Settings in one table, so that it fits a terminal of 80 columns."""


def setting_text(value: float, unit: str) -> str:
    """Return a setting [SI] with its unit, lengths in millimetres and angles in degrees.

    Examples
    --------
    >>> setting_text(0.1, "m"), setting_text(math.radians(5.0), "rad")
    ('100 mm', '5°')
    """
    shown, factor = unit_of(unit)
    return f"{number(factor * value, 6)} {shown}".replace(" °", "°")


@dataclass(frozen=True, kw_only=True)
class Separation(metaclass=Described):
    """One setting of the rig and the travel each fitted law predicts for it."""

    path: str
    """Parameter to set."""
    symbol: str
    """Its symbol."""
    unit: str
    """Its SI unit."""
    value: float
    """Setting, SI."""
    predicted: Mapping[str, float]
    """Travel [m] by law."""
    low: float
    """Lower end of the 95 % band of the travel [m] over all candidate laws, before the runs."""
    high: float
    """Its upper end [m]."""
    expected: float
    """Half the width of the band that the runs will leave [m], if the worst of the laws holds."""

    @property
    def half(self) -> float:
        """Half the width of the band before the runs [m]."""
        return 0.5 * (self.high - self.low)

    @property
    def text(self) -> str:
        """The setting with its unit, lengths in millimetres and angles in degrees."""
        return setting_text(self.value, self.unit)

    def to_dict(self) -> Mapping[str, Any]:
        """Return the separation as plain numbers and strings."""
        return {
            "set": {self.path: self.value},
            "predicted_travel": dict(self.predicted),
            "band": [self.low, self.high],
            "expected_half_width": self.expected,
        }


@dataclass(frozen=True, kw_only=True)
class Preparation(metaclass=Described):
    """A parameter to measure before the runs, and how well."""

    path: str
    """Parameter path, such as ``"mechanism.stiffness"``."""
    quantity: Quantity
    """Symbol and unit."""
    value: float
    """As it stands in the rig, SI."""
    needed: float
    """Standard uncertainty at which it adds half as much as the readings to the level's."""
    stated: float | None
    """Standard uncertainty that was stated; None without."""

    @property
    def name(self) -> str:
        """What it is called, in words."""
        return words_of(self.path)

    @property
    def verdict(self) -> str:
        """Whether what was stated is as good as needed."""
        if self.stated is None:
            return "not stated"
        enough = self.stated <= self.needed * (1.0 + 1e-9)
        stated = quantity(self.stated, self.quantity.unit, 2, degrees=True)
        return f"{stated}, {'sufficient' if enough else 'too large'}"

    def to_dict(self) -> Mapping[str, Any]:
        """Return the preparation as plain numbers and strings."""
        return {
            "parameter": self.path,
            "symbol": self.quantity.symbol,
            "unit": self.quantity.unit,
            "value": self.value,
            "needed_uncertainty": self.needed,
            "stated_uncertainty": self.stated,
        }


@dataclass(frozen=True, kw_only=True)
class Plan(Tabular):
    """Which travels to measure, how often and how well, and what they will tell."""

    mechanism: Mechanism
    """The rig."""
    laws: Mapping[str, FrictionLaw]
    """The laws by name, with values that give the same travel at the present setting."""
    reference: str
    """Key of the law whose level the preparations are for."""
    settings: tuple[Separation, ...]
    """What to set, with the travels that the laws predict."""
    repeats: int
    """Runs at each setting."""
    uncertainty: float
    """Standard uncertainty of one travel that was counted on, scatter and reading together [m]."""
    assumed: bool
    """Whether neither a statement nor repeats tell it."""
    preparations: tuple[Preparation, ...]
    """What to measure before."""
    tellings: Mapping[tuple[str, str], int | None]
    """By the law that is taken to hold and the one to be ruled out, the runs at each setting that
    rule it out in nine of ten such sets, the easiest first; None if more than `most`."""
    most: int
    """Runs at each setting beyond which none are asked for."""
    expectations: Mapping[str, tuple[Estimate, ...]]
    """By law, its parameters with the intervals that the runs will give if it holds."""
    range_source: str = ""
    """Where the range of the settings is from and how to change it; nothing if it was given."""
    repeated: int = 0
    """Readings beyond the first at their setting, where their scatter is the uncertainty."""
    from_trials: bool = False
    """Whether levels were fitted to travels; else all laws travel equally far as the rig stands."""
    remarks: tuple[str, ...] = ()
    """What else is to be known."""

    @property
    def knob(self) -> str:
        """What is set, in words."""
        return words_of(self.settings[0].path)

    @property
    def sentence(self) -> str:
        """What to measure and what it tells, in two sentences."""
        unit, factor = unit_of(self.settings[0].unit)
        values = joined([number(factor * setting.value) for setting in self.settings])
        said = (
            f"Set the {self.knob} to {values} {unit}, {count(self.repeats, 'run')} each:"
            f" {len(self.runs())} travels, each measured to {quantity(self.uncertainty, 'm', 2)}."
        ).replace(" °", "°")
        if self.tellings:
            said += f" They distinguish {self.distinguished} of laws."
        return said

    @property
    def distinguished(self) -> str:
        """How many pairs of laws the planned runs distinguish."""
        enough = sum((many or math.inf) <= self.repeats for many in self.tellings.values())
        return f"{enough} of {count(len(self.tellings), 'pair')}"

    @property
    def band_sentence(self) -> str:
        """Where the travel is known least, and how well it will be."""
        widest = max(self.settings, key=lambda setting: setting.half)
        before, after = (quantity(x, "m", 2) for x in (widest.half, widest.expected))
        return (
            f"The travel is known least with the {self.knob} {widest.text}: ± {before} over all"
            f" candidate laws, and ± {after} expected after the runs."
        )

    def csv(self) -> str:
        """Return the table of runs to fill in, as `load_measurement` and ``select --data`` read it.

        Settings go up and then down again, so that wear and drift do not look like their effect.
        """
        text = io.StringIO()
        unit, factor = unit_of(self.settings[0].unit)
        unit = unit.replace("°", "deg")  # a spreadsheet may not read the file as UTF-8
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["name", f"{self.settings[0].path} [{unit}]", TRAVEL_COLUMN])
        writer.writerows(
            [name, f"{factor * run.value:.10g}", ""] for name, run in self.runs().items()
        )
        return text.getvalue()

    def runs(self) -> Mapping[str, Separation]:
        """Return the runs by name, in the order in which to make them."""
        ways = (self.settings, self.settings[::-1])
        order = [item for repeat in range(self.repeats) for item in ways[repeat % 2]]
        return {f"run {i}": item for i, item in enumerate(order, 1)}

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the settings and the travels that each law predicts, as a pandas DataFrame."""
        import pandas as pd

        rows = [{setting.path: setting.value, **setting.predicted} for setting in self.settings]
        return pd.DataFrame(rows)

    def to_dict(self) -> Mapping[str, Any]:
        """Return the plan as plain numbers and strings, ready for JSON."""
        return {
            "plan": self.sentence,
            "band": self.band_sentence,
            "repeats": self.repeats,
            "uncertainty": self.uncertainty,
            "uncertainty_assumed": self.assumed,
            "uncertainty_from_repeats": self.repeated,
            "range_source": self.range_source,
            "laws": {
                name: {p: v for p, v in vars(law).items() if v is not None}
                for name, law in self.laws.items()
            },
            "settings": [setting.to_dict() for setting in self.settings],
            "prepare": [preparation.to_dict() for preparation in self.preparations],
            "tells_apart": [
                {"holds": holds, "ruled_out": rival, "repeats": many}
                for (holds, rival), many in self.tellings.items()
            ],
            "expected": [
                {"law": name, **one.to_dict()}
                for name, own in self.expectations.items()
                for one in own
            ],
            "remarks": [line.replace("$", "") for line in self.remarks],
            "sheet": self.csv(),
        }

    def __repr__(self) -> str:
        return f"<Plan: {self.sentence}>"

    def _repr_html_(self) -> str:
        return html_of(lambda: summary_of_table(self.sentence, self.to_dataframe()), self)


@dataclass(frozen=True, kw_only=True)
class FurtherPlan(Tabular):
    """What to measure beside what was measured, and what it is expected to tell."""

    verdict: Verdict
    """What is known now."""
    lines: tuple[str, ...]
    """What to measure, and what is expected of it, in sentences."""
    readings: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    """Of a table: velocities, loads and inputs (n,) [SI] in the order in which to read friction."""
    widths: tuple[float, ...] = ()
    """Widths of the band after them over that of now: quantiles of 10, 50 and 90 %."""
    chance: float | None = None
    """Probability that the band is halved, or that one law is left."""
    sheet: Measurement | None = None
    """Readings that were made and, last, those to make; of several trials these alone."""

    @property
    def sentence(self) -> str:
        """What to measure, and what is expected of it."""
        return " ".join(self.lines) or "No further measurement is proposed."

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the readings to make as a pandas DataFrame, in their order; empty without any."""
        import pandas as pd

        rows = pd.DataFrame() if self.sheet is None else self.sheet.to_dataframe()
        rows = rows[[name for name in map(str, rows) if not name.startswith("friction")]]
        return rows.tail(len(self.readings.get("velocity", ()))).reset_index(drop=True)

    def csv(self, reading: Reading | None = None) -> str:
        """Return the table to fill in, as `load_measurement` reads it; empty if not of a table.

        Parameters
        ----------
        reading : Reading, optional
            How files of the rig are read: the table then has their columns, units and layout. If
            not given, quantities have their own names, in SI.

        Returns
        -------
        str
            The table, in which friction of the readings to make is empty.

        Raises
        ------
        ParameterError
            If a quantity cannot be converted to the unit of its column.
        """
        if self.sheet is None:
            return ""
        reading = reading or Reading()
        layout, table, heads = reading.layout or Layout(), self.sheet.to_dataframe(), {}
        for column in map(str, table):
            name, unit = column[:-1].split(" [")
            own, gain = reading.units.get(name, unit), reading.gain.get(name, 1.0)
            raw = table[column].to_numpy() + reading.offset.get(name, 0.0)
            raw = raw / (gain_factor(gain, own, unit) if isinstance(gain, str) else gain)
            if own != unit and (gain == 1.0 or is_of(own, unit)) and not isinstance(gain, str):
                zero, at_one = (converted(x, own, unit) for x in (0.0, 1.0))
                raw = (raw - zero) / (at_one - zero)
            if name == "friction":
                raw[-len(self.readings["velocity"]) :] = math.nan
            table[column] = raw
            usual = name.replace("friction", str(reading.columns.get("friction", "friction")))
            heads[f"{reading.columns.get(name, usual)} [{own}]"] = own
        for name in {*reading.conditions} - self.sheet.inputs.keys():
            table[name], heads[name] = self.sheet.conditions.get(name, ""), ""
        text = io.StringIO()
        text.write("\n" * layout.preface)
        writer = csv.writer(text, delimiter=layout.separator, lineterminator="\n")
        writer.writerows([[*heads], [*heads.values()]][: 1 + layout.units_row])
        table.to_csv(text, sep=layout.separator, decimal=layout.decimal, index=False, header=False,
                     lineterminator="\n", float_format="%.12g")  # fmt: skip
        return text.getvalue()

    def to_dict(self) -> Mapping[str, Any]:
        """Return the plan as plain numbers and strings, ready for JSON."""
        return {
            "plan": self.sentence.replace("$", ""),
            "readings": {name: list(x) for name, x in self.readings.items()},
            "band_shrinks_to": list(self.widths),
            "halves_or_decides": self.chance,
            "sheet": self.csv(),
        }

    def _repr_html_(self) -> str:
        return html_of(lambda: summary_of_table(self.sentence, self.to_dataframe()), self)


def further_plan(verdict: Verdict, readings: int | None = None) -> FurtherPlan:
    """Return what to measure next by a verdict: of a table, so many readings.

    Parameters
    ----------
    verdict : Verdict
        What `stickslip.select` says of the first measurement.
    readings : int, optional
        Number of readings of a table, from 1 to 300. If not given, no more than were made, and
        none where all are not expected to narrow the band by a twentieth.

    Returns
    -------
    FurtherPlan
        Readings with the width of the band to expect; of records, what the verdict proposes.

    Raises
    ------
    InputError
        If a number of readings is given and the measurement is no table of friction.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Axis, Measurement, select
    >>> v = np.linspace(0.1, 1.0, 10)
    >>> noise = 0.05 * np.random.default_rng(1).normal(size=10)
    >>> table = Measurement(velocity=v, friction=2.0 + 0.5 * v + noise)
    >>> further = further_plan(select(Axis(inertia=1.0), None, table), 4)
    >>> len(further.readings["velocity"]), further.csv().splitlines()[0]
    (4, 'velocity [m/s],friction [N]')
    """
    problem = verdict.judgement.problem if isinstance(verdict, BandVerdict) else None
    if not isinstance(verdict, BandVerdict) or not isinstance(problem, TableProblem):
        if readings is not None:
            raise InputError(
                "readings is a number of readings of a table of friction, or of runs to rest, and"
                " this measurement is neither: leave it out."
            )
        return FurtherPlan(verdict=verdict, lines=tuple(verdict.words.measure_next))
    many = None if readings is None else int(NUMBER.check("plan", "readings", readings))
    proposal, rows, widths, alone = further_readings(verdict.judgement, many)
    if not proposal.places:
        return FurtherPlan(verdict=verdict, lines=(nothing_further(proposal),))
    low, middle, high = np.quantile(widths, (0.1, 0.5, 0.9)).tolist()
    given = settings_of(problem, rows)
    said = readings_sentence(proposal, **given, measurement=verdict.measurement, listed=True)
    chance = float(np.mean((2.0 * widths <= 1.0) | alone))
    likely = (
        f"With a probability of 80 % its width is {percent(low)} to {percent(high)} of today's; the"
        f" probability that it halves{' or one law is left' * (len(verdict.set) > 1)} is"
        f" {'below 1 %' if chance < 0.01 else percent(round(chance, 2))}."
        " Make the readings in the order of the table, which is random."
    )
    return FurtherPlan(
        verdict=verdict, lines=(said, likely), widths=(low, middle, high), chance=chance,
        readings={"velocity": given["places"], **given["conditions"]},
        sheet=with_readings(verdict.measurement, rows),
    )  # fmt: skip


def plan_sections(plan: Plan) -> tuple[Section, ...]:
    """Return what a plan says, in the order in which it is read.

    Examples
    --------
    >>> from stickslip import SpringBlock, plan
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> sections = plan_sections(plan(rig, ["coulomb", "viscous"], uncertainty=0.004))
    >>> [one.id for one in sections]
    ['plan', 'before', 'settings', 'apart', 'values']
    """
    notes = [Note(title="Note.", text=line) for line in plan.remarks]
    texts = filter(None, (plan.range_source, plan.band_sentence, _uncertainty(plan)))
    lines = [Paragraph(text=text) for text in texts]
    first = Section(id="plan", nav="Plan", heading=plan.sentence, blocks=(*lines, *notes))
    apart = (_apart(plan),) if plan.tellings else ()
    return (first, _before(plan), _settings(plan), *apart, _values(plan))


def _uncertainty(plan: Plan) -> str:
    known = quantity(plan.uncertainty, "m", 2)
    if plan.assumed:
        return (
            f"The uncertainty of a travel is assumed to be {known}, 2 % of the longest travel,"
            " until repeats at one setting show the scatter: give that as --uncertainty."
        )
    how = "scatter and measurement uncertainty combined"
    if plan.repeated:
        degrees = count(plan.repeated, "degree of freedom", "degrees of freedom")
        how = f"the scatter of the repeats measured so far ({degrees})"
    return f"The uncertainty of a travel is {known}, {how}."


def _table(heads: Sequence[str], rows: Sequence[Row], caption: str = "") -> Table:
    columns = tuple(Column(head=head) for head in heads)
    return Table(columns=columns, rows=tuple(rows), caption=caption)


def _lines(texts: Mapping[str, str]) -> Iterator[Block]:
    if texts:
        yield KeyValues(items=tuple(KeyValue(key=key, value=x) for key, x in texts.items()))


def _before(plan: Plan) -> Section:
    """Return what to measure before the runs, and how well."""
    rows = [
        Row(cells=(
            f"{x.name} ${x.quantity.symbol}$", quantity(x.value, x.quantity.unit, 4, degrees=True),
            quantity(x.needed, x.quantity.unit, 2, degrees=True), x.verdict,
        ))
        for x in plan.preparations
    ]  # fmt: skip
    caption = (
        "Uncertainties are standard uncertainties. A parameter with the needed uncertainty"
        f" contributes half as much as the {len(plan.runs())} readings to the uncertainty of the"
        f" level of {plan.laws[plan.reference].title} friction; three such parameters widen its"
        " interval by a third. An error common to all runs does not average out; the error of a"
        " setting that is adjusted anew for each run does."
    )
    heads = ("parameter", "value", "needed uncertainty", "stated uncertainty")
    tables = [_table(heads, rows, caption)] if rows else []
    head = "Measure before the runs"
    return Section(id="before", nav="Before the runs", heading=head, blocks=tuple(tables))


def _settings(plan: Plan) -> Section:
    """Return the travels that each law predicts, of up to six settings at a time."""
    unit, factor = unit_of(plan.settings[0].unit)
    # a digit beyond that of the uncertainty
    decimals = min(max(0, 1 - math.floor(math.log10(1e3 * plan.uncertainty))), 4)
    size = math.ceil(len(plan.settings) / math.ceil(len(plan.settings) / BLOCK))
    level = (
        "Each law is fitted to the trials."
        if plan.from_trials
        else "Each law gives the same travel with the rig as described."
    )
    caption = (
        f"{level} The last rows are half the width of the 95 % band of the travel over all laws:"
        " now, and as these runs will leave it in the worst case."
    )
    tables = []
    for i in range(0, len(plan.settings), size):
        block = plan.settings[i : i + size]
        lines: list[tuple[Name | str, list[float]]] = [
            (Name(text=law.title, aside=values_text(law)), [x.predicted[name] for x in block])
            for name, law in plan.laws.items()
        ]
        lines.append(("± now", [item.half for item in block]))
        lines.append(("± expected", [item.expected for item in block]))
        rows = [Row(cells=(x, *(fixed(1e3 * y, decimals) for y in own))) for x, own in lines]
        heads = ("law", *(number(factor * item.value) for item in block))
        last = block[-1] is plan.settings[-1]
        tables.append(_table(heads, rows, caption if last else ""))
    heading = (
        f"Predicted travel [mm] at each {plan.knob} [{unit}], {count(plan.repeats, 'run')} each"
    )
    return Section(id="settings", nav="Settings", heading=heading, blocks=tuple(tables))


def values_text(law: FrictionLaw) -> str:
    """Return the values of a law that are not 0, with symbols and units."""
    return ", ".join(
        f"${asked.symbol}$ = {quantity(value, asked.unit)}"
        for _, asked, value in parameters(law, "friction")
        if value
    )


def _apart(plan: Plan) -> Section:
    """Return which laws the runs tell apart, and below it which they do not."""
    titles = {name: law.title for name, law in plan.laws.items()}
    rows, open_ = [], dict[str, list[str]]()
    for (holds, rival), many in plan.tellings.items():
        if many is None:
            open_.setdefault(titles[holds], []).append(titles[rival])
        else:
            rows.append(Row(cells=(titles[holds], titles[rival], f"{many}")))
    said = f"Not distinguished by {plan.most} runs at each setting"
    pairs = "; ".join(f"{law} from {joined(rivals)}" for law, rivals in open_.items())
    caption = (
        "Runs each: the runs per setting with which `stickslip select` is expected to rule that law"
        " out in nine of ten experiments."
    )
    heads = ("if this law is true", "this law is ruled out", "runs each")
    tables = [_table(heads, rows, caption)] if rows else []
    return Section(
        id="apart", nav="Which laws",
        heading=f"The runs distinguish {plan.distinguished} of laws",
        blocks=(*tables, *_lines({said: f"{pairs}."} if pairs else {})),
    )  # fmt: skip


def _values(plan: Plan) -> Section:
    """Return what the runs will tell of each parameter, and below it what tells the others."""
    rows, advice = [], dict[str, str]()
    for name, estimate in ((name, one) for name, own in plan.expectations.items() for one in own):
        asked, known = estimate.quantity, estimate.bounded
        unit = "" if asked.unit == "1" else f" [{asked.unit}]"
        cells = (plan.laws[name].title, f"${asked.symbol}${unit}", significant(estimate.value, 3),
                 estimate.range if known else "not identified")  # fmt: skip
        rows.append(Row(cells=cells, muted=not known))
        if estimate.reason:
            advice.setdefault(f"To identify ${asked.symbol}$", capital(estimate.reason))
    caption = (
        "The interval that `stickslip select` is expected to state if the law is true with this"
        " value and the rig has the stated (otherwise the needed) uncertainties. Not identified:"
        " the travels hardly depend on it, or the interval reaches the lowest value that the law"
        " allows."
    )
    heads = ("law", "parameter", "true value", "expected 95 % interval")
    tables = [_table(heads, rows, caption)] if rows else []
    return Section(
        id="values", nav="Which values", heading="Expected intervals of each law",
        blocks=(*tables, *_lines(advice)),
    )  # fmt: skip
