# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.identify.ensemble import PredictionBand as PredictionBand
from stickslip.identify.joints import JointVerdict as JointVerdict
from stickslip.identify.joints import joint_sections as joint_sections
from stickslip.identify.joints import select_joints as select_joints
from stickslip.identify.judge import Interval as Interval
from stickslip.identify.page import verdict_sections as verdict_sections
from stickslip.identify.selection import select_record as select_record
from stickslip.identify.selection import select_table as select_table
from stickslip.identify.verdict import BandVerdict as BandVerdict
from stickslip.identify.verdict import LawCandidate as LawCandidate
from stickslip.identify.verdict import LawFit as LawFit

__all__ = [
    "BandVerdict",
    "Interval",
    "JointVerdict",
    "LawCandidate",
    "LawFit",
    "PredictionBand",
]
