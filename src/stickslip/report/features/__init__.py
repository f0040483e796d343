"""The report of a selection on features of stick-slip: a verdict as a page."""

from stickslip.report.features.page import feature_document, feature_page

__all__ = ["feature_document", "feature_page"]
