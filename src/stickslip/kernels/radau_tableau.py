"""Radau IIA with five stages: order nine, for equations that are linear and may be stiff.

Collocation at the roots of the fourth derivative of x^4 (x - 1)^5 (Hairer and Wanner, Solving
Ordinary Differential Equations II, section IV.5), computed with 50 digits.
"""

__all__ = ["RADAU", "RADAU_NODES", "RADAU_STAGES"]

RADAU_STAGES = 5
RADAU_NODES = (
    0.05710419611451768,
    0.2768430136381238,
    0.5835904323689168,
    0.8602401356562195,
    1.0,
)
RADAU = (
    0.07299886431790333,
    -0.02673533110794557,
    0.018676929763984353,
    -0.01287910609330644,
    0.005042839233882015,
    0.15377523147918246,
    0.14621486784749352,
    -0.03644456890512809,
    0.02123306311930472,
    -0.007935579902728777,
    0.14006304568480987,
    0.29896712949128346,
    0.16758507013524895,
    -0.03396910168661774,
    0.010944288744192253,
    0.14489430810953477,
    0.2765000687601592,
    0.32579792291042103,
    0.12875675325490976,
    -0.015708917378805327,
    0.14371356079122594,
    0.28135601514946207,
    0.31182652297574126,
    0.22310390108357075,
    0.04,
)
"""The matrix of the method, rows one after the other; the last row holds the weights."""
