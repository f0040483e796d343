"""The certificate of a run as a list: what was checked, and how well it holds."""

import math

from stickslip.formatting import fixed, quantity, residue, scale_of, significant, with_unit
from stickslip.report.core.blocks import KeyValue
from stickslip.trajectory import Trajectory


def evidence(run: Trajectory, *, located: bool = True) -> tuple[KeyValue, ...]:
    """Return the certificate of a run, check by check.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> [item.key for item in evidence(run)]
    ['Energy', 'Events', 'Sticking and slipping', 'Drift at rest', 'Steps']
    """
    book = run.certificate
    parts = book.work_friction, book.work_stops, book.energy_end
    given, friction, at_stops, left = _balance(book.energy_start + book.work_supplied, *parts)
    stops = f", {at_stops} by the stops" if book.work_stops else ""
    energy = (
        f"{given} initially and from the drives; {friction} dissipated by friction{stops};"
        f" {left} remaining. Mismatch {residue(book.energy_error)}"
    )
    items = [KeyValue(key="Energy", value=energy, mark="ok" if book.certified else "warn")]
    if located:
        events = "event" if len(run.events) == 1 else "events"
        still = book.stick_drift == 0.0
        items += [
            KeyValue(
                key="Events",
                value=f"{len(run.events):,} {events} located; largest relative residual of an"
                f" event condition {residue(book.event_residual)}",
            ),
            KeyValue(
                key="Sticking and slipping",
                value=f"largest violation of a condition: {residue(book.guard_violation)}",
            ),
            KeyValue(
                key="Drift at rest",
                value="exactly 0" if still else quantity(book.stick_drift, "m", 1),
                mark="ok" if still else "warn",
            ),
        ]
    steps = f"{book.steps:,} accepted, {book.rejected:,} rejected"
    items.append(KeyValue(key="Steps", value=steps))
    items += [KeyValue(key="Near a limit", value=text, mark="warn") for text in book.warnings]
    items += [KeyValue(key="Problem", value=text, mark="bad") for text in book.problems]
    return tuple(items)


def _balance(*energies: float) -> list[str]:
    """Return energies in one unit and with the decimals of the largest, which has four digits."""
    scale = scale_of(energies, "J")
    largest = scale.factor * max((abs(one) for one in energies if math.isfinite(one)), default=0.0)
    if not largest >= 1e-3:
        return [with_unit(significant(scale.factor * one, 4), scale.unit) for one in energies]
    decimals = max(3 - math.floor(math.log10(largest)), 0)
    return [
        with_unit(fixed(scale.factor * one, decimals) if one else "0", scale.unit)
        for one in energies
    ]
