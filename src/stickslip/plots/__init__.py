"""Figures: the only room that knows matplotlib, which is loaded when a name is first asked for."""

import importlib
from typing import Any

_HOME = {
    "C1": "theme",
    "C2": "theme",
    "C3": "theme",
    "C4": "theme",
    "DATA": "theme",
    "Draw": "svg",
    "INK": "theme",
    "LINE": "theme",
    "MUTED": "theme",
    "NARROW": "svg",
    "SLIP_BACK": "theme",
    "STICK": "theme",
    "SURFACE": "theme",
    "Size": "svg",
    "VARIABLES": "theme",
    "WIDE": "svg",
    "animate": "animation",
    "animation_html": "embedding",
    "draw_basins": "maps",
    "draw_bifurcation": "maps",
    "draw_characteristics": "laws",
    "draw_cycles": "cycles",
    "draw_closed_loop": "loop",
    "draw_excitations": "excitations",
    "draw_fixed_steps": "steps",
    "draw_friction_velocity": "run",
    "draw_friction_map": "friction_map",
    "draw_loops": "loops",
    "draw_motion": "motion",
    "draw_overview": "overview",
    "draw_pieces": "pieces",
    "draw_prediction_error": "residuals",
    "draw_presliding": "laws",
    "draw_profile": "profiles",
    "draw_record": "record",
    "draw_residuals": "residuals",
    "draw_run": "run",
    "draw_runs": "run",
    "draw_scene": "animation",
    "draw_separation": "separation",
    "draw_sketch": "sketches",
    "draw_travels": "compare",
    "draw_trials": "trials",
    "draw_velocity_map": "maps",
    "inline_svg": "svg",
    "label_at": "theme",
    "label_column": "theme",
    "overview_size": "overview",
    "save": "svg",
    "shade": "theme",
    "spread": "theme",
    "standalone_svg": "svg",
}

__all__ = sorted(_HOME)  # noqa: PLE0605  # read off the table above


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'stickslip.plots' has no attribute {name!r}")
    return getattr(importlib.import_module(f"stickslip.plots.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return __all__
