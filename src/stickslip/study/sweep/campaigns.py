"""Campaigns: runs without number, on any executor, whose results are a folder of Parquet files.

A campaign is cases times a design, whose row i is worked out when it is asked for, so that memory
does not grow with the number of runs.

1. Values of all runs are checked and each case is compiled before anything is written.
2. Runs are cut into parts of equal length. A part is a task of the executor: an ensemble in one
   thread, whose table becomes the bytes of a file there. It depends on the campaign and its number
   alone, not on the executor.
3. The process that began writes each file as a whole, and then a line with its hash, its size and
   how its runs ended to a journal. What is not in the journal was not made.
4. A manifest holds a hash of all that results depend on: cases, design, outputs, versions, and the
   source of classes that are not ours. A folder with the same hash goes on with the parts that it
   lacks; another one is refused.
5. Once all parts are there, they stand in the manifest, and the journal goes.
"""

import contextlib
import dataclasses
import errno
import hashlib
import inspect
import io
import json
import os
import re
import stat
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeAlias
from urllib.parse import quote

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.engine.executors import Inline, check_executor, spread
from stickslip.engine.simulation import beginning_pair, ensemble, event_driven_law
from stickslip.engine.solver import EventDriven, Output, check_columns
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError, UnknownNameError, not_whole
from stickslip.friction import Friction, FrictionLaw, Laws
from stickslip.mechanisms import Mechanism
from stickslip.show import documents
from stickslip.show.described import Described
from stickslip.show.display import Summary, Tabular, require_library, text_of
from stickslip.show.formatting import count, quantity
from stickslip.study.energy import columns_of, travel_of, units_of_columns
from stickslip.study.sweep.design import (
    OF_INDICES,
    Design,
    DesignName,
    Factor,
    Levels,
    SensitivityIndices,
    indices_of,
)
from stickslip.study.sweep.lyapunov import starts_nearby
from stickslip.study.sweep.parameter_grid import axis_of, early_ends, energies_of
from stickslip.study.tolerances import ROUNDING

if TYPE_CHECKING:
    import pandas as pd

Progress: TypeAlias = Callable[[int, int], object]

MANIFEST: Final = "manifest.json"
JOURNAL: Final = "parts.jsonl"
"""Parts that are finished, a line each, until all of them are."""
RUNS: Final = "runs"
LOCK: Final = ".lock"
OF_ALL: Final = ("sensitivity.csv", "sensitivity.svg")
"""Files beside the runs that are made of all of them."""
PART_NAME: Final = re.compile(rf"{RUNS}/(?:[^/\x00]+/){{0,20}}part-\d{{6,}}\.parquet")
"""Paths of parts below the folder of a campaign: a manifest may name any others."""
LARGEST: Final = 200_000_000
"""Bytes of a manifest or journal that are read at most: a part has some 250."""
SCHEMA: Final = f"stickslip/campaign/{documents.SCHEMA_VERSION}"
PART: Final = 32_768
"""Runs of a file: some tenths of a second of work of a spring-block, and a megabyte."""
RESERVED: Final = ("status", "certified")
"""Columns that runs have of themselves, beside their number."""
SPREAD_OF: Final = "spread of "
"""What names of columns begin with that tell how outputs differ from starts nearby."""
BLOCKS, BLOCK = 16, 64
"""Stretches of runs, and runs of each, by which a campaign is estimated."""


@dataclass(frozen=True, kw_only=True)
class Case(metaclass=Described):
    """A mechanism with its friction: what a campaign runs with the values of its design.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> Case(mechanism=rig, law=Coulomb(kinetic_coefficient=0.25), t_end=10.0).where
    ''
    """

    mechanism: Mechanism
    """What moves."""
    law: Friction
    """What holds it back, as in `simulate`."""
    t_end: float
    """Last time of every run [s]."""
    y0: Mapping[str, float] | None = None
    """Initial states that do not vary [SI], as in `simulate`."""
    labels: Mapping[str, str] = field(default_factory=dict)
    """What tells it from other cases, such as ``{"law": "coulomb"}``: a column each."""

    @property
    def where(self) -> str:
        """Folder of its files below that of all runs."""
        return "/".join(quote(f"{name}-{value}", safe="") for name, value in self.labels.items())


