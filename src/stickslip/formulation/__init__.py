"""From a law and a mechanism to the text of a self-contained numeric module."""

from stickslip.formulation.model import Model, formulate

__all__ = ["Model", "formulate"]
