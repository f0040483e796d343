"""Kinds of measurement, each from its fit to its page; and the verbs that take any."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
