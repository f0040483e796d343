"""The verb `plan`: what to measure next, by what the posterior of a first measurement says."""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.data import Layout, Measurement, Reading, gain_factor
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify import BandVerdict, Verdict
from stickslip.identify.fits import Laws
from stickslip.identify.kinds.verbs import RouteName, select
from stickslip.identify.ladder import readings_sentence
from stickslip.identify.problems.tables import TableProblem
from stickslip.identify.selection import (
    further_readings,
    settings_of,
    with_readings,
)
from stickslip.identify.wording import nothing_further
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity
from stickslip.show.display import Tabular, html_of, summary_of_table
from stickslip.show.formatting import percent
from stickslip.units import converted, is_of

if TYPE_CHECKING:
    import pandas as pd

UNMEASURED = (
    'plan reads off a first measurement what to measure next, and there is none: the page "Which'
    ' experiment" (docs/howto/which-experiment.md) says what to measure a first time. Give that to'
    " plan, as [[trial]] or [data] of the rig file or as --data FILE (Python: measurement)."
)
"""What is said where nothing was measured."""
NUMBER = Quantity("n", low=1, high=300)
"""Readings that a plan may have."""


@dataclass(frozen=True, kw_only=True)
class Plan(Tabular):
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


def plan(
    mechanism: Mechanism,
    laws: Laws | FrictionLaw | type[FrictionLaw] | str | None,
    measurement: Measurement | None,
    *,
    readings: int | None = None,
    vary: str | Sequence[str] | None = None,
    route: RouteName | None = None,
    t_end: float | None = None,
) -> Plan:
    """Plan what to measure next: what narrows most what the posterior of a measurement leaves open.

    It is what `select` proposes: readings at velocities, loads and inputs beside a table, with the
    width to which they may bring the band; settings of the rig beside travels; else a further
    record, motion or setting.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    laws : mapping, sequence or a single law, or None
        The candidates, as `select` takes them.
    measurement : Measurement
        What was measured first.
    readings : int, optional
        Readings of a table, from 1 to 300; if not given, no more than the table has.
    vary : str or sequence of str, optional
        Parameters to fit, as `select` takes them.
    route : str, optional
        How the measurement is judged, as `select` takes it.
    t_end : float, optional
        Time after which a body whose travel to rest was measured counts as stopped [s]; 10 s if not
        given.

    Returns
    -------
    Plan
        What to measure in sentences; of tables the readings, and what is expected of them.

    Raises
    ------
    InputError
        If nothing was measured, the measurement cannot be judged, or an argument is out of its
        range or has no effect on such a measurement.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Axis, Measurement
    >>> v = np.linspace(0.1, 1.0, 10)
    >>> noise = 0.05 * np.random.default_rng(1).normal(size=10)
    >>> next_readings = plan(
    ...     Axis(inertia=1.0), None, Measurement(velocity=v, friction=2.0 + v + noise)
    ... )
    >>> len(next_readings.readings["velocity"])
    10
    """
    if measurement is None:
        raise InputError(UNMEASURED)
    if readings is not None:
        readings = int(NUMBER.check("plan", "readings", readings))
    return plan_of(
        select(mechanism, laws, measurement, vary=vary, route=route, t_end=t_end), readings
    )


def plan_of(verdict: Verdict, readings: int | None = None) -> Plan:
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
    Plan
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
    >>> four = plan_of(select(Axis(inertia=1.0), None, table), 4)
    >>> len(four.readings["velocity"]), four.csv().splitlines()[0]
    (4, 'velocity [m/s],friction [N]')
    """
    problem = verdict.judgement.problem if isinstance(verdict, BandVerdict) else None
    if not isinstance(verdict, BandVerdict) or not isinstance(problem, TableProblem):
        if readings is not None:
            raise InputError(
                "readings is a number of readings of a table of friction, and this measurement is"
                " none: leave it out."
            )
        return Plan(verdict=verdict, lines=tuple(verdict.words.measure_next))
    many = None if readings is None else int(NUMBER.check("plan", "readings", readings))
    proposal, rows, widths, alone = further_readings(verdict.judgement, many)
    if not proposal.places:
        return Plan(verdict=verdict, lines=(nothing_further(proposal),))
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
    return Plan(
        verdict=verdict, lines=(said, likely), widths=(low, middle, high), chance=chance,
        readings={"velocity": given["places"], **given["conditions"]},
        sheet=with_readings(verdict.measurement, rows),
    )  # fmt: skip
