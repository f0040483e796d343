"""What a plan of travels gives back: a sheet to take to the rig."""

import csv
import html
import io
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from stickslip.friction import FrictionLaw
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds.travels.fit import setting_text, unit_of, words_of
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity
from stickslip.show.described import Described
from stickslip.show.display import Tabular
from stickslip.show.formatting import count, joined, number, quantity

if TYPE_CHECKING:
    import pandas as pd

TRAVEL_COLUMN = "travel [mm]"
"""Column of the table of runs that is filled in."""


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
    how: str
    """How it is measured, with the resolution that is needed."""
    rough: str = ""
    """What it costs to know it to 1 % only; empty where more than that will do."""

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
            "how": self.how,
            "known_to_one_percent": self.rough.replace("$", ""),
        }


@dataclass(frozen=True, kw_only=True)
class Telling(metaclass=Described):
    """What it takes to rule out one law where another one holds."""

    holds: str
    """Key of the law that is taken to hold."""
    rival: str
    """Key of the law that is to be ruled out, with its parameters fitted to the same travels."""
    gap: float
    """Largest difference of their travels that the fit leaves [m]."""
    setting: Separation
    """Where that is."""
    repeats: int | None
    """Runs at each setting that rule it out in nine of ten such sets; None if more than `most`."""
    most: int
    """Runs at each setting beyond which none are asked for."""
    alike: bool = False
    """Whether the rival, fitted, makes the same travels to the accuracy of a run."""

    @property
    def obstacle(self) -> str:
        """Why these runs do not rule it out, in words; nothing if they do."""
        if self.repeats is not None:
            return ""
        if self.alike:
            return "Not distinguishable by travels: both laws predict the same"
        return f"Not distinguished by {self.most} runs at each setting"

    def to_dict(self) -> Mapping[str, Any]:
        """Return it as plain numbers and strings."""
        return {
            "holds": self.holds,
            "ruled_out": self.rival,
            "largest_difference": self.gap,
            "at": {self.setting.path: self.setting.value},
            "repeats": self.repeats,
            "same_travels": self.alike,
        }


@dataclass(frozen=True, kw_only=True)
class Expectation(metaclass=Described):
    """The interval of a parameter that the planned runs will give, if its law holds."""

    law: str
    """Key of the law."""
    estimate: Estimate
    """The value that was assumed, and its interval."""
    identified: bool
    """Whether the interval ends above the least value that the law allows."""
    advice: str = ""
    """What would tell it, where these travels do not."""

    def to_dict(self) -> Mapping[str, Any]:
        """Return it as plain numbers and strings."""
        return {
            "law": self.law,
            **self.estimate.to_dict(),
            "identified": self.identified,
            "advice": self.advice.replace("$", ""),
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
    rest: Mapping[str, str]
    """How to measure the level at rest, which travels do not tell, by what it is done with."""
    tellings: tuple[Telling, ...]
    """Which laws can be told apart, the easiest first."""
    expectations: tuple[Expectation, ...]
    """What the runs will tell of each law's parameters."""
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
        values = joined([number(factor * one.value) for one in self.settings])
        said = (
            f"Set the {self.knob} to {values} {unit}, {self.repeats} runs each: {len(self.runs())}"
            f" travels, each measured to {quantity(self.uncertainty, 'm', 2)}."
        ).replace(" °", "°")
        told = [one for one in self.tellings if one.repeats is not None]
        if self.tellings:
            pairs = count(len(self.tellings), "pair")
            said += f" They distinguish {len(told)} of {pairs} of laws."
        return said

    @property
    def widest(self) -> Separation:
        """The setting at which the band of the travel is widest: a run there narrows it most."""
        return max(self.settings, key=lambda one: one.half)

    @property
    def band_sentence(self) -> str:
        """Where the travel is known least, and how well it will be."""
        one = self.widest
        before, after = (quantity(x, "m", 2) for x in (one.half, one.expected))
        return (
            f"The travel is known least with the {self.knob} {one.text}: ± {before} over all"
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
            [name, f"{factor * one.value:.10g}", ""] for name, one in self.runs().items()
        )
        return text.getvalue()

    def runs(self) -> Mapping[str, Separation]:
        """Return the runs by name, in the order in which to make them."""
        found: dict[str, Separation] = {}
        for repeat in range(self.repeats):
            for one in self.settings[:: -1 if repeat % 2 else 1]:
                found[f"run {len(found) + 1}"] = one
        return found

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the settings and the travels that each law predicts, as a pandas DataFrame."""
        import pandas as pd

        rows = [{one.path: one.value, **one.predicted} for one in self.settings]
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
            "settings": [one.to_dict() for one in self.settings],
            "prepare": [one.to_dict() for one in self.preparations],
            "measure_otherwise": {
                head.replace("$", ""): text.replace("$", "") for head, text in self.rest.items()
            },
            "tells_apart": [one.to_dict() for one in self.tellings],
            "expected": [one.to_dict() for one in self.expectations],
            "remarks": [line.replace("$", "") for line in self.remarks],
            "sheet": self.csv(),
        }

    def __repr__(self) -> str:
        return f"<Plan: {self.sentence}>"

    def _repr_html_(self) -> str:
        table = self.to_dataframe().to_html(index=False, na_rep="", border=0)
        return f"<p>{html.escape(self.sentence)}</p>{table}"
