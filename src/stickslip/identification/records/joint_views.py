"""A fit to several joints as one of a single joint, whose plots and tests then apply."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast, final

import numpy as np
from numpy.typing import NDArray

from stickslip.experiments import Measurement
from stickslip.friction import Laws
from stickslip.identification.estimation.estimates import (
    estimates_of,
    offset_left_out,
    sentences_of,
)
from stickslip.identification.estimation.halves import Halves, contradiction
from stickslip.identification.estimation.jackknife import Directions, Inference, effective_size
from stickslip.identification.estimation.parameters import FreeParameters, by_joint
from stickslip.identification.estimation.problem import ResidualJacobian
from stickslip.identification.force_map.joint_balance import (
    JointBalance,
    JointBalanceBuilder,
    contacts_along,
    joint_record,
    with_own_segments,
)
from stickslip.identification.force_map.model import ForceMap
from stickslip.identification.records.fit import RecordFit, settled
from stickslip.identification.records.joint_fitting import JOINTS

Array = NDArray[np.float64]


Pairs = Sequence[tuple[Measurement, Measurement]]


def joint_view(fit: RecordFit[Laws], contact: str, *, records: Pairs = ()) -> RecordFit:
    """Return the law of one contact as if it had been fitted alone, the mechanism being known.

    Parameters of the mechanism are at their fitted values, and intervals are those of the fit to
    all joints: uncertainties of what the joints share are in them.
    """
    whole = cast("JointBalance", fit.problem)
    coordinate = next(c for c, one in contacts_along(fit.mechanism).items() if one.name == contact)
    if not records:
        records = [(joint_record(fit.mechanism, fit.measurement, coordinate), fit.measurement)]
    known = whole.maps[coordinate]
    local = dict(zip(whole.names[coordinate], known.free_parameters.paths, strict=True))
    names = [name for name, path in local.items() if path not in known.linear]
    at = [fit.free_parameters.paths.index(name) for name in names]

    def alone(every: FreeParameters) -> FreeParameters:
        """Return those of this joint, called as if there were no other."""
        items = {item.path: item for item in known.free_parameters.items}
        found = []
        for item in (every.items[i] for i in at):
            own = items[local[item.path]]
            symbol = own.quantity.symbol
            quantity = replace(item.quantity, symbol=symbol)
            found.append(replace(item, path=own.path, above=own.above, quantity=quantity))
        return FreeParameters(tuple(found), known.free_parameters.known)

    free, told = alone(fit.free_parameters), alone(by_joint(fit.free_parameters, fit.mechanism))
    law = dict(fit.law.members).get(contact) or known.law
    stretches = with_own_segments(known.stretches)
    problem = replace(
        known, law=law, stretches=stretches, linear=(), derived=(), free_parameters=free
    )
    best = _best(problem, fit.values[at])
    inference = _inference(fit, best, at)
    at_bounds = {local[path]: side for path, side in fit.at_bounds.items() if path in names}
    halves = fit.halves and _halves(fit.halves, at)
    estimates = estimates_of(told, best, inference, at_bounds)
    share = best.cost / max(fit.optimum.best.cost, 1e-300)
    rows = fit.problem.joints == coordinate
    return RecordFit(
        law=law,
        mechanism=fit.mechanism,
        estimates=estimates,
        route=JOINTS,
        measurement=records[0][0],
        problem=problem,
        build=_ViewBuilder(
            cast("JointBalanceBuilder", fit.build), coordinate, problem, tuple(records)
        ),
        optimum=replace(
            fit.optimum,
            best=best,
            costs=tuple(share * one for one in fit.optimum.costs),
            values=fit.optimum.values[:, at],
        ),
        inference=inference,
        halves=halves,
        displaced=tuple(
            replace(one, rows=one.rows[rows] / whole.weights[coordinate]) for one in fit.displaced
        ),
        at_bounds=at_bounds,
        cancelled=fit.cancelled,
        search_failure=fit.search_failure,
        sentences=(
            *((fit.search_failure,) if fit.search_failure else ()),
            *(() if halves is None else contradiction(told, halves)),
            *sentences_of(told, best, inference, at_bounds, estimates),
            *offset_left_out(law, fit.mechanism, told),
        ),
    )


@final
@dataclass(frozen=True)
class _ViewBuilder:
    """Builds the problem of one joint of a record of several."""

    build: JointBalanceBuilder
    """Builds that of all joints."""
    coordinate: str
    """The joint."""
    problem: ForceMap
    """The problem that was fitted."""
    records: tuple[tuple[Measurement, Measurement], ...]
    """Records of that joint alone, each with the record of all joints that it is from."""

    def __call__(self, record: Measurement, length: float | None) -> ForceMap:
        return self._of(self.build(self._whole(record), length))

    def fitted(self, record: Measurement, length: float | None = None) -> ForceMap:
        return self._of(self.build.fitted(self._whole(record), length))

    def with_free_parameters(self, free_parameters: FreeParameters) -> "_ViewBuilder":
        return replace(self, problem=self.problem.with_free_parameters(free_parameters))

    def at(self, values: Array) -> "_ViewBuilder":  # noqa: ARG002  # the mechanism is not fitted
        return self

    def _whole(self, record: Measurement) -> Measurement:
        return next((whole for own, whole in self.records if own is record), record)

    def _of(self, problem: JointBalance) -> ForceMap:
        own = with_own_segments(problem.maps[self.coordinate].stretches)
        return replace(self.problem, stretches=own)


def _best(problem: ForceMap, values: Array) -> ResidualJacobian:
    """Return the residuals of a joint at values (p,); bristles begin where they fit best."""
    near = settled(problem, values)
    return problem.linearise(values, near)


def _inference(fit: RecordFit[Laws], best: ResidualJacobian, at: Sequence[int]) -> Inference:
    """Return the covariance of some parameters (p,), beside all that was fitted with them."""
    every = fit.inference
    block = np.ix_(at, at)
    return replace(
        every,
        covariance=every.covariance[block],
        naive=every.naive[block],
        freedom=every.freedom[at],
        condition=_condition(fit, at),
        effective=effective_size(best),
        reasons=tuple(every.reasons[i] for i in at) if every.reasons else (),
        held={path: moved[:, at] for path, moved in every.held.items()},
    )


def _condition(fit: RecordFit[Laws], at: Sequence[int]) -> float:
    """Return the condition of some parameters, the others fitted with them.

    Slopes by the others are projected out. A column that they explain is then small beside its
    own size, by which all are scaled.
    """
    table = fit.optimum.best.slopes @ fit.scale
    own, others = table[:, list(at)], np.delete(table, list(at), axis=1)
    size = np.linalg.norm(own, axis=0)
    own = own[:, size > 0.0] / size[size > 0.0]
    if not own.shape[1]:
        return 1.0
    if others.shape[1]:
        basis = Directions.of(others).columns
        own = own - basis @ (basis.T @ own)
    singular = np.linalg.svd(own, compute_uv=False)
    return float(singular[0] / max(singular[-1], 1e-300))


def _halves(halves: Halves, at: Sequence[int]) -> Halves:
    first, second = halves.values
    index = list(at)
    return replace(
        halves,
        values=(first[index], second[index]),
        errors=halves.errors[index],
        freedom=halves.freedom[index],
    )
