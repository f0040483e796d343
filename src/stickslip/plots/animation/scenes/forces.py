"""What scenes share: the forces on a body that stands on the ground."""

from typing import Final

from stickslip.plots.animation.scenes.shapes import Arrow, Moment, Shape

TALL: Final = 0.6
"""Height of a block over its length."""


def standing_forces(
    now: Moment, x: float, width: float, *, normal: bool, contact: str = ""
) -> list[Shape]:
    """Return friction and normal force where a body stands on the ground at y = 0."""
    of = f":{contact}" if contact else ""
    friction, load = now.get(f"friction{of}", 0.0), now.get(f"normal_force{of}", 0.0)
    found: list[Shape] = [Arrow(at=(x, 0.0), along=(-1.0, 0.0), value=friction, role="friction")]
    if normal:
        foot = (x + 0.25 * width, 0.0)
        found.append(Arrow(at=foot, along=(0.0, 1.0), value=load, role="normal"))
    return found
