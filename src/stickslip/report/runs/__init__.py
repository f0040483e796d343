"""The report of a run: what moved, how surely, and how far to trust it."""

from stickslip.report.runs.page import run_page
from stickslip.report.runs.subject import RunReport

__all__ = ["RunReport", "run_page"]
