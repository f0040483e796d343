# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
# ruff: noqa: I001, RUF022
from stickslip.plots.animation import animate as animate
from stickslip.plots.animation import draw_scene as draw_scene
from stickslip.plots.compare import draw_travels as draw_travels
from stickslip.plots.cycles import draw_cycles as draw_cycles
from stickslip.plots.embedding import animation_html as animation_html
from stickslip.plots.excitations import draw_excitations as draw_excitations
from stickslip.plots.friction_map import draw_friction_map as draw_friction_map
from stickslip.plots.laws import draw_characteristics as draw_characteristics
from stickslip.plots.laws import draw_presliding as draw_presliding
from stickslip.plots.loop import draw_closed_loop as draw_closed_loop
from stickslip.plots.loops import draw_loops as draw_loops
from stickslip.plots.maps import draw_basins as draw_basins
from stickslip.plots.maps import draw_bifurcation as draw_bifurcation
from stickslip.plots.maps import draw_velocity_map as draw_velocity_map
from stickslip.plots.motion import draw_motion as draw_motion
from stickslip.plots.overview import draw_overview as draw_overview
from stickslip.plots.overview import overview_size as overview_size
from stickslip.plots.pieces import draw_pieces as draw_pieces
from stickslip.plots.profiles import draw_profile as draw_profile
from stickslip.plots.record import draw_record as draw_record
from stickslip.plots.residuals import draw_prediction_error as draw_prediction_error
from stickslip.plots.residuals import draw_residuals as draw_residuals
from stickslip.plots.run import draw_friction_velocity as draw_friction_velocity
from stickslip.plots.run import draw_run as draw_run
from stickslip.plots.run import draw_runs as draw_runs
from stickslip.plots.separation import draw_separation as draw_separation
from stickslip.plots.sketches import draw_sketch as draw_sketch
from stickslip.plots.steps import draw_fixed_steps as draw_fixed_steps
from stickslip.plots.svg import Draw as Draw
from stickslip.plots.svg import NARROW as NARROW
from stickslip.plots.svg import Size as Size
from stickslip.plots.svg import WIDE as WIDE
from stickslip.plots.svg import inline_svg as inline_svg
from stickslip.plots.svg import save as save
from stickslip.plots.svg import standalone_svg as standalone_svg
from stickslip.plots.theme import C1 as C1
from stickslip.plots.theme import C2 as C2
from stickslip.plots.theme import C3 as C3
from stickslip.plots.theme import C4 as C4
from stickslip.plots.theme import DATA as DATA
from stickslip.plots.theme import INK as INK
from stickslip.plots.theme import LINE as LINE
from stickslip.plots.theme import MUTED as MUTED
from stickslip.plots.theme import SLIP_BACK as SLIP_BACK
from stickslip.plots.theme import STICK as STICK
from stickslip.plots.theme import SURFACE as SURFACE
from stickslip.plots.theme import VARIABLES as VARIABLES
from stickslip.plots.theme import label_at as label_at
from stickslip.plots.theme import label_column as label_column
from stickslip.plots.theme import shade as shade
from stickslip.plots.theme import spread as spread
from stickslip.plots.trials import draw_trials as draw_trials

__all__ = [
    "C1",
    "C2",
    "C3",
    "C4",
    "DATA",
    "Draw",
    "INK",
    "LINE",
    "MUTED",
    "NARROW",
    "SLIP_BACK",
    "STICK",
    "SURFACE",
    "Size",
    "VARIABLES",
    "WIDE",
    "animate",
    "animation_html",
    "draw_basins",
    "draw_bifurcation",
    "draw_characteristics",
    "draw_closed_loop",
    "draw_cycles",
    "draw_excitations",
    "draw_fixed_steps",
    "draw_friction_map",
    "draw_friction_velocity",
    "draw_loops",
    "draw_motion",
    "draw_overview",
    "draw_pieces",
    "draw_prediction_error",
    "draw_presliding",
    "draw_profile",
    "draw_record",
    "draw_residuals",
    "draw_run",
    "draw_runs",
    "draw_scene",
    "draw_separation",
    "draw_sketch",
    "draw_travels",
    "draw_trials",
    "draw_velocity_map",
    "inline_svg",
    "label_at",
    "label_column",
    "overview_size",
    "save",
    "shade",
    "spread",
    "standalone_svg",
]
