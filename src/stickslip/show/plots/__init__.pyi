# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.show.plots.animations import animate as animate
from stickslip.show.plots.animations import animation_html as animation_html
from stickslip.show.plots.animations import draw_scene as draw_scene
from stickslip.show.plots.animations import frame_rate as frame_rate
from stickslip.show.plots.animations import frame_times as frame_times
from stickslip.show.plots.axes import Sizes as Sizes
from stickslip.show.plots.axes import horizon as horizon
from stickslip.show.plots.axes import on_axes as on_axes
from stickslip.show.plots.dispatch import PLOTS as PLOTS
from stickslip.show.plots.dispatch import plot as plot
from stickslip.show.plots.dispatch import thumbnail as thumbnail
from stickslip.show.plots.fits import INTERVAL_SIZE as INTERVAL_SIZE
from stickslip.show.plots.fits import Interval as Interval
from stickslip.show.plots.fits import Piece as Piece
from stickslip.show.plots.fits import draw_intervals as draw_intervals
from stickslip.show.plots.fits import draw_pieces as draw_pieces
from stickslip.show.plots.fits import piece_sizes as piece_sizes
from stickslip.show.plots.fits import plot_fit as plot_fit
from stickslip.show.plots.fits import plot_joints as plot_joints
from stickslip.show.plots.fits import plot_scores as plot_scores
from stickslip.show.plots.fits import plot_verdict as plot_verdict
from stickslip.show.plots.laws import MAP_SIZES as MAP_SIZES
from stickslip.show.plots.laws import characteristic_sizes as characteristic_sizes
from stickslip.show.plots.laws import draw_characteristics as draw_characteristics
from stickslip.show.plots.laws import draw_friction_map as draw_friction_map
from stickslip.show.plots.laws import draw_presliding as draw_presliding
from stickslip.show.plots.laws import draw_stribeck as draw_stribeck
from stickslip.show.plots.laws import plot_law as plot_law
from stickslip.show.plots.laws import plot_presliding as plot_presliding
from stickslip.show.plots.laws import presliding_sizes as presliding_sizes
from stickslip.show.plots.measurements import draw_overview as draw_overview
from stickslip.show.plots.measurements import draw_sketch as draw_sketch
from stickslip.show.plots.measurements import overview_size as overview_size
from stickslip.show.plots.measurements import plot_measurement as plot_measurement
from stickslip.show.plots.measurements import schematic as schematic
from stickslip.show.plots.measurements import sketch as sketch
from stickslip.show.plots.runs import FORCE_SIZES as FORCE_SIZES
from stickslip.show.plots.runs import FRICTION_SIZES as FRICTION_SIZES
from stickslip.show.plots.runs import MOST_PANELS as MOST_PANELS
from stickslip.show.plots.runs import MotionView as MotionView
from stickslip.show.plots.runs import RUN_SIZES as RUN_SIZES
from stickslip.show.plots.runs import STATE_SIZES as STATE_SIZES
from stickslip.show.plots.runs import contact_sizes as contact_sizes
from stickslip.show.plots.runs import draw_closed_loop as draw_closed_loop
from stickslip.show.plots.runs import draw_contacts as draw_contacts
from stickslip.show.plots.runs import draw_friction_velocity as draw_friction_velocity
from stickslip.show.plots.runs import draw_motion as draw_motion
from stickslip.show.plots.runs import draw_run as draw_run
from stickslip.show.plots.runs import draw_runs as draw_runs
from stickslip.show.plots.runs import draw_states as draw_states
from stickslip.show.plots.runs import plot_closed_loop as plot_closed_loop
from stickslip.show.plots.runs import plot_friction_velocity as plot_friction_velocity
from stickslip.show.plots.runs import plot_run as plot_run
from stickslip.show.plots.runs import plot_runs as plot_runs
from stickslip.show.plots.studies import CYCLE_SIZES as CYCLE_SIZES
from stickslip.show.plots.studies import EXCITATION_SIZES as EXCITATION_SIZES
from stickslip.show.plots.studies import draw_cycles as draw_cycles
from stickslip.show.plots.studies import draw_excitations as draw_excitations
from stickslip.show.plots.studies import draw_fixed_steps as draw_fixed_steps
from stickslip.show.plots.studies import draw_optimum as draw_optimum
from stickslip.show.plots.studies import plot_band as plot_band
from stickslip.show.plots.studies import plot_ensemble as plot_ensemble
from stickslip.show.plots.studies import plot_limit_cycle as plot_limit_cycle
from stickslip.show.plots.studies import plot_optimum as plot_optimum
from stickslip.show.plots.svg import Draw as Draw
from stickslip.show.plots.svg import NARROW as NARROW
from stickslip.show.plots.svg import Size as Size
from stickslip.show.plots.svg import WIDE as WIDE
from stickslip.show.plots.svg import inline_svg as inline_svg
from stickslip.show.plots.svg import save as save
from stickslip.show.plots.svg import standalone_svg as standalone_svg
from stickslip.show.plots.sweep_maps import draw_basins as draw_basins
from stickslip.show.plots.sweep_maps import draw_orbit_chart as draw_orbit_chart
from stickslip.show.plots.sweep_maps import draw_orbits as draw_orbits
from stickslip.show.plots.sweep_maps import draw_sensitivity as draw_sensitivity
from stickslip.show.plots.sweep_maps import draw_velocity_band as draw_velocity_band
from stickslip.show.plots.sweep_maps import draw_velocity_map as draw_velocity_map
from stickslip.show.plots.sweep_maps import plot_sweep as plot_sweep
from stickslip.show.plots.sweep_maps import plot_velocity_band as plot_velocity_band
from stickslip.show.plots.theme import C1 as C1
from stickslip.show.plots.theme import C2 as C2
from stickslip.show.plots.theme import C3 as C3
from stickslip.show.plots.theme import C4 as C4
from stickslip.show.plots.theme import DATA as DATA
from stickslip.show.plots.theme import INK as INK
from stickslip.show.plots.theme import LINE as LINE
from stickslip.show.plots.theme import MUTED as MUTED
from stickslip.show.plots.theme import SLIP_BACK as SLIP_BACK
from stickslip.show.plots.theme import STICK as STICK
from stickslip.show.plots.theme import SURFACE as SURFACE
from stickslip.show.plots.theme import VARIABLES as VARIABLES
from stickslip.show.plots.theme import label_at as label_at
from stickslip.show.plots.theme import label_column as label_column
from stickslip.show.plots.theme import shade as shade
from stickslip.show.plots.theme import spread as spread
from stickslip.show.plots.theme import symbol_label as symbol_label

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
    "MotionView",
    "NARROW",
    "PLOTS",
    "SLIP_BACK",
    "STICK",
    "SURFACE",
    "Size",
    "VARIABLES",
    "WIDE",
    "animate",
    "animation_html",
    "draw_basins",
    "draw_characteristics",
    "draw_closed_loop",
    "draw_cycles",
    "draw_excitations",
    "draw_fixed_steps",
    "draw_friction_map",
    "draw_friction_velocity",
    "draw_motion",
    "draw_orbit_chart",
    "draw_orbits",
    "draw_overview",
    "draw_pieces",
    "draw_presliding",
    "draw_optimum",
    "draw_run",
    "draw_runs",
    "draw_scene",
    "draw_sensitivity",
    "draw_sketch",
    "draw_velocity_band",
    "draw_velocity_map",
    "inline_svg",
    "label_at",
    "label_column",
    "overview_size",
    "plot",
    "plot_band",
    "plot_closed_loop",
    "plot_ensemble",
    "plot_fit",
    "plot_friction_velocity",
    "plot_joints",
    "plot_law",
    "plot_limit_cycle",
    "plot_measurement",
    "plot_presliding",
    "plot_optimum",
    "plot_run",
    "plot_runs",
    "plot_sweep",
    "plot_velocity_band",
    "plot_verdict",
    "save",
    "shade",
    "spread",
    "standalone_svg",
    "thumbnail",
]