@dataclass(frozen=True)
class _Finished:
    """A part whose file is there."""

    file: str
    """Path below the folder of the campaign."""
    rows: int
    sha256: str
    size: int
    """Bytes of the file."""
    certified: int
    """Runs with a certificate."""
    status: Mapping[str, int]
    """How many runs ended in which way."""


@dataclass(frozen=True, kw_only=True)
class Estimate(metaclass=Described):
    """What a campaign will take, by some of its runs."""

    runs: int
    """Runs in all."""
    files: int
    """Parquet files."""
    seconds: float
    """Time of all runs on one worker [s]."""
    size: int
    """Bytes of all files."""


CUT_SHORT = (
    "Outputs of runs that ended early are those of the time up to then, or empty: see their status."
)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CampaignRuns(Tabular):
    """The runs of a campaign, in the files of its folder."""

    folder: Path
    """Folder with the manifest."""
    design: Design
    """What varies."""
    units: Mapping[str, str]
    """SI unit of each column that has one."""
    parts: tuple[_Finished, ...] = field(repr=False)
    """What is to be known of each file."""
    made: int
    """Runs that were made now; the others were there."""
    complete: bool
    """Whether all runs are there."""

    def __len__(self) -> int:
        """Return the number of runs that are there."""
        return sum(part.rows for part in self.parts)

    @property
    def size(self) -> int:
        """Bytes of the files."""
        return sum(part.size for part in self.parts)

    @property
    def certified(self) -> int:
        """Runs with a certificate."""
        return sum(part.certified for part in self.parts)

    @property
    def status(self) -> Mapping[str, int]:
        """How many runs ended in which way, by the name of the `Status`."""
        counts: Counter[str] = Counter()
        for part in self.parts:
            counts.update(part.status)
        return dict(sorted(counts.items()))

    def to_dataframe(self, columns: Sequence[str] | None = None) -> "pd.DataFrame":
        """Return the runs as a pandas DataFrame, or some columns of them.

        Parameters
        ----------
        columns : sequence of str, optional
            Columns that are read; all if not given.

        Raises
        ------
        UnknownNameError
            If there is no such column.
        """
        import pandas as pd

        for name in columns or ():
            if name not in self.columns:
                raise UnknownNameError(f"column of {self.folder}", name, self.columns)
        wanted = None if columns is None else [*columns]
        tables = (self._read(part, wanted).to_pandas() for part in self.parts)
        result: pd.DataFrame = pd.concat([*tables], ignore_index=True)
        return result

    def _column_units(self) -> Mapping[str, str]:
        return self.units

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of the files."""
        return tuple(self._read(self.parts[0], []).schema.names)

    def _read(self, part: _Finished, columns: Sequence[str] | None) -> Any:
        """Return a table of a file; of no columns, its schema is that of all."""
        pa = require_library("pyarrow", "parquet")
        pq = require_library("pyarrow.parquet", "parquet")
        path = self.folder / part.file
        try:
            with documents.open_regular(path) as file:
                if columns is not None and not columns:
                    return pq.read_schema(file).empty_table()
                return pq.read_table(file, columns=columns)
        except (OSError, pa.ArrowException) as error:
            reason = str(getattr(error, "strerror", None) or error).splitlines()[0].rstrip(".")
            raise InputError(
                f"{path} is missing or damaged ({reason}): start the campaign again, which makes"
                " what is missing."
            ) from None

    def __repr__(self) -> str:
        """Return the number of runs, and how they ended."""
        return text_of(self.in_short())

    def sensitivity(self, output: str) -> SensitivityIndices:
        """Return how much of an output each factor explains.

        Parameters
        ----------
        output : str
            Column of the runs.

        Returns
        -------
        SensitivityIndices
            Those of Sobol for the design ``"saltelli"``, those of Morris for ``"morris"``. Base
            points and trajectories with a run that has no value, or that ended early, are left out.

        Raises
        ------
        InputError
            If the design is another, runs are missing, or the campaign has several cases.
        """
        if self.design.kind not in OF_INDICES:
            raise InputError(
                f"sensitivity indices need the design {' or '.join(OF_INDICES)}, got"
                f" {self.design.kind}."
            )
        if not self.complete:
            raise InputError(f"{self.folder} lacks runs: start the campaign again first.")
        if len({Path(part.file).parent for part in self.parts}) > 1:
            raise InputError("sensitivity indices are of one case: make a campaign of each.")
        table = self.to_dataframe([output, "status"])
        values = table[output].to_numpy(dtype=np.float64)
        status = np.array([Status[name] for name in table["status"]], dtype=object)
        complete = np.array([ending.complete for ending in status], dtype=np.bool_)
        reasons = early_ends(status, "They are left out.", noun="runs")
        rarely = int(np.sum(complete & ~np.isfinite(values)))
        if rarely:
            reasons += (f"At {rarely} of {len(values)} runs {output} has no value up to the end.",)
        # what a run had where it stopped is another output
        values = np.where(complete, values, np.nan)
        return indices_of(self.design, output, self.units.get(output, "1"), values, reasons)

    def in_short(self) -> Summary:
        """Return number, size and endings of the runs."""
        files = f"{count(len(self.parts), 'file')} of {quantity(self.size / 1e6, 'MB')}"
        complete = all(Status[name].complete for name in self.status)
        return Summary(
            sentence=f"{count(len(self), 'run')}, {self.certified:,} certified, in {files}.",
            rows=[(name, f"{n:,}. {Status[name].value}") for name, n in self.status.items()],
            notes=[] if complete else [CUT_SHORT],
        )


@dataclass(frozen=True, kw_only=True)
class Campaign(metaclass=Described):
    """Cases, the values that their runs take, and what is kept of each run.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> from stickslip.study.sweep import Uniform
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> case = Case(mechanism=rig, law=Coulomb(kinetic_coefficient=0.25), t_end=10.0)
    >>> whole = {"kinetic_coefficient": Uniform(low=0.2, high=0.3)}
    >>> len(Campaign(cases=(case,), factors=whole, design="sobol", runs=1024))
    1024
    """

    cases: tuple[Case, ...]
    """What is run with the values of the design, each the same."""
    factors: Mapping[str, Factor]
    """What varies, by path as in `ensemble`."""
    design: DesignName = "grid"
    """How values are combined: see `Design`."""
    runs: int | None = None
    """Runs of each case at most; none for a grid."""
    seed: int = 0
    """Of random designs."""
    outputs: Sequence[str] | Mapping[str, Output] | None = None
    """What is kept of each run, as in `ensemble`."""
    spread: bool = False
    """Whether each run is made again from rates 1e-9 m/s or rad/s off, and each number that is kept
    has a column ``spread of ...``, by how much it differs then: in chaos, by as much as it means
    little."""
    energy: bool = False
    """Whether each run is made again for columns of mean powers and of the energy per travel, as
    in `average_velocity`."""
    part: int = PART
    """Runs of a file, and of a task of an executor."""
    solver: EventDriven = field(default_factory=lambda: EventDriven(tier="compiled"))
    """Tolerances and limits."""

    def __post_init__(self) -> None:
        """Check that cases can be told apart, and the design."""
        if not self.cases:
            raise InputError("a campaign has at least one case, got none.")
        if type(self.part) is not int or self.part < 1:
            raise InputError(not_whole("part", 1, self.part))
        for flag in ("spread", "energy"):
            if not isinstance(getattr(self, flag), bool):
                raise InputError(f"{flag} is True or False, got {getattr(self, flag)!r}.")
        names = {tuple(case.labels) for case in self.cases}
        if len(names) > 1 or len({case.where for case in self.cases}) < len(self.cases):
            raise InputError("cases need the same labels with different values.")
        labels = (*self.cases[0].labels, "run")
        taken = {*self.factors, *RESERVED, *(self.outputs or ())}
        for name in labels:
            if name in taken or labels.count(name) > 1:
                raise InputError(
                    f"{name!r} is a column of a campaign already: give the output or label another"
                    " name."
                )
        _ = self.whole

    @property
    def whole(self) -> Design:
        """The design of each case."""
        return Design(factors=self.factors, kind=self.design, runs=self.runs, seed=self.seed)

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.cases) * len(self.whole)

    @property
    def digest(self) -> str:
        """Hash of all that the results depend on."""
        from importlib.metadata import version

        # Other versions of these may give other bits.
        versions = [version(name) for name in ("stickslip", "numpy", "scipy")]
        own = {
            type(root)
            for case in self.cases
            for root in (case.mechanism, *_laws(case.law))
            if not type(root).__module__.startswith("stickslip.")
        }
        # The code of classes of others: under the same name they may have been changed.
        code = sorted(f"{kind.__qualname__} {_source(kind)}" for kind in own)
        # arrays in full and to the last bit: shortened ones would be the same for other runs
        with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
            text = repr((self, versions, code))
        if " at 0x" in text:
            raise InputError(
                "a campaign cannot tell whether its runs are the same when it goes on: give its"
                " mechanisms and laws a repr without addresses, as dataclasses have."
            )
        return hashlib.sha256(text.encode()).hexdigest()

    def run(
        self,
        folder: str | Path,
        *,
        executor: Executor | None = None,
        progress: Progress | None = None,
        replace: bool = False,
    ) -> CampaignRuns:
        """Make the runs that are not in a folder yet.

        Each file appears whole or not at all. A campaign that was ended at any time goes on where
        it was when it is started again, and ends with the same files.

        Parameters
        ----------
        folder : str or Path
            Where the manifest and the files of the runs are written.
        executor : concurrent.futures.Executor, optional
            Where the runs are made, a file at a time; threads for all cores if not given.
        progress : callable, optional
            Called with the number of runs that are there and of all runs after each file. If it
            returns False, no further files begin.
        replace : bool
            Whether another campaign in the folder is removed.

        Returns
        -------
        CampaignRuns
            The runs; `CampaignRuns.complete` says whether they are all.

        Raises
        ------
        InputError
            If a value cannot be used, before anything is written, or the folder holds another
            campaign or cannot be written.
        """
        check_executor(executor)
        units = self._checked()
        ledger = _Ledger(Path(folder), self, replace=replace)
        total, there = len(self), ledger.rows

        def keep(made: tuple[_Finished, bytes]) -> bool:
            ledger.add(*made)
            answer = None if progress is None else progress(ledger.rows, total)
            return answer is None or bool(answer)

        if progress is not None:
            progress(there, total)
        # A generator: what a task is given is made when it begins.
        missing = (task for task in self.tasks() if task[0] not in ledger.known)
        with ledger.lock:
            complete = spread(_made, missing, keep, executor)
            parts = tuple(ledger.known[name] for name in sorted(ledger.known))
            if complete:
                ledger.finish(parts)
        return CampaignRuns(
            folder=Path(folder),
            design=self.whole,
            units=units,
            parts=parts,
            made=ledger.rows - there,
            complete=complete,
        )

    def estimate(self) -> Estimate:
        """Return what the campaign will take, by some runs of each case.

        Examples
        --------
        >>> from stickslip import Coulomb, SpringBlock
        >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
        >>> case = Case(mechanism=rig, law=Coulomb(kinetic_coefficient=0.25), t_end=10.0)
        >>> levels = {"compression": Levels(values=(0.05, 0.1))}
        >>> Campaign(cases=(case,), factors=levels).estimate().files
        1
        """
        self._checked()
        count, seconds, size = len(self.whole), 0.0, 0.0
        # Spread over the design: runs cost more at some values than at others.
        starts = sorted({int(at) for at in np.linspace(0, max(count - BLOCK, 0), BLOCKS)})
        for case in self.cases:
            begun, rows, data = time.perf_counter(), 0, 0
            for start in starts:
                finished, _ = _made("", case, self, start, min(start + BLOCK, count))
                rows, data = rows + finished.rows, data + finished.size
            seconds += (time.perf_counter() - begun) / rows * count
            # what a file takes without its rows counts once a file, and the rest once a run
            empty = _made("", case, self, 0, 1)[0].size
            each = max(data - len(starts) * empty, 0) / max(rows - len(starts), 1)
            size += -(-count // self.part) * empty + each * count
        files = len(self.cases) * -(-count // self.part)
        return Estimate(runs=len(self), files=files, seconds=seconds, size=round(size))

    def tasks(self) -> Iterator[tuple[str, Case, "Campaign", int, int]]:
        """Yield the arguments of `_made` for each file."""
        count = len(self.whole)
        shared = replace(self, cases=self.cases[:1])  # of many cases, a task needs its own alone
        for case in self.cases:
            for number, start in enumerate(range(0, count, self.part)):
                name = "/".join(filter(None, [RUNS, case.where, f"part-{number:06d}.parquet"]))
                yield name, case, shared, start, min(start + self.part, count)

    def _checked(self) -> dict[str, str]:
        """Check the values of all runs; compile what is run; return the units of the columns."""
        units: dict[str, str] = {}
        design = self.whole
        for case in self.cases:
            law = event_driven_law(case.mechanism, case.law)
            # part by part, as values of a whole design need not fit into memory
            for start in range(0, len(design), PART):
                rows = design.rows(start, start + PART)
                try:
                    check_columns(*beginning_pair(case.mechanism, law, rows), rows)
                except InputError as error:
                    where = _told(case, start)
                    if not where:
                        raise
                    raise InputError(f"{where}{error}") from None
            runs = _runs(case, self, 0, 1)
            units |= runs.units
            if self.spread:
                units |= {SPREAD_OF + name: runs.units[name] for name in runs.outputs}
            units |= self.units_of_energy(case)
        return units

    def units_of_energy(self, case: Case) -> dict[str, str]:
        """Return the units of columns of powers and energies, if the campaign has any."""
        if not self.energy:
            return {}
        return units_of_columns(columns_of(case.mechanism), travel_of(case.mechanism)[1])


def _laws(law: Friction) -> Sequence[object]:
    """Return the laws of all contacts."""
    if isinstance(law, Laws):
        return [member for _, member in law.members]
    return [*law.values()] if isinstance(law, Mapping) else [law]


def _source(kind: type) -> str:
    """Return the code of a class, empty where there is none to read."""
    try:
        return inspect.getsource(kind)
    except (OSError, TypeError):
        return ""


def _told(case: Case, start: int) -> str:
    """Return which case an error is of, and from which run on its runs are counted."""
    at = ", ".join(f"{name} {value}" for name, value in case.labels.items())
    return "".join([f"{at}: " if at else "", f"from run {start} on: " if start else ""])


def _rows(
    case: Case, campaign: Campaign, start: int, stop: int
) -> tuple[Mechanism, FrictionLaw | Laws, dict[str, NDArray[np.float64]]]:
    """Return mechanism and law that some runs begin with, and what varies by full path."""
    rows = campaign.whole.rows(start, stop)
    law = event_driven_law(case.mechanism, case.law)
    mechanism, law = beginning_pair(case.mechanism, law, rows)
    return mechanism, law, {axis_of(mechanism, law, path, x)[0]: x for path, x in rows.items()}


def _runs(case: Case, campaign: Campaign, start: int, stop: int, off: float = 0.0) -> Any:
    """Make some runs of a case, in this thread, from rates that are off."""
    rows = campaign.whole.rows(start, stop)
    if off:
        mechanism, law, rows = _rows(case, campaign, start, stop)
        n = len(mechanism.coordinates)
        shifts = np.tile([0.0] * n + [off] * n, (stop - start, 1))
        rows = starts_nearby(mechanism, law, case.y0, rows, shifts)
    return ensemble(
        case.mechanism,
        case.law,
        rows,
        t_end=case.t_end,
        outputs=campaign.outputs,
        y0=case.y0,
        solver=campaign.solver,
        executor=Inline(),
    )


def _made(
    name: str, case: Case, campaign: Campaign, start: int, stop: int
) -> tuple[_Finished, bytes]:
    """Make the runs of a file; return what is to be known of them, and the file."""
    pa = require_library("pyarrow", "parquet")
    pq = require_library("pyarrow.parquet", "parquet")
    runs = _runs(case, campaign, start, stop)
    frame = runs.to_dataframe()
    if campaign.spread:
        other = _runs(case, campaign, start, stop, off=ROUNDING)
        for output in (name for name, values in runs.outputs.items() if values.ndim == 1):
            frame[SPREAD_OF + output] = np.abs(other[output] - runs[output])
    units = runs.units | campaign.units_of_energy(case)
    if campaign.energy:
        spans = np.tile([0.0, case.t_end], (len(frame), 1))
        varied = _rows(case, campaign, start, stop)
        columns = energies_of(*varied, spans, case.y0, campaign.solver)
        frame[list(columns)] = np.column_stack([*columns.values()])
    for place, (label, value) in enumerate(case.labels.items()):
        # Labels first, then the number of the run, then what varies.
        frame.insert(place, label, value)
    frame.insert(len(case.labels), "run", np.arange(start, stop))
    # Metadata of pandas would differ between its versions, and files are compared by their hash.
    table = pa.Table.from_pandas(frame, preserve_index=False).replace_schema_metadata(None)
    for place, name_of in enumerate(table.column_names):
        kept = name_of.removeprefix(SPREAD_OF)
        unit = units.get(kept, units.get(kept.rpartition(".")[0], ""))
        if unit:
            known = table.schema.field(place).with_metadata({"unit": unit})
            table = table.set_column(place, known, table.column(place))
    buffer = io.BytesIO()
    pq.write_table(table, buffer, compression="zstd")
    data = buffer.getvalue()
    status = dict(sorted(Counter(ending.name for ending in runs.status).items()))
    finished = _Finished(
        file=name,
        rows=stop - start,
        sha256=hashlib.sha256(data).hexdigest(),
        size=len(data),
        certified=int(runs.certified.sum()),
        status=status,
    )
    return finished, data


class _Ledger:
    """What a folder has of a campaign: a manifest, a line for each file, and the files."""

    def __init__(self, folder: Path, campaign: Campaign, *, replace: bool) -> None:
        self.folder = folder
        self.head: dict[str, Any] = {
            "campaign": campaign.digest,
            "design": campaign.design,
            "seed": campaign.seed,
            "runs": len(campaign),
            "part": campaign.part,
            "factors": {path: repr(factor) for path, factor in campaign.factors.items()},
            "cases": [dict(case.labels) for case in campaign.cases],
        }
        self.known: dict[str, _Finished] = {}
        if folder.exists() and not folder.is_dir():
            raise InputError(f"{folder} is a file, but a folder is needed: choose another name.")
        before = self._manifest()
        # Nothing of others is ever removed.
        if before is None and folder.exists() and any(map(_is_foreign, folder.iterdir())):
            raise InputError(f"{folder} holds other files: choose another folder.")
        self.planned = {name: stop - start for name, _, _, start, stop in campaign.tasks()}
        self._check_inside(self.planned)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with contextlib.ExitStack() as held:
                self.lock = held.enter_context(_lock(folder / LOCK))
                self._begin(before, replace=replace)
                held.pop_all()
        except OSError as error:
            raise documents.unwritable(folder, error) from error

    def _begin(self, before: Mapping[str, Any] | None, *, replace: bool) -> None:
        """Find what is there already, and remove what is of another campaign or was cut off."""
        self._alone()
        listed = self._listed(before)
        if before is not None and before.get("campaign") != self.head["campaign"]:
            if not replace:
                raise InputError(
                    f"{self.folder} holds the runs of another campaign (other cases, factors,"
                    " design, outputs, or version): choose another folder."
                )
            self._check_inside(listed)
            for name in (*listed, JOURNAL, *OF_ALL):
                (self.folder / name).unlink(missing_ok=True)
            listed, before = {}, None
        documents.remove_unfinished(self.folder, {MANIFEST, JOURNAL, *OF_ALL})
        names = {Path(name).name for name in self.planned}
        for place in _folders(self.planned):
            documents.remove_unfinished(self.folder / place, names)
        for name, batch in listed.items():
            planned = self.planned.get(name) == batch.rows
            if planned and _hash_of(self.folder / name) == batch.sha256:
                self.known[name] = batch
        self.rows = sum(finished.rows for finished in self.known.values())
        if before is None or self.rows < self.head["runs"]:
            self._write(self.head)
            lines = "".join(f"{_line(x)}\n" for x in self.known.values())
            documents.write_file(self.folder / JOURNAL, lines)

    def add(self, finished: _Finished, data: bytes) -> None:
        """Keep a file; it is there before it is listed."""
        # the file first: what a line names is there, however the process ends
        documents.write_file(self.folder / finished.file, data)
        self.known[finished.file] = finished
        self.rows += finished.rows
        try:
            with (self.folder / JOURNAL).open("a", encoding="utf-8") as journal:
                journal.write(f"{_line(finished)}\n")
                journal.flush()
                os.fsync(journal.fileno())
        except OSError as error:
            raise documents.unwritable(self.folder / JOURNAL, error) from error

    def finish(self, parts: Sequence[_Finished]) -> None:
        """Write the manifest of a campaign that is complete."""
        self._write({**self.head, "parts": [vars(part) for part in parts]})
        (self.folder / JOURNAL).unlink(missing_ok=True)

    def _write(self, content: Mapping[str, Any]) -> None:
        """Write the manifest."""
        text = documents.json_text(documents.document("campaign", content))
        documents.write_file(self.folder / MANIFEST, text)

    def _alone(self) -> None:
        """Refuse to write where another process does; the system frees what a killed one held."""
        if not documents.is_free(self.lock.fileno()):
            raise InputError(
                f"another process is running the campaign in {self.folder}: wait for it, or"
                " choose another folder."
            )

    def _check_inside(self, names: Iterable[str]) -> None:
        """Refuse folders of parts that a symbolic link has outside the campaign's folder."""
        own = self.folder.resolve()
        for place in _folders(names):
            if (self.folder / place).resolve() != own / place:
                raise InputError(
                    f"{self.folder / place} is reached by a symbolic link, and a campaign writes"
                    " and removes files in its own folder only: choose another folder."
                )

    def _manifest(self) -> dict[str, Any] | None:
        """Return the manifest of a campaign; None if there is none."""
        path = self.folder / MANIFEST
        try:
            result = json.loads(_content(path))
        except FileNotFoundError:
            return None
        except (OSError, ValueError, RecursionError) as error:
            reason = str(getattr(error, "strerror", None) or error).rstrip(".")
            raise InputError(
                f"{path} cannot be read: {reason}. Choose another folder, or delete"
                f" {self.folder}, whose runs are then made again."
            ) from None
        if not (isinstance(result, dict) and result.get("schema") == SCHEMA):
            raise InputError(f"{path} is of no campaign: choose another folder.")
        return result

    def _listed(self, manifest: Mapping[str, Any] | None) -> dict[str, _Finished]:
        """Return the files of the manifest and of the journal, whose last line may be cut off.

        What is no entry is left out, and so made again: it names nothing that can be trusted.
        """
        entries = [] if manifest is None else manifest.get("parts", [])
        listed = [*entries] if isinstance(entries, list) else []
        path = self.folder / JOURNAL
        try:
            for line in _content(path).splitlines():
                with contextlib.suppress(ValueError, RecursionError):
                    listed.append(json.loads(line))
        except FileNotFoundError:
            pass
        except OSError as error:
            raise InputError(
                f"{path} cannot be read: {error.strerror or error}. Delete it, and the runs that"
                " only it lists are made again."
            ) from None
        return {entry["file"]: _Finished(**entry) for entry in listed if _is_entry(entry)}


