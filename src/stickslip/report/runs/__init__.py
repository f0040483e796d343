"""The report of a run: what moved, how surely, and how far to trust it."""

from stickslip.report.runs.contacts import ContactsReport, contacts_page
from stickslip.report.runs.page import run_page
from stickslip.report.runs.subject import RunReport

__all__ = ["ContactsReport", "RunReport", "contacts_page", "run_page"]
