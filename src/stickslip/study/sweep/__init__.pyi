# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.mechanisms import cycle_of as cycle_of
from stickslip.study.energy import EnergyBalance as EnergyBalance
from stickslip.study.energy import energy_balance as energy_balance
from stickslip.study.energy import units_of_columns as units_of_columns
from stickslip.study.sweep.attractors import Attractor as Attractor
from stickslip.study.sweep.attractors import Basins as Basins
from stickslip.study.sweep.attractors import DrivenCycle as DrivenCycle
from stickslip.study.sweep.attractors import basins as basins
from stickslip.study.sweep.attractors import cycles_in as cycles_in
from stickslip.study.sweep.bands import Band as Band
from stickslip.study.sweep.bands import Spread as Spread
from stickslip.study.sweep.bands import band_of as band_of
from stickslip.study.sweep.campaigns import Campaign as Campaign
from stickslip.study.sweep.campaigns import CampaignRuns as CampaignRuns
from stickslip.study.sweep.campaigns import Case as Case
from stickslip.study.sweep.campaigns import Estimate as Estimate
from stickslip.study.sweep.campaigns import campaign as campaign
from stickslip.study.sweep.continuation import Branch as Branch
from stickslip.study.sweep.continuation import BranchEvent as BranchEvent
from stickslip.study.sweep.continuation import continue_orbit as continue_orbit
from stickslip.study.sweep.design import Design as Design
from stickslip.study.sweep.design import Factor as Factor
from stickslip.study.sweep.design import Levels as Levels
from stickslip.study.sweep.design import Normal as Normal
from stickslip.study.sweep.design import SensitivityIndices as SensitivityIndices
from stickslip.study.sweep.design import Uniform as Uniform
from stickslip.study.sweep.event_curves import CodimensionTwo as CodimensionTwo
from stickslip.study.sweep.event_curves import EventCurve as EventCurve
from stickslip.study.sweep.event_curves import continue_event as continue_event
from stickslip.study.sweep.lyapunov import LyapunovExponents as LyapunovExponents
from stickslip.study.sweep.lyapunov import lyapunov_exponents as lyapunov_exponents
from stickslip.study.sweep.mean_velocity import VelocityBand as VelocityBand
from stickslip.study.sweep.mean_velocity import VelocityMap as VelocityMap
from stickslip.study.sweep.mean_velocity import average_velocity as average_velocity
from stickslip.study.sweep.mean_velocity import velocity_band as velocity_band
from stickslip.study.sweep.orbit_charts import OrbitChart as OrbitChart
from stickslip.study.sweep.orbit_charts import orbit_chart as orbit_chart
from stickslip.study.sweep.orbit_diagrams import OrbitDiagram as OrbitDiagram
from stickslip.study.sweep.orbit_diagrams import orbit_diagram as orbit_diagram
from stickslip.study.sweep.orbits import CYCLE as CYCLE
from stickslip.study.sweep.orbits import Orbit as Orbit
from stickslip.study.sweep.orbits import periodic_orbit as periodic_orbit
from stickslip.study.sweep.sections import Section as Section

__all__ = [
    "Section",
    "CodimensionTwo",
    "EventCurve",
    "OrbitChart",
    "continue_event",
    "orbit_chart",
    "Attractor",
    "Band",
    "Basins",
    "Branch",
    "BranchEvent",
    "Campaign",
    "CampaignRuns",
    "Case",
    "Design",
    "DrivenCycle",
    "EnergyBalance",
    "Estimate",
    "Factor",
    "Levels",
    "LyapunovExponents",
    "Normal",
    "Orbit",
    "OrbitDiagram",
    "SensitivityIndices",
    "Spread",
    "Uniform",
    "VelocityBand",
    "VelocityMap",
    "average_velocity",
    "band_of",
    "basins",
    "campaign",
    "continue_orbit",
    "cycle_of",
    "cycles_in",
    "energy_balance",
    "lyapunov_exponents",
    "orbit_diagram",
    "periodic_orbit",
    "units_of_columns",
    "velocity_band",
]