def _folders(names: Iterable[str]) -> set[Path]:
    """Return the folders of files."""
    return {Path(name).parent for name in names}


def _lock(path: Path) -> Any:
    """Open the file that says that a process writes there; never one elsewhere, nor a pipe."""
    if path.is_symlink():
        raise InputError(f"{path} is a symbolic link, which no campaign follows: remove it.")
    own = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    lock = os.fdopen(os.open(path, os.O_RDWR | os.O_CREAT | own, 0o666), "rb")
    if not stat.S_ISREG(os.fstat(lock.fileno()).st_mode):
        lock.close()
        raise InputError(f"{path} is not a regular file: remove it.")
    return lock


def _is_foreign(path: Path) -> bool:
    """Whether a file is none that a campaign leaves when it is killed before its first part."""
    return path.name != LOCK and documents.becomes(path) not in (MANIFEST, JOURNAL)


def _content(path: Path) -> bytes:
    """Return the bytes of a manifest or a journal."""
    with documents.open_regular(path) as file:
        data = file.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise OSError(errno.EFBIG, f"it has more than {LARGEST / 1e6:.0f} MB")
    return data


def _is_entry(entry: object) -> bool:
    """Whether what stands in a manifest or a journal describes a part, all its values of a kind.

    Examples
    --------
    >>> entry = {"file": "runs/part-000000.parquet", "rows": 8, "sha256": "", "size": 9}
    >>> entry |= {"certified": 8, "status": {"END_TIME": 8}}
    >>> _is_entry(entry), _is_entry(entry | {"file": "runs/../../part-000000.parquet"})
    (True, False)
    """
    fields = {declared.name for declared in dataclasses.fields(_Finished)}
    if not isinstance(entry, dict) or entry.keys() != fields:
        return False
    file, sha256, status = entry["file"], entry["sha256"], entry["status"]
    counts = [entry["rows"], entry["size"], entry["certified"]]
    return (
        isinstance(file, str)
        and PART_NAME.fullmatch(file) is not None
        and ".." not in file.split("/")
        and isinstance(sha256, str)
        and isinstance(status, dict)
        and all(type(count) is int and count >= 0 for count in (*counts, *status.values()))
    )


