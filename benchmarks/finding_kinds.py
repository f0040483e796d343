"""Which kinds of findings name no cause, and which a finding names."""

NEUTRAL = ("law", "unexplained")
"""Kinds of findings that name no cause."""


def parts_of(kind: str) -> set[str]:
    """Return the kinds that a finding names: several, if they are not told apart."""
    return {kind, *kind.split(" or ")}
