"""Stated uncertainties of the parameters of a mechanism."""

from collections.abc import Collection, Mapping

from stickslip.data import Measurement, check_uncertainty
from stickslip.errors import InputError, ParameterError
from stickslip.identify.fits.settings import STEP
from stickslip.mechanisms import Mechanism, canonical_path
from stickslip.quantities import Quantity, parameters, vary

LOAD = "mechanism.load"
"""What a measured load takes the place of."""


def refuse_load(paths: Collection[str], measurement: Measurement) -> None:
    """Refuse a stated uncertainty of a load whose value a measured load replaces.

    Examples
    --------
    >>> refuse_load(["mechanism.load"], Measurement(velocity=1.0, friction=2.0))
    """
    if LOAD in paths and "load" in measurement.quantities():
        raise InputError(
            f"the uncertainty of {LOAD} was stated, but the measured load replaces its value:"
            " leave the uncertainty out."
        )


def uncertainties_of(
    mechanism: Mechanism, measurement: Measurement
) -> list[tuple[dict[str, float], dict[str, float]]]:
    """Return standard uncertainties of the mechanism's parameters by path, of each record.

    Those of the record alone come first, then those that all records share: what any record sets
    was set anew for each of them, and what none sets is one number for all.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0)
    >>> trials = [Measurement(travel=s, overrides={"mechanism.compression": s}) for s in (0.1, 0.2)]
    >>> both = Measurement(
    ...     trials=tuple(trials), parameter_uncertainties={"compression": 1e-3, "mass": 0.01}
    ... )
    >>> uncertainties_of(rig, both)[0]
    ({'mechanism.compression': 0.001}, {'mechanism.mass': 0.01})
    """
    records = measurement.records()
    common = _doubts(mechanism, measurement.parameter_uncertainties) if measurement.trials else {}
    anew = {path for record in records for path in record.overrides}
    by_hand = {path: item for path, item in common.items() if path in anew}
    result = []
    for record in records:
        varied = vary(mechanism, "mechanism", record.overrides)
        own = {**by_hand, **_doubts(varied, record.parameter_uncertainties)}
        shared = {path: item for path, item in common.items() if path not in own}
        result.append((own, shared))
    return result


def _doubts(mechanism: Mechanism, given: Mapping[str, float]) -> dict[str, float]:
    """Return uncertainties by full path, of parameters that have a value."""
    known = {path: (quantity, v) for path, quantity, v in parameters(mechanism, "mechanism")}
    result = {canonical_path(mechanism, path): doubt for path, doubt in given.items()}
    for path, doubt in result.items():
        if path not in known:
            raise InputError(
                f"an uncertainty was stated for {path}, but {type(mechanism).__name__} has no"
                " such value."
            )
        quantity, value = known[path]
        try:
            check_uncertainty(doubt, value, quantity)
        except ParameterError as error:
            raise ParameterError(f"parameter_uncertainties: {path} {error}") from None
    return result


def span_of(mechanism: Mechanism, path: str, doubt: float) -> tuple[float, float]:
    """Return the two values of a parameter, inside its range, between which slopes are taken.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> span_of(SpringBlock(mass=2.0), "mechanism.mass", 0.01)
    (1.998, 2.002)
    """
    known: dict[str, tuple[Quantity, float]] = {
        name: (quantity, value) for name, quantity, value in parameters(mechanism, "mechanism")
    }
    quantity, value = known[path]
    step = STEP * (abs(value) or doubt)
    return max(value - step, quantity.low), min(value + step, quantity.high)
