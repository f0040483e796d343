"""Routes: each kind of measurement, from its fit to its page; and the verbs that take any."""

from stickslip.lazy import attach

HOMES = {
    "AnyRoute": "registry",
    "Comparison": "route",
    "FitRequest": "route",
    "FitSummary": "route",
    "Law": "route",
    "Options": "route",
    "Request": "route",
    "Route": "route",
    "SelectRequest": "route",
    "fit": "verbs",
    "refuse_unused": "registry",
    "route_named": "registry",
    "route_of": "registry",
    "routes": "registry",
    "select": "verbs",
    "verdict_page": "page",
    "write_report": "report",
}

INSIDE = {
    "DOCUMENT": "report",
    "PAGE": "report",
    "VERDICT_FILES": "report",
    "refuse_uninformed": "registry",
    "unused_text": "registry",
    "write_verdict": "report",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES | INSIDE)
