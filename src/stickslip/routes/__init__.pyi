# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.routes.page import verdict_page as verdict_page
from stickslip.routes.registry import AnyRoute as AnyRoute
from stickslip.routes.registry import refuse_uninformed as refuse_uninformed
from stickslip.routes.registry import refuse_unused as refuse_unused
from stickslip.routes.registry import route_named as route_named
from stickslip.routes.registry import route_of as route_of
from stickslip.routes.registry import routes as routes
from stickslip.routes.registry import unused_text as unused_text
from stickslip.routes.report import DOCUMENT as DOCUMENT
from stickslip.routes.report import PAGE as PAGE
from stickslip.routes.report import VERDICT_FILES as VERDICT_FILES
from stickslip.routes.report import write_report as write_report
from stickslip.routes.report import write_verdict as write_verdict
from stickslip.routes.route import Comparison as Comparison
from stickslip.routes.route import FitRequest as FitRequest
from stickslip.routes.route import FitSummary as FitSummary
from stickslip.routes.route import Law as Law
from stickslip.routes.route import Options as Options
from stickslip.routes.route import Request as Request
from stickslip.routes.route import Route as Route
from stickslip.routes.route import SelectRequest as SelectRequest
from stickslip.routes.verbs import fit as fit
from stickslip.routes.verbs import select as select

__all__ = [
    "AnyRoute",
    "Comparison",
    "FitRequest",
    "FitSummary",
    "Law",
    "Options",
    "Request",
    "Route",
    "SelectRequest",
    "fit",
    "refuse_unused",
    "route_named",
    "route_of",
    "routes",
    "select",
    "verdict_page",
    "write_report",
]