def _line(finished: _Finished) -> str:
    return json.dumps(vars(finished), sort_keys=True)


def _hash_of(path: Path) -> str:
    """Return the hash of a file, empty if it is not there."""
    try:
        with documents.open_regular(path) as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def campaign(
    mechanism: Mechanism,
    law: Friction,
    parameters: Mapping[str, Factor | ArrayLike],
    *,
    t_end: float,
    folder: str | Path,
    design: DesignName = "grid",
    runs: int | None = None,
    seed: int = 0,
    outputs: Sequence[str] | Mapping[str, Output] | None = None,
    spread: bool = False,
    energy: bool = False,
    y0: Mapping[str, float] | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> CampaignRuns:
    """Simulate a mechanism more often than memory holds; the runs are files in a folder.

    Ended at any time and started again, it goes on where it was. For several mechanisms or laws,
    make a `Campaign` of several cases.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back, as in `simulate`.
    parameters : mapping
        What varies, by path as in `ensemble`: a `Uniform`, `Normal` or `Levels`, or an array of
        values.
    t_end : float
        Last time of every run [s].
    folder : str or Path
        Where the runs are written.
    design : {"grid", "random", "sobol", "saltelli", "morris"}
        How values are combined; the last two are for sensitivity indices.
    runs : int, optional
        Runs at most; a grid has as many as combinations.
    seed : int
        Of random designs.
    outputs : sequence of str or mapping, optional
        What is kept of each run, as in `ensemble`.
    spread : bool
        Whether it is also kept by how much that differs from a start 1e-9 away, as in `Campaign`.
    energy : bool
        Whether mean powers and the energy per travel are kept, as in `Campaign`.
    y0 : mapping, optional
        Initial states that do not vary, as in `simulate`.
    executor : concurrent.futures.Executor, optional
        Where the runs are made; threads for all cores if not given.
    progress : callable, optional
        Called with the number of runs that are there and of all runs; False ends the campaign.

    Returns
    -------
    CampaignRuns
        What is in the folder.

    Raises
    ------
    InputError
        If an argument cannot be used, or the folder holds another campaign.

    Examples
    --------
    >>> import tempfile
    >>> from stickslip import Coulomb, SpringBlock
    >>> from stickslip.study.sweep import Uniform
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     found = campaign(
    ...         rig,
    ...         Coulomb(kinetic_coefficient=0.25),
    ...         {"kinetic_coefficient": Uniform(low=0.2, high=0.3)},
    ...         t_end=10.0,
    ...         folder=folder,
    ...         design="sobol",
    ...         runs=1000,
    ...         outputs=["x"],
    ...     )
    ...     round(float(found.to_dataframe(["x"])["x"].mean()), 3)
    0.207
    """
    return Campaign(
        cases=(Case(mechanism=mechanism, law=law, t_end=t_end, y0=y0),),
        factors={
            path: parameter if isinstance(parameter, Factor) else Levels(values=parameter)  # type: ignore[arg-type]
            for path, parameter in parameters.items()
        },
        design=design,
        runs=runs,
        seed=seed,
        outputs=outputs,
        spread=spread,
        energy=energy,
    ).run(folder, executor=executor, progress=progress)
