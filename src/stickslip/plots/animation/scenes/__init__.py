"""What mechanisms look like: shapes in metres, and where they are at a moment of a run."""

from stickslip.plots.animation.scenes.mechanisms import SCENES
from stickslip.plots.animation.scenes.registry import scene_of
from stickslip.plots.animation.scenes.shapes import (
    Arrow,
    Ball,
    Box,
    Coil,
    Ground,
    Moment,
    Picture,
    Rod,
    Scene,
    Shape,
    Turn,
    Wall,
    Word,
)

__all__ = [
    "SCENES",
    "Arrow",
    "Ball",
    "Box",
    "Coil",
    "Ground",
    "Moment",
    "Picture",
    "Rod",
    "Scene",
    "Shape",
    "Turn",
    "Wall",
    "Word",
    "scene_of",
]
