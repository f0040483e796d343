"""Characteristics of friction laws: what an experiment on the contact alone would record."""

from stickslip.characterization.presliding import PreslidingLoop, presliding_length, presliding_loop

__all__ = ["PreslidingLoop", "presliding_length", "presliding_loop"]
