"""Other libraries of Python: environments of Gymnasium, systems of python-control, SciPy's ODEs."""

from stickslip.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__)
