"""The report of a run with several contacts."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial

from stickslip.data import LawEstimates, Rig
from stickslip.engine.trajectory import Trajectory
from stickslip.friction import FrictionLaw, Laws
from stickslip.quantities import parameters
from stickslip.show import plots
from stickslip.show.formatting import capital, count, joined, number, percent, quantity, scale_of
from stickslip.show.report import blocks as page
from stickslip.show.report.runs import certificate_of, drawn, event_table, how_known
from stickslip.show.report.shared_sections import ended_early, reproduce
from stickslip.show.report.tables import Column, Row, Table
from stickslip.study.sweep import Band

MOST_SAID = 4
"""Coordinates whose spread the opening gives."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactsReport:
    """A run with several contacts and what is known of it.

    Parameters
    ----------
    rig : Rig
        What moved.
    friction : FrictionLaw or Laws
        The law that all contacts share, or laws by contact.
    run : Trajectory
        How.
    estimates : LawEstimates, optional
        How well the law, or the laws by contact, are known.
    band : Band, optional
        The motion with parameters drawn from their estimates.
    commands : tuple of str
        Commands that give this report again.
    versions : mapping of str to str
        What the result may depend on.
    digests : mapping of str to str
        Hashes of the inputs.
    """

    rig: Rig
    friction: FrictionLaw | Laws
    run: Trajectory
    estimates: LawEstimates | None = None
    band: Band | None = None
    commands: tuple[str, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    digests: Mapping[str, str] = field(default_factory=dict)

    @property
    def views(self) -> Mapping[str, Trajectory]:
        """The run as each contact that rubs sees it."""
        names = self.run.contacts or (self.run.only_contact,)
        return {name: self.run.contact(name) for name in names}

    @property
    def laws(self) -> Mapping[str, FrictionLaw]:
        """The law of each contact that rubs."""
        if isinstance(self.friction, Laws):
            return dict(self.friction.members)
        return dict.fromkeys(self.views, self.friction)

    @property
    def kinds(self) -> str:
        """The laws in words."""
        return joined(list(dict.fromkeys(law.title for law in self.laws.values())))


def contacts_page(about: ContactsReport) -> str:
    """Return the report of a run with several contacts as one HTML file.

    Examples
    --------
    >>> from stickslip import Coulomb, TwoFeet, simulate
    >>> body = TwoFeet(mass=2.0, front=0.3, rear=0.2)
    >>> law = Coulomb(kinetic_coefficient=0.2)
    >>> run = simulate(body, law, t_end=1.0, y0={"v": 0.5})
    >>> page = contacts_page(ContactsReport(rig=Rig(mechanism=body), friction=law, run=run))
    >>> "could not be made" in page
    False
    """
    makers = (
        opening_section,
        motion_section,
        contacts_section,
        events_section,
        laws_section,
        certificate_section,
        reproduce_section,
    )
    return page.render(
        page.Page(
            title=f"{about.rig.heading}: {about.kinds} friction",
            subject=about.rig.path or about.rig.heading,
            sections=page.made_sections(*(partial(make, about) for make in makers)),
            footer=page.colophon(about.versions),
            kicker="simulation report",
        )
    )


def opening_section(about: ContactsReport) -> page.Section:
    """Say how the run ended and what each contact did."""
    run = about.run
    events = run.events
    if not run.status.complete:
        verdict = ended_early(run.span[1])
    elif events:
        last = f"the last at {quantity(events[-1].t, 's')}"
        verdict = f"{capital(count(len(events), 'event'))} at {_number(about)}, {last}"
    else:
        verdict = f"Nothing changes at {_number(about)}"
    book = run.certificate
    facts = [page.Fact(value=quantity(book.work_friction, "J", 4), what="work taken by friction")]
    if book.decisions:
        facts.append(page.Fact(value=f"{book.decisions:,}", what="instants decided together"))
    opening = page.Opening(
        kicker=f"{about.rig.heading}, {about.kinds} friction",
        verdict=verdict,
        lede=" ".join([run.ending, *_spread(about), *book.warnings]),
        facts=tuple(facts),
        cannot_tell=("Whether the laws describe the contacts: that takes measurements of each.",),
        record="run",
    )
    return page.Section(id="result", nav="Result", heading="", blocks=(opening,))


def _spread(about: ContactsReport) -> list[str]:
    """Return by how much coordinates differ between the runs of the band, in sentences."""
    band = about.band
    if band is None:
        return []
    travels = list(band.travels.items())
    shown = joined(
        [
            f"{name} changes by"
            f" {scale_of([one.low, one.high], band.units[name]).interval(one.low, one.high)}"
            for name, one in travels[:MOST_SAID]
        ]
    )
    return [
        "With uncertain parameters drawn, over the whole run"
        f" {shown} in 95 % of {band.count} runs.",
        *band.reasons,
    ]


def _number(about: ContactsReport) -> str:
    return count(len(about.views), "contact")


def motion_section(about: ContactsReport) -> page.Section:
    """Draw the coordinates."""
    alt = "Coordinates against time"
    caption = "**Coordinates** against time; where there are few, dots are events."
    if about.band is not None:
        caption += (
            f" Shaded: range of 95 % of {about.band.count} runs with uncertain parameters drawn."
        )
    draw = plots.draw_states(about.run, band=about.band)
    figure = page.Figure(
        svg=plots.inline_svg(draw, alt=alt, prefix="motion", **plots.STATE_SIZES), caption=caption
    )
    return page.Section(id="motion", nav="Motion", heading="The motion", blocks=(figure,))


def contacts_section(about: ContactsReport) -> page.Section:
    """Return friction at each contact, and how much each holds and takes."""
    run = about.run
    sizes = plots.contact_sizes(run)
    figure = page.Figure(
        svg=plots.inline_svg(
            plots.draw_contacts(run), alt="Friction at each contact", prefix="contacts", **sizes
        ),
        caption=(
            "**Friction at each contact** against time. Yellow: it sticks; dots are events."
            if len(about.views) <= plots.MOST_PANELS
            else "**What each contact does** against time."
        ),
    )
    first, last = run.span
    rows = []
    for name, own in about.views.items():
        work = run.certificate.work.get(name, run.certificate.work_friction)
        share = percent(own.stick_time() / (last - first)) if last > first else "none"
        rows.append(Row(cells=(name, f"{len(own.events):,}", share, number(work, 4))))
    columns = (
        Column(head="contact"),
        Column(head="events", numeric=True, phone="label", label="events:"),
        Column(head="of the time it sticks", numeric=True, phone="label", label="sticks:"),
        Column(head="work taken\nJ", numeric=True, phone="label"),
    )
    table = Table(columns=columns, rows=tuple(rows))
    return page.Section(
        id="contacts", nav="Contacts", heading="The contacts", blocks=(figure, table)
    )


def events_section(about: ContactsReport) -> page.Section:
    """Return what happened how often at each contact, first and last."""
    events = {name: own.events for name, own in about.views.items()}
    block: page.Block = (
        event_table(events) if any(events.values()) else page.Caption(text="No events.")
    )
    return page.Section(id="events", nav="Events", heading="Events", blocks=(block,))


def laws_section(about: ContactsReport) -> page.Section:
    """Return the formula of each kind of law, and the parameters by contact."""
    laws, known = about.laws, about.estimates
    kinds = {type(law): law for law in laws.values()}
    rows = []
    for name, law in laws.items():
        for path, known_quantity, value in parameters(law, "friction"):
            what = path.removeprefix("friction.").replace("_", " ").capitalize()
            unit = "none" if known_quantity.unit == "1" else known_quantity.unit
            cells = [name, law.title, f"{what} ${known_quantity.symbol}$", number(value, 4), unit]
            if known is not None:
                prefix = "" if isinstance(known.law, str) else f"{name}."
                cells += how_known(known, prefix + path.removeprefix("friction."))
            rows.append(Row(cells=tuple(cells)))
    columns = [
        Column(head="contact"),
        Column(head="law", phone="label", label="law:"),
        Column(head="parameter", phone="label", label="parameter:"),
        Column(head="value", numeric=True, phone="label", label="value:"),
        Column(head="unit", phone="label", label="unit:"),
    ]
    if known is not None:
        columns += [
            Column(head=known.interval, numeric=True, phone="label", label=f"{known.interval}:"),
            Column(head="how it is known", phone="label", label="known:"),
        ]
    idle = [contact.name for contact in about.rig.mechanism.contacts() if contact.name not in laws]
    blocks: list[page.Block] = [page.Math(latex=law.formula) for law in kinds.values()]
    blocks.append(Table(columns=tuple(columns), rows=tuple(rows)))
    blocks += drawn(about.band, known)
    if isinstance(about.friction, FrictionLaw) and len(laws) > 1:
        blocks.append(page.Caption(text="All contacts share one law."))
    if idle:
        blocks.append(page.Caption(text=f"Nothing rubs at {joined(idle)}."))
    return page.Section(id="law", nav="The laws", heading="The laws", blocks=tuple(blocks))


def certificate_section(about: ContactsReport) -> page.Section:
    """Tell what the certificate of the run says."""
    return certificate_of(about.run)


def reproduce_section(about: ContactsReport) -> page.Section:
    """Tell how to repeat the run."""
    laws = {type(law): law for law in about.laws.values()}
    origin = page.Origin(
        title=about.rig.heading,
        data="",
        files=about.digests,
        commands=about.commands,
        versions=about.versions,
    )
    return reproduce(origin, laws=laws.values())
