"""One engine for dense records: laws, nuisances and faults are terms of the force balance.

A structure is a set of terms and a bristle shape. Given its nonlinear parameters, the force is
linear in the rest, so that a hypothesis costs one small least-squares problem. A search adds, drops
and swaps terms, and one rule judges every change on held-out blocks.
"""

from stickslip.evidence.balance import Balance, usual_band
from stickslip.evidence.bristles import SIGN, Shape, play
from stickslip.evidence.explanation import Explanation, begin, explain, predict
from stickslip.evidence.faults import Fault
from stickslip.evidence.fits import Fit, acceleration_noise, fit
from stickslip.evidence.intervals import Interval
from stickslip.evidence.motion import LowPass, derivative, low_pass, resolution, unit_differences
from stickslip.evidence.rule import Rule
from stickslip.evidence.series import Series, outliers, pieces
from stickslip.evidence.structure import GEARS, GROWN, LATE_OR_ELASTIC, SHOWN_LATE, Structure, fades
from stickslip.evidence.terms import TERMS, Kind, Term
from stickslip.evidence.values import polished
from stickslip.evidence.vocabulary import vocabulary

__all__ = [
    "GEARS",
    "GROWN",
    "LATE_OR_ELASTIC",
    "SHOWN_LATE",
    "SIGN",
    "TERMS",
    "Balance",
    "Explanation",
    "Fault",
    "Fit",
    "Interval",
    "Kind",
    "LowPass",
    "Rule",
    "Series",
    "Shape",
    "Structure",
    "Term",
    "acceleration_noise",
    "begin",
    "derivative",
    "explain",
    "fades",
    "fit",
    "low_pass",
    "outliers",
    "pieces",
    "play",
    "polished",
    "predict",
    "resolution",
    "unit_differences",
    "usual_band",
    "vocabulary",
]
