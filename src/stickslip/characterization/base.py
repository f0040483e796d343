"""What the results of all tests have in common."""

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.display import OnAxes, Summary
from stickslip.tables import Tabular

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Characteristic(OnAxes, Tabular, ABC):
    """What one test of the battery says of a law."""

    test: ClassVar[str]
    """Name of the test."""
    title: ClassVar[str]
    """What it shows, as a heading."""
    columns: ClassVar[Mapping[str, str]]
    """Fields that are columns of its table, with their SI units."""
    over: ClassVar[str] = ""
    """The column along which the rows stand; empty if they are numbered only."""

    conditions: str
    """Under which conditions, in words."""

    @property
    @abstractmethod
    def sentence(self) -> str:
        """What it says, in one sentence that a user can act on."""

    @final
    def to_dict(self) -> dict[str, Any]:
        """Return sentence, conditions and numbers, as in JSON."""
        found: dict[str, Any] = {"sentence": self.sentence, "conditions": self.conditions}
        for one in dataclasses.fields(self):
            if one.name != "conditions":
                found[one.name] = _plain(getattr(self, one.name))
        return found

    @final
    @override
    def to_dataframe(self) -> "pd.DataFrame":
        """Return the columns as a pandas DataFrame."""
        import pandas as pd

        return pd.DataFrame(self._values())

    def _values(self) -> Mapping[str, NDArray[Any]]:
        """Return the columns (n,) by name."""
        return {name: getattr(self, name) for name in self.columns}

    @override
    def _over(self) -> str:
        return self.over

    @override
    def _column_units(self) -> Mapping[str, str]:
        return self.columns

    @override
    def _summary(self) -> Summary:
        return Summary(sentence=self.sentence, notes=[self.conditions])


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: _plain(one) for key, one in value.items()}
    return value
