"""Routes: each kind of measurement, from its fit to its page; and the verbs that take any."""

from stickslip.routes.page import verdict_page
from stickslip.routes.registry import AnyRoute, refuse_unused, route_named, route_of, routes
from stickslip.routes.report import write_report
from stickslip.routes.route import (
    Comparison,
    FitRequest,
    FitSummary,
    Law,
    Options,
    Request,
    Route,
    SelectRequest,
)
from stickslip.routes.verbs import fit, select

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
