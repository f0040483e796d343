"""The report of a run: what moved, how surely, and how far to trust it.

In this order: the motion in figures and tables, its cycles, contacts, events and criteria, the law
and its doubt, the certificate, and how to reproduce it. The page has all sections, the terminal
those in `SHORT`, without their figures.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np

from stickslip.data import HARD, LawEstimates, Rig, equated, unfitted_bristles, unit_on
from stickslip.engine.trajectory import Event, Status, Trajectory
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, Laws, PrintedForm
from stickslip.identify import Criteria, criteria_of
from stickslip.mechanisms import cycle_or_none, has_one_slip, slip_names, slipping
from stickslip.quantities import parameters
from stickslip.show import plots
from stickslip.show.formatting import (
    Scale,
    capital,
    count,
    fixed,
    interval,
    joined,
    number,
    percent,
    quantity,
    scale_of,
    significant,
)
from stickslip.show.report import blocks as page
from stickslip.show.report.shared_sections import ended_early, evidence, figure, reproduce
from stickslip.show.report.tables import Cell, Table, table_of
from stickslip.study.sweep import Band, DrivenCycle, Spread, cycles_in

# What a report of a run is about, and the words that its sections share.


@dataclass(frozen=True, kw_only=True, eq=False)
class RunReport:
    """A run with what is known of it.

    Parameters
    ----------
    rig : Rig
        What moved.
    law : FrictionLaw, Laws or PrintedForm
        With what friction: a law that all contacts share, laws by contact, or an equation as
        printed.
    run : Trajectory
        How.
    estimates : LawEstimates, optional
        How well the law, or the laws by contact, are known.
    remarks : tuple of str
        What does not carry over from where the law was fitted.
    law_file : str
        Where that was, if it was another file than the rig's.
    band : Band, optional
        The motion with the law's parameters drawn from their estimates.
    fixed_step : float, optional
        The step [s], where the run was made in fixed steps.
    commands : tuple of str
        Commands that give this report again.
    versions : mapping of str to str
        What the result may depend on.
    digests : mapping of str to str
        Hashes of the inputs.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = Rig(title="Block", mechanism=SpringBlock(mass=1.0, stiffness=100.0, compression=0.1))
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> subject = RunReport(rig=rig, law=law, run=simulate(rig.mechanism, law, t_end=1.0))
    >>> subject.unit, subject.cycles, round(subject.criteria.travel, 4)
    ('m', (), 0.2039)
    """

    rig: Rig
    law: FrictionLaw | Laws | PrintedForm
    run: Trajectory
    estimates: LawEstimates | None = None
    remarks: tuple[str, ...] = ()
    law_file: str = ""
    band: Band | None = None
    fixed_step: float | None = None
    commands: tuple[str, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    digests: Mapping[str, str] = field(default_factory=dict)

    @property
    def single(self) -> bool:
        """Whether one contact slips along a coordinate, so that the run has one travel."""
        return has_one_slip(self.rig.mechanism) and not isinstance(self.law, Laws)

    @property
    def views(self) -> Mapping[str, Trajectory]:
        """The run as each contact that rubs sees it."""
        names = self.run.contacts or (self.run.only_contact,)
        return {name: self.run.contact(name) for name in names}

    @property
    def laws(self) -> Mapping[str, FrictionLaw]:
        """The law of each contact that rubs; none of an equation as printed."""
        if isinstance(self.law, PrintedForm):
            return {}
        return (
            dict(self.law.members)
            if isinstance(self.law, Laws)
            else dict.fromkeys(self.views, self.law)
        )

    @property
    def title(self) -> str:
        """Rig and friction in words."""
        friction = (
            f"{joined(list(dict.fromkeys(law.title for law in self.laws.values())))} friction"
        )
        if isinstance(self.law, PrintedForm):
            friction = f"eq. {self.law.equation} as printed: {self.law.title}"
        return f"{self.rig.heading}, {friction}"

    @property
    def part(self) -> str:
        """What slips, such as "cart"."""
        return self.rig.mechanism.moving_part

    @property
    def slip(self) -> str:
        """Name of the slipping coordinate."""
        return slip_names(self.rig.mechanism)[0]

    @property
    def rate(self) -> str:
        """Name of its rate."""
        return slip_names(self.rig.mechanism)[1]

    @property
    def unit(self) -> str:
        """Unit of the slipping coordinate."""
        return self.run.units[self.slip]

    @property
    def moves(self) -> bool:
        """Whether the body moves at all."""
        # an exact step may lead from rest to rest
        return bool(np.any(self.run[self.rate] != 0.0) or np.ptp(self.run[self.slip]) > 0.0)

    @property
    def mean_velocity(self) -> float:
        """Over all whole cycles, or without any over the run."""
        if self.cycles:
            return sum(cycle.travel for cycle in self.cycles) / (
                len(self.cycles) * self.cycles[0].period
            )
        first, last = self.run.span
        return self.criteria.travel / (last - first)

    @cached_property
    def criteria(self) -> Criteria:
        """What the run does, in the terms of the source paper."""
        measurement = self.rig.measurement
        records = () if measurement is None else measurement.records()
        travel = records[0].travel if len(records) == 1 else None
        return criteria_of(self.run, self.rig.mechanism, None if travel is None else float(travel))

    @cached_property
    def cycles(self) -> tuple[DrivenCycle, ...]:
        """The whole cycles of a run whose drives repeat themselves, of one travel."""
        return next(iter(self.cycles_by_coordinate.values()), ()) if self.single else ()

    @cached_property
    def cycles_by_coordinate(self) -> Mapping[str, tuple[DrivenCycle, ...]]:
        """The whole cycles along each coordinate that slips; none where drives do not repeat."""
        mechanism = self.rig.mechanism
        period = cycle_or_none(mechanism)
        if period is None:
            return {}
        free = [name for name in slipping(mechanism) if name not in mechanism.guided()]
        names = [self.slip] if self.single else free[:MOST_STATES]
        ways = {name: cycles_in(self.run, mechanism, period, coordinate=name) for name in names}
        return {name: cycles for name, cycles in ways.items() if cycles}

    @property
    def lengths(self) -> Mapping[str, float]:
        """What headline and facts say of the motion, by what it is called."""
        if self.cycles:
            last = self.cycles[-1]
            return {"travel in a cycle": last.advance, "back-slip in a cycle": last.back_slip}
        seen = self.criteria
        return {"travel": seen.travel, "largest back-slip": seen.largest_return}

    def of(self, value: float, digits: int = 3, *, per_second: bool = False) -> str:
        """Return a distance or a speed of the slipping coordinate, with its unit."""
        return quantity(value + 0.0, self.unit + ("/s" if per_second else ""), digits)

    def range_beside(self, spread: Spread, value: float, *, per_second: bool = False) -> str:
        """Return a range of distances or speeds in the unit of the number beside it."""
        unit = self.unit + ("/s" if per_second else "")
        scale = scale_of([value] if value else [spread.low, spread.high], unit)
        return scale.interval(spread.low, spread.high)

    def advances(self, travel: float, digits: int = 3) -> str:
        """Return by how much the body advances or moves back, as a predicate."""
        verb = "advances" if travel >= 0.0 else "moves back"
        return f"{verb} {self.of(abs(travel), digits)}"


# The motion in figures and tables: run, cycles, events, criteria.

FIRST_ROWS, LAST_ROWS = 6, 4
"""Cycles of which a table shows the first and the last."""
FIRST_EVENTS, LAST_EVENTS = 12, 4
"""Events of which a table shows the first and the last."""
MOST_STATES = 12
"""Final states, and coordinates with cycles, that are shown."""
MODES = {0: "stick", 1: "slip +", -1: "slip -", 2: "at stop +", -2: "at stop -", 3: "open"}
MOST_DRAWN, DRAWN = 12, 8
"""Cycles up to which all are drawn against time, and how many of more than that."""
ANIMATED = 12.0
"""Frames a second."""
STACKED = (520.0, 560.0)
"""Scene above time plots, in a column of the page [CSS px]."""
PHONE = (358.0, 560.0)
"""The same on a phone."""
SHORTEST_ANIMATION, LONGEST_ANIMATION = 3.0, 8.0
"""How long an animation takes [s]: what is faster is shown in slow motion, what is longer is cut
or sped up."""
ANIMATED_CYCLES = 2
SAMPLES = 2001
"""Times at which the width of a band is asked for."""
LINE = 0.01
"""Width of the line of a curve, as a share of its range."""
ROUNDING = 1e-9
"""Relative error of a travel that is 0: a law fitted to one travel reproduces it to rounding."""


def motion_section(about: RunReport) -> page.Section:
    """Return the run against time, of one contact friction against velocity, and how it ends."""
    run = about.run
    shown = run.names[: 2 * len(about.rig.mechanism.coordinates)] if run.contacts else run.names[:2]
    ends = run.at(run.span)
    final = [
        f"{name} = {number(ends[name][1] + 0.0, 6)} {run.units[name]}"
        for name in shown[:MOST_STATES]
    ]
    left = len(shown) - MOST_STATES
    final += [f"and {left} further states; --json lists all"] if left > 0 else []
    end = page.KeyValue(key=f"At {number(run.span[1], 6)} s", value=", ".join(final))
    figures = _motion(about) if about.single else [_coordinates(about)]
    blocks: list[page.Block] = [*figures, page.KeyValues(items=(end,))]
    return page.Section(id="motion", nav="Motion", heading="The motion", blocks=tuple(blocks))


def _coordinates(about: RunReport) -> page.Figure:
    caption = "**Coordinates** against time; where there are few, dots are events."
    if about.band is not None:
        caption += (
            f" Shaded: range of 95 % of {about.band.count} runs with uncertain parameters drawn."
        )
    draw = plots.draw_states(about.run, band=about.band)
    return figure(draw, "Coordinates against time", "motion", caption, plots.STATE_SIZES)


def _motion(about: RunReport) -> list[page.Figure]:
    force = about.run["normal_force"]
    varies = bool(np.ptp(force) > 1e-9 * np.abs(force).max(initial=0.0))
    what = "Displacement, velocity, friction" + (" and normal force" if varies else "")
    caption = f"**{what}** against time"
    until = None
    if len(about.cycles) > MOST_DRAWN:
        until = about.cycles[DRAWN].begin
    caption += f"; yellow: the {about.part} sticks." if _sticks(about.run, until=until) else "."
    if until is not None:
        caption += f" Of {len(about.cycles)} cycles the first {DRAWN} are shown."
    if about.band is not None:
        shaded = "Shaded" if _seen(about, about.band) else "Narrower than the line"
        caption += (
            f" {shaded}: range of 95 % of {about.band.count} runs with uncertain parameters drawn,"
            " for displacement and velocity."
        )
    draw = plots.draw_run(
        about.run,
        slip=about.slip,
        rate=about.rate,
        until=until,
        normal_force=varies,
        band=about.band,
    )
    sizes = plots.FORCE_SIZES if varies else plots.RUN_SIZES
    return [
        figure(draw, f"{what} against time", "motion", caption, sizes),
        figure(
            plots.draw_friction_velocity(about.run, rate=about.rate, slip=about.slip, until=until),
            "Friction against velocity along the run",
            "friction-velocity",
            "**Friction against velocity** along the run.",
            plots.FRICTION_SIZES,
        ),
    ]


def _seen(about: RunReport, band: Band) -> bool:
    """Whether the band is anywhere wider than the line that is drawn through it."""
    times = np.linspace(*about.run.span, SAMPLES)
    seen = about.run.at(times)
    return any(
        float(np.max(high - low)) > LINE * float(np.ptp(seen[name]))
        for name in band.states
        for low, _, high in [band.at(name, times)]
    )


def _sticks(run: Trajectory, begin: float = -math.inf, until: float | None = None) -> bool:
    """Whether a stick phase, which figures shade yellow, is in what they show."""
    end = math.inf if until is None else until
    return any(start < end and stop > begin for start, stop in run.stick_spans())


def cycles_section(about: RunReport) -> page.Section | None:
    """Return the travel of each cycle of the drives, None without whole cycles."""
    ways = about.cycles_by_coordinate
    if not ways:
        return None
    if not about.single:
        units = dict.fromkeys(about.run.units[name] for name in ways)
        tables = [
            _cycle_table(about, [name for name in ways if about.run.units[name] == unit])
            for unit in units
        ]
        return page.Section(
            id="cycles", nav="Cycles", heading="The last cycle", blocks=tuple(tables)
        )
    cycles = about.cycles
    last = cycles[-1]
    end = min(last.begin + last.period, about.run.span[1])
    chosen = about.law.title if not isinstance(about.law, Laws) else ""
    draw = plots.draw_cycles(
        {chosen: about.run},
        chosen=chosen,
        cycle=(last.begin, end),
        slip=about.slip,
        rate=about.rate,
    )
    caption = (
        "**All cycles, and the velocity in the last one**, near zero if the"
        f" {about.part} moves back in it."
        + (f" Yellow: the {about.part} sticks." if _sticks(about.run, last.begin, end) else "")
    )
    alt = "Displacement in all cycles, and the velocity in the last"
    drawn = figure(draw, alt, "cycles", caption, plots.CYCLE_SIZES)
    blocks: list[page.Block] = [drawn, _cycle_table(about, [about.slip])]
    if len(cycles) > FIRST_ROWS + LAST_ROWS:
        left = f"{FIRST_ROWS + 1} to {len(cycles) - LAST_ROWS}"
        blocks.append(page.Caption(text=f"Cycles {left} of {len(cycles)} are left out."))
    return page.Section(
        id="cycles", nav="Cycles", heading=_cycles_heading(about), blocks=tuple(blocks)
    )


def _cycles_heading(about: RunReport) -> str:
    if not about.moves:
        return f"The {about.part} does not move in any cycle"
    if not about.cycles[-1].moves_on:
        return "The last cycle ends where it began"
    travels = [cycle.travel for cycle in about.cycles]
    advance = f"The {about.part} {about.advances(travels[-1])}"
    if len(travels) == 1:
        return f"{advance} in one cycle"
    if about.cycles[-1].repeats(about.cycles[-2]):
        return f"{advance} per cycle once the motion has settled"
    return f"{advance} in the last cycle and has not settled"


def _cycle_table(about: RunReport, names: Sequence[str]) -> Table:
    """Return the cycles of a coordinate, the first and the last; of several the last of each."""
    unit = about.run.units[names[0]]
    unit = "mm" if unit == "m" else f"m{unit}"
    heads = ["", f"travel\n{unit}"]
    heads += ["95 % band\n" + unit] if about.band is not None else []
    heads += [f"mean velocity\n{unit}/s", f"back-slip\n{unit}", f"lowest velocity\n{unit}/s"]
    heads.append("lowest normal force\nN")
    rows = []
    for name in names:
        cycles = about.cycles_by_coordinate[name]
        shown = list(range(len(cycles))) if about.single else [len(cycles) - 1]
        if len(shown) > FIRST_ROWS + LAST_ROWS:
            shown = [*shown[:FIRST_ROWS], *shown[-LAST_ROWS:]]
        rows += [(f"cycle {k + 1}" if about.single else name, name, k, cycles[k]) for k in shown]
    return table_of(heads, [_cycle_cells(about, *row) for row in rows])


def _cycle_cells(
    about: RunReport, label: str, name: str, place: int, cycle: DrivenCycle
) -> list[Cell]:
    cells: list[Cell] = [label, _thousandth(cycle.advance, 4)]
    if about.band is not None:
        low, _, high = about.band.travels_by_cycle[name][place]
        cells.append(Scale(1e3, "").interval(low, high))
    cells += [_thousandth(cycle.mean_velocity, 4), _thousandth(cycle.back_slip)]
    return [*cells, _thousandth(cycle.least_velocity), number(cycle.least_normal_force)]


def _thousandth(value: float, digits: int = 3) -> str:
    return significant(1e3 * value, digits) if abs(value) > 1e-12 else "0"


def animation_section(about: RunReport) -> page.Section | None:
    """Return the run as a moving picture, None where it is over at once."""
    first, last = about.run.span
    if not about.single:
        return None
    if about.cycles:
        until = first + ANIMATED_CYCLES * about.cycles[0].period
    else:
        until = plots.horizon(about.run, about.slip)
    until = min(until, last)
    length = until - first
    if length <= 0.0:
        return None
    speed = length / min(max(length, SHORTEST_ANIMATION), LONGEST_ANIMATION)
    pace = "in real time"
    if abs(speed - 1.0) > 1e-9:
        pace = (
            f"slowed down {number(1.0 / speed, 2)} times"
            if speed < 1.0
            else f"sped up {number(speed, 2)} times"
        )
    html = partial(
        plots.animation_html,
        about.run,
        about.rig.mechanism,
        alt=f"The mechanism moves: {about.title}",
        fps=ANIMATED,
        speed=speed,
        until=until,
        size=STACKED,
        narrow=PHONE,
    )
    sticks = f"The {about.part} is yellow where it sticks; arrows"
    said = sticks if _sticks(about.run, until=until) else "Arrows"
    caption = f"**The first {quantity(length, 's')}**, to scale, {pace}. {said} are forces."
    block = page.Animation(html=html, caption=caption)
    return page.Section(id="animation", nav="Animation", heading="Animation", blocks=(block,))


def events_section(about: RunReport) -> page.Section:
    """Return the first events and the last; where some are left out, how often each kind was."""
    events = about.run.events
    if not events:
        text = "Fixed steps locate no events." if about.fixed_step is not None else "No events."
        blocks: list[page.Block] = [page.Caption(text=text)]
        return page.Section(id="events", nav="Events", heading="Events", blocks=tuple(blocks))
    kinds = list(dict.fromkeys(event.reason for event in events))
    heading = f"{capital(count(len(events), 'event'))}: {joined(kinds)}"
    left = len(events) - FIRST_EVENTS - LAST_EVENTS
    # a line that says so would take the place of the only event it leaves out
    shown = events if left < 2 else (*events[:FIRST_EVENTS], *events[-LAST_EVENTS:])
    named = [event.contact for event in shown] if any(event.contact for event in shown) else None
    rows = [
        [
            fixed(event.t, 6),
            *([event.contact or "—"] if named else []),
            event.reason,
            MODES[event.from_mode],
            MODES[event.to_mode],
        ]
        for event in shown
    ]
    blocks = [table_of(["t\ns", *(["contact"] if named else []), "event", "from", "to"], rows)]
    if left >= 2:
        text = f"{left:,} further events between them; --json lists all."
        seen = {name: own.events for name, own in about.views.items()}
        blocks += [page.Caption(text=text), event_table({"": events} if about.single else seen)]
    return page.Section(id="events", nav="Events", heading=heading, blocks=tuple(blocks))


def event_table(seen: Mapping[str, Sequence[Event]]) -> Table:
    """Return how often, and when first and last, each kind of event was seen at each contact.

    Contacts without a name have no column.
    """
    named = any(seen)
    rows = []
    for name, events in seen.items():
        for kind in dict.fromkeys(event.reason for event in events):
            times = [event.t for event in events if event.reason == kind]
            cells = (kind, f"{len(times):,}", f"{times[0]:.6f}", f"{times[-1]:.6f}")
            rows.append((name, *cells) if named else cells)
    return table_of(
        [*(["contact"] if named else []), "event", "count", "first\ns", "last\ns"], rows
    )


def contacts_section(about: RunReport) -> page.Section | None:
    """Return friction at each of several contacts, and how much each holds and takes."""
    if about.single:
        return None
    run = about.run
    caption = (
        "**Friction at each contact** against time. Yellow: it sticks; dots are events."
        if len(about.views) <= plots.MOST_PANELS
        else "**What each contact does** against time."
    )
    draw, sizes = plots.draw_contacts(run), plots.contact_sizes(run)
    first, last = run.span
    rows = []
    for name, own in about.views.items():
        work = run.certificate.work.get(name, run.certificate.work_friction)
        held = own.stick_time()
        share = percent(held / (last - first)) if last > first else "none"
        cells = (f"{len(own.events):,}", share, number(held, 4), number(work, 4))
        rows.append((name or "the contact", *cells))
    heads = ["contact", "events", "of the time it sticks", "sticks\ns", "work taken\nJ"]
    drawn = figure(draw, "Friction at each contact", "contacts", caption, sizes)
    return page.Section(
        id="contacts",
        nav="Contacts",
        heading="The contacts",
        blocks=(drawn, table_of(heads, rows)),
    )


def criteria_section(about: RunReport) -> page.Section | None:
    """Return the three criteria of the source paper, evaluated on a run with one travel."""
    if not about.single:
        return None
    seen = about.criteria
    items = (
        page.KeyValue(
            key="1. The velocity never becomes negative",
            value=_held(
                seen.velocity_never_negative,
                f"lowest velocity {about.of(seen.least_velocity, 3, per_second=True)}",
            ),
            mark="ok" if seen.velocity_never_negative else "warn",
        ),
        page.KeyValue(
            key="2. The displacement never decreases",
            value=_held(
                seen.displacement_never_decreases,
                f"largest back-slip {about.of(seen.largest_return)}"
                if seen.travel >= 0.0
                else f"travel {about.of(seen.travel)}",
            ),
            mark="ok" if seen.displacement_never_decreases else "warn",
        ),
        page.KeyValue(
            key="3. Relative error of the travel",
            value=_third(about),
        ),
    )
    text = (
        f"A drive force larger than friction can move the {about.part} backwards, and elastic"
        f" bristles spring back when the {about.part} stops: failing criterion 1 or 2 does not"
        " refute the law."
    )
    blocks = (page.KeyValues(items=items), page.Caption(text=text))
    return page.Section(
        id="criteria", nav="Criteria", heading="The criteria of the source paper", blocks=blocks
    )


def _third(about: RunReport) -> str:
    """Return the error of the travel, or of all that were measured, in words."""
    error, measurement = about.criteria.relative_error, about.rig.measurement
    if error is not None:
        return f"{number(100.0 * error) if abs(error) > ROUNDING else 0} % of the measured one"
    if measurement is None or not measurement.travelled:
        return "no travel of this rig was measured"
    return "the measured travels are not those of this run"


def _held(holds: bool, found: str) -> str:
    return f"{'holds' if holds else 'does not hold'}: {found}"


# The end of the report of a run: the law and its doubt, certificate, how to reproduce it.


def law_section(about: RunReport) -> page.Section:
    """Return laws with their parameters, their intervals, and what does not carry over."""
    known, laws = about.estimates, about.laws
    rows: list[Sequence[Cell]] = []
    for contact, law in laws.items():
        lead = () if about.single else (contact or "the contact", law.title)
        prefix = "" if known is None or isinstance(known.law, str) else f"{contact}."
        for path, known_quantity, value in parameters(law, "friction"):
            name = path.removeprefix("friction.")
            label = f"{name.replace('_', ' ').capitalize()} ${known_quantity.symbol}$"
            unit = known_quantity.unit
            unit = unit_on(about.rig.mechanism, known_quantity) if about.single else unit
            shown = "none" if unit == "1" else unit
            rows.append((*lead, label, number(value, 4), shown, *how_known(known, prefix + name)))
        for name, (own, other) in equated(law).items():
            label = f"{name.replace('_', ' ').capitalize()} ${own}$"
            rows.append((*lead, label, f"${other}$", "none", "—", "assumed, not measured"))
    kind = "95 %" if known is None else known.interval
    heads = ["parameter", "value", "unit", kind, "how it is known"]
    heads = heads if about.single else ["contact", "law", *heads]
    if not about.single and known is None:  # all of them are as given
        heads, rows = heads[:-2], [row[:-2] for row in rows]
    table = table_of(heads, rows)
    blocks: list[page.Block] = [
        page.Math(latex=law.formula) for law in {type(law): law for law in laws.values()}.values()
    ]
    blocks.append(table)
    if about.remarks:
        title = "Validity of the law."
        blocks.append(page.Note(kind="info", title=title, text=" ".join(about.remarks)))
    if isinstance(about.law, FrictionLaw) and len(laws) > 1:
        blocks.append(page.Caption(text="All contacts share one law."))
    idle = [contact.name for contact in about.rig.mechanism.contacts() if contact.name not in laws]
    if idle and not about.single:
        blocks.append(page.Caption(text=f"Nothing rubs at {joined(idle)}."))
    from_file = f", from `{about.law_file}`" if about.law_file else ""
    names = joined(list(dict.fromkeys(law.title for law in laws.values())))
    heading, nav = f"{names} friction{from_file}", "The law" if about.single else "The laws"
    return page.Section(id="law", nav=nav, heading=heading, blocks=tuple(blocks))


def how_known(known: LawEstimates | None, name: str) -> tuple[str, str]:
    """Return the interval of a parameter, and how it is known."""
    if known is None or name not in (*known.intervals, *known.not_identified, *known.not_fitted):
        return "—", "as given"
    if name in known.not_fitted:
        return "—", "overridden" if name in known.overridden else "given or assumed"
    if name in known.not_identified:
        return "—", f"not identified: {known.not_identified[name]}"
    return interval(*known.intervals[name]), "stated" if name in known.stated else "fitted"


def spread_section(about: RunReport) -> page.Section | None:
    """Return the spread of the motion over draws of uncertain parameters; None without a band."""
    band, known = about.band, about.estimates
    if band is None:
        return None
    seen = band.in_short()
    of_law = [path for path in band.draws if path.startswith("friction.")]
    of_rig = ", ".join(_in_words(path) for path in band.draws if path not in of_law)
    begin = f"{band.count} draws (seed {band.seed}) of"
    rig = f"{of_rig}, normal with their standard uncertainties and independent"
    if known is None or not of_law:
        text = f"{begin} {rig}. It has no measurement noise."
    else:
        names = ", ".join(_in_words(path.removeprefix("friction.")) for path in of_law)
        how = (
            "with their covariance"
            if len(known.covariance_of) > 1
            else f"uniform within the {known.interval}"
            if known.interval in HARD
            else "normal with the 95 % interval"
        )
        text = (
            f"{begin} {names}, {how}, in the valid ranges of"
            f" {'the law' if isinstance(known.law, str) else 'the laws'}"
            f"{f'; and of {rig}' if of_rig else ''}. It has no measurement noise."
        )
        if known.kept:
            text += f" Fixed: {', '.join(map(_in_words, known.kept))}."
    return page.Section(
        id="spread",
        nav="Uncertainty",
        heading=f"{band.count} runs with uncertain parameters drawn",
        blocks=(
            table_of(seen.head, seen.rows),
            page.Caption(text=" ".join([text, *band.reasons])),
            *explained(band),
        ),
    )


def explained(band: Band) -> list[page.Block]:
    """Return which uncertain parameter spreads each travel, or why that is not said."""
    if len(band.draws) < 2:
        return []
    try:
        shares = {name: band.shares(name) for name in band.travels}
    except InputError as error:
        return [page.Caption(text=f"Which parameter the spread comes from is not said: {error}")]
    names = [
        _in_words(path.removeprefix("friction.").removeprefix("mechanism.")) for path in band.draws
    ]
    rows = [
        (name, *(indices.text_of("first", place) for indices in shares.values()))
        for place, name in enumerate(names)
    ]
    heads = (f"share of the variance\nof the travel of {name}" for name in shares)
    table = table_of(["uncertain parameter", *heads], rows)
    text = (
        "Sobol indices of first order with 95 % intervals, from the draws of the band: what each"
        " parameter explains alone."
    )
    for name, item in shares.items():
        share, half = item.indices["first"], item.half_widths["first"]
        *_, second, first = np.argsort(share).tolist()
        if share[first] - share[second] > math.hypot(half[first], half[second]):
            text += f" To know the travel of {name} better, measure the {names[first]} first."
        elif share[first] <= half[first]:
            text += f" No parameter alone is shown to spread the travel of {name}."
        else:
            both = f"{names[first]} and {names[second]}"
            text += (
                f" {item.used} runs do not settle which of {both} spreads the travel of {name}"
                " more."
            )
    return [table, page.Caption(text=text)]


def _in_words(name: str) -> str:
    """Return a parameter in words, after its contact if it has one."""
    contact, _, own = name.rpartition(".")
    return f"{contact} {own.replace('_', ' ')}".strip()


def certificate_section(about: RunReport) -> page.Section:
    """Return how far to trust the computation, in words."""
    exact = about.fixed_step is None
    if not exact:
        heading = "Fixed steps have no certificate"
    elif about.run.certificate.certified:
        heading = "The run is certified"
    else:
        heading = "The run is not certified"
    text = (
        "The certificate shows that the equations were solved correctly: energies are integrated"
        " independently of the motion. It does not show that the law describes the contact."
    )
    blocks = (page.KeyValues(items=evidence(about.run, located=exact)), page.Caption(text=text))
    return page.Section(id="certificate", nav="Certificate", heading=heading, blocks=blocks)


def reproduce_section(about: RunReport) -> page.Section:
    """Return commands, versions, hashes and the sources of the laws."""
    origin = page.Origin(
        title=about.rig.heading,
        data="",
        files=about.digests,
        commands=about.commands,
        versions=about.versions,
    )
    laws = {type(law): law for law in about.laws.values()}.values()
    cited = {"paper": ["criteria"]} if about.single else {}
    return reproduce(origin, laws=laws, cited=cited)


# The report of a run as a page.


def opening_section(about: RunReport) -> page.Section:
    """Return the headline with its numbers, and what the run cannot tell."""
    opening = page.Opening(
        kicker=about.title,
        verdict=_headline(about),
        lede=_lede(about),
        facts=_facts(about),
        settles=_settles(about),
        cannot_tell=_cannot_tell(about),
        record="run",
    )
    return page.Section(id="result", nav="Result", heading="", blocks=(opening,))


def _headline(about: RunReport) -> str:
    run, part = about.run, about.part
    if not run.status.complete:
        return ended_early(run.span[1])
    if not about.single:
        at, events = count(len(about.views), "contact"), run.events
        if not events:
            return f"No event at {at} in {quantity(run.span[1] - run.span[0], 's')}"
        last = f"the last at {quantity(events[-1].t, 's')}"
        return f"{capital(count(len(events), 'event'))} at {at}, {last}"
    seen = about.criteria
    if not about.moves:
        return f"The {part} does not move"
    if about.cycles:
        last_cycle = about.cycles[-1]
        if not last_cycle.moves_on:
            return f"The {part} makes no net motion: the last cycle ends where it began"
        way = "moves" if last_cycle.travel > 0.0 else "moves back"
        return (
            f"The {part} {way} {about.of(abs(last_cycle.travel))} in a cycle of"
            f" {quantity(last_cycle.period, 's')}"
        )
    if seen.stop_time is not None:
        after = quantity(seen.stop_time, "s")
        return f"The {part} comes to rest {about.of(seen.travel)} from its start, after {after}"
    return f"The {part} has moved {about.of(seen.travel)} after {quantity(run.span[1], 's')}"


def _lede(about: RunReport) -> str:
    said = [about.run.ending]
    if about.cycles:
        number = count(len(about.cycles), "whole cycle")
        travel = sum(cycle.travel for cycle in about.cycles)
        if about.moves:
            said.append(f"The {about.part} {about.advances(travel, 4)} in {number}.")
    if about.single:
        moved = about.cycles[-1].advance if about.cycles else about.criteria.travel
        resting = _resting(about, moved)
        said += [f"The travel {resting.removeprefix('; ')}."] if resting else []
    if isinstance(about.law, PrintedForm) and about.run.status is Status.END_TIME:
        speed = float(about.run[about.rate][-1])
        unit = about.run.units[about.rate]
        said += [f"The body still moves then, at {quantity(speed, unit, 3)}."] if speed else []
    return " ".join([*said, *_spread(about)])


def _spread(about: RunReport) -> list[str]:
    """Return by how much coordinates differ between the runs of the band, in sentences."""
    band = about.band
    if band is None:
        return []
    shown = joined(
        [
            f"{name} changes by"
            f" {scale_of([item.low, item.high], band.units[name]).interval(item.low, item.high)}"
            for name, item in [*band.travels.items()][:MOST_SAID]
        ]
    )
    return [
        "With uncertain parameters drawn, over the whole run"
        f" {shown} in 95 % of {band.count} runs.",
        *band.reasons,
    ]


def _facts(about: RunReport) -> tuple[page.Fact, ...]:
    if not about.single:
        book = about.run.certificate
        work = page.Fact(value=quantity(book.work_friction, "J", 4), what="work taken by friction")
        decided = page.Fact(value=f"{book.decisions:,}", what="instants decided together")
        return (work, decided) if book.decisions else (work,)
    band, seen = about.band, about.criteria
    moved = about.cycles[-1].advance if about.cycles else seen.travel
    travel = page.Fact(
        value=about.of(seen.travel, 4),
        aside="" if band is None else about.range_beside(band.travel, seen.travel),
        what=f"travel in the whole run{_resting(about, moved)}",
    )
    mean = page.Fact(
        value=about.of(about.mean_velocity, per_second=True),
        aside=""
        if band is None
        else about.range_beside(band.mean_velocity, about.mean_velocity, per_second=True),
        what="mean velocity over whole cycles" if about.cycles else "mean velocity of the run",
    )
    slip = about.cycles[-1].back_slip if about.cycles else seen.largest_return
    name = "back-slip in the last cycle" if about.cycles else "largest back-slip"
    back = page.Fact(value=about.of(slip), what=f"{name}{_resting(about, slip)}")
    return travel, mean, back


def _resting(about: RunReport, distance: float) -> str:
    """Return on which bristles a distance rests that no measurement determined, behind a comma."""
    law = next(iter(about.laws.values()), None)
    if law is None:
        return ""
    result = unfitted_bristles(law, about.estimates, distance, about.rig.mechanism)
    return f"; depends on {joined(list(result))}, which no measurement determined" if result else ""


def _settles(about: RunReport) -> tuple[str, ...]:
    if about.fixed_step is not None:
        step = quantity(about.fixed_step, "s")
        return (f"The solution in fixed steps of {step}; events are not located.",)
    if not about.run.certificate.certified:
        return ()
    return ("The solution of the equations with this law: the run is certified.",)


def _cannot_tell(about: RunReport) -> tuple[str, ...]:
    said = []
    if about.law_file:
        said.append(
            "Whether this contact has the same friction as the one to which the law was fitted."
        )
    said += [
        f"By how much static friction exceeds sliding friction: ${own}$ was neither measured nor"
        f" given and is set equal to ${other}$."
        for own, other in dict.fromkeys(
            pair for law in about.laws.values() for pair in equated(law).values()
        )
    ]
    said.append(_of_uncertainty(about))
    if not about.run.status.complete:
        said.append("The motion after the run ended.")
    return tuple(said)


def _of_uncertainty(about: RunReport) -> str:
    """Return what the run does not tell of the uncertainty of its motion."""
    rig = about.rig.parameter_uncertainties
    if about.band is None:
        known = ["the law's intervals"] * (about.estimates is not None)
        known += ["the uncertainties of the mechanism"] * bool(rig)
        if not known:
            return "The uncertainty of the motion: the law has no intervals."
        return f"The uncertainty of the motion: `--ensemble 200` computes it from {joined(known)}."
    if about.estimates is None:
        return "The uncertainty of the motion that the law adds: it has no intervals."
    return "The motion with another law that fits the data as well."


SECTIONS: tuple[Callable[[RunReport], page.Section | None], ...] = (
    opening_section,
    motion_section,
    cycles_section,
    animation_section,
    contacts_section,
    events_section,
    criteria_section,
    law_section,
    spread_section,
    certificate_section,
    reproduce_section,
)
SHORT = (
    opening_section,
    motion_section,
    cycles_section,
    contacts_section,
    events_section,
    certificate_section,
    spread_section,
)
"""What the terminal shows."""
MOST_SAID = 4
"""Coordinates whose spread the opening gives."""


def run_sections(about: RunReport) -> tuple[page.Section, ...]:
    """Return the sections of a run that the terminal shows."""
    return page.made_sections(*(partial(make, about) for make in SHORT))


def run_page(about: RunReport) -> str:
    """Return the report of a run as one HTML file.

    A section that cannot be made is a line on the page that says why.

    Examples
    --------
    >>> from stickslip import Coulomb, Rig, SpringBlock, simulate
    >>> rig = Rig(title="Block", mechanism=SpringBlock(mass=1.0, stiffness=100.0, compression=0.1))
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> run = simulate(rig.mechanism, law, t_end=1.0)
    >>> page = run_page(RunReport(rig=rig, law=law, run=run))
    >>> "The block comes to rest" in page, "could not be produced" in page
    (True, False)
    """
    return page.render(
        page.Page(
            title=about.title,
            subject=about.rig.path or about.rig.heading,
            sections=page.made_sections(*(partial(make, about) for make in SECTIONS)),
            footer=page.colophon(about.versions),
            kicker="simulation report",
        )
    )
