"""What the paper has right."""

from stickslip.formatting import fixed, percent, quantity, significant, with_unit
from stickslip.paper.audit import PaperAudit
from stickslip.paper.sections.cart import largest_pull
from stickslip.report import KeyValue, KeyValues, Section


def merit_section(found: PaperAudit) -> Section:
    """List what stands, each with the number that bears it out."""
    study, coulomb = found.cart, found.table[0]
    old, exact = study.run("printed-1"), study.run("exact")
    old_1, exact_1 = study.run("table-1"), study.run("table-1-exact")
    pull = largest_pull(exact_1)
    free = next(row for row in found.fixed_steps if row.dt is not None and not row.stick_rule)
    spring = coulomb.reading("B")
    fitted = found.verdict.best.fit if found.verdict.best else None
    known = None if fitted is None else fitted.estimates[0]
    inside = known is not None and known.low <= found.values.mu_k <= known.high
    items = (
        KeyValue(
            key="A rule for rest is needed",
            value=(
                f"without it, in steps of {1e3 * (free.dt or 0.0):g} ms, the velocity of the block"
                f" changes its sign {free.reversals} times in 1 s and reaches"
                f" {with_unit(significant(1e3 * free.criteria.least_velocity, 2), 'mm/s')}"
            ),
            mark="ok",
        ),
        KeyValue(
            key="The rule for rest of (5)",
            value="the resultant force up to $F_s$, and $F_s$ beyond it: the rule used here",
            mark="ok",
        ),
        KeyValue(
            key="The coefficient of Table I",
            value=(
                f"$mu_d$ = {found.values.mu_k:g}, from a handbook, "
                + ("lies inside" if inside else "is tried against")
                + " the range that the measured travel allows, the spring released"
                + ("" if known is None else f": {known.low:.3f} to {known.high:.3f}")
            ),
            mark="ok" if inside else "warn",
        ),
        KeyValue(
            key="Table II",
            value="its relative errors follow from its displacements and the measured 0.20 m",
            mark="ok",
        ),
        KeyValue(key="The dynamics (2)", value="right while the cart slides, with (1)", mark="ok"),
        KeyValue(
            key="The energy balance (11)",
            value=(
                f"right for the released block: {fixed(spring.closed_form or 0.0, 4)} m, as"
                " simulated"
            ),
            mark="ok",
        ),
        KeyValue(
            key="The cart need not move backwards",
            value=(
                f"with Table I’s $mu_s$ = {found.values.mu_s:g} the swing that is used here pulls"
                f" the resting cart back with at most {percent(pull)} of the normal force, and the"
                f" back-slip is {_way(exact_1.mean_return)} a cycle"
            ),
            mark="ok" if exact_1.mean_return == 0.0 else "warn",
        ),
        KeyValue(
            key="“The same displacement”",
            value=(
                "roughly so, like for like, (1) and (2) in steps of 10 ms against the exact run,"
                f" five cycles: {fixed(old.travel, 3)} and {fixed(exact.travel, 3)} m at"
                f" $mu$ = 0.2, {fixed(old_1.travel, 3)} and {fixed(exact_1.travel, 3)} m at the"
                f" levels of Table I; the back-slip falls from {_way(old.mean_return)} to"
                f" {_way(exact.mean_return)} and from {_way(old_1.mean_return)} to"
                f" {_way(exact_1.mean_return)} a cycle"
            ),
            mark="ok",
        ),
    )
    return Section(
        id="merits",
        nav="What stands",
        heading="What the paper has right",
        blocks=(KeyValues(items=items),),
    )


def _way(way: float) -> str:
    return "0 mm" if way == 0.0 else quantity(way, "m", 2)
