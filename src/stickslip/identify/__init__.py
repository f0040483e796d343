"""The judge: which friction law, and what friction is over all candidate laws."""

from stickslip.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__)
