# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.identify.fits.contact_inputs import VARIES as VARIES
from stickslip.identify.fits.contact_inputs import as_informed as as_informed
from stickslip.identify.fits.contact_inputs import as_loaded as as_loaded
from stickslip.identify.fits.contact_inputs import check_inputs as check_inputs
from stickslip.identify.fits.contact_inputs import check_loads as check_loads
from stickslip.identify.fits.contact_inputs import inputs_along as inputs_along
from stickslip.identify.fits.contact_inputs import inputs_text as inputs_text
from stickslip.identify.fits.contact_inputs import joint_inputs as joint_inputs
from stickslip.identify.fits.contact_inputs import known_inputs as known_inputs
from stickslip.identify.fits.contact_inputs import load_along as load_along
from stickslip.identify.fits.contact_inputs import load_of as load_of
from stickslip.identify.fits.contact_inputs import measured_loads as measured_loads
from stickslip.identify.fits.contact_inputs import recorded_inputs as recorded_inputs
from stickslip.identify.fits.contact_inputs import refuse_other_loads as refuse_other_loads
from stickslip.identify.fits.contact_inputs import typical_inputs as typical_inputs
from stickslip.identify.fits.contact_inputs import unvaried as unvaried
from stickslip.identify.fits.contact_inputs import with_inputs as with_inputs
from stickslip.identify.fits.gears import gear_torques as gear_torques
from stickslip.identify.fits.gears import transmitted_along as transmitted_along
from stickslip.identify.fits.levenberg_marquardt import FIRST_DAMPING as FIRST_DAMPING
from stickslip.identify.fits.levenberg_marquardt import ResidualJacobian as ResidualJacobian
from stickslip.identify.fits.levenberg_marquardt import improve as improve
from stickslip.identify.fits.motions import HARMONICS as HARMONICS
from stickslip.identify.fits.motions import HIGHEST as HIGHEST
from stickslip.identify.fits.motions import mean_frequency as mean_frequency
from stickslip.identify.fits.motions import play as play
from stickslip.identify.fits.motions import positive_noise as positive_noise
from stickslip.identify.fits.motions import reach_of as reach_of
from stickslip.identify.fits.motions import smoothed as smoothed
from stickslip.identify.fits.parameters import FreeParameter as FreeParameter
from stickslip.identify.fits.parameters import FreeParameters as FreeParameters
from stickslip.identify.fits.parameters import MOVED as MOVED
from stickslip.identify.fits.parameters import OFFSET as OFFSET
from stickslip.identify.fits.parameters import Range as Range
from stickslip.identify.fits.parameters import WIDE as WIDE
from stickslip.identify.fits.parameters import as_level as as_level
from stickslip.identify.fits.parameters import refuse_open as refuse_open
from stickslip.identify.fits.parameters import required_of as required_of
from stickslip.identify.fits.parameters import starting_law as starting_law
from stickslip.identify.fits.parameters import unit_of as unit_of
from stickslip.identify.fits.parameters import with_arrays as with_arrays
from stickslip.identify.fits.parameters import with_known as with_known
from stickslip.identify.fits.parameters import with_ranges as with_ranges
from stickslip.identify.fits.record_forces import applied_force as applied_force
from stickslip.identify.fits.record_forces import drives_itself as drives_itself
from stickslip.identify.fits.record_forces import goes_straight as goes_straight
from stickslip.identify.fits.record_forces import inside as inside
from stickslip.identify.fits.record_forces import known_forces as known_forces
from stickslip.identify.fits.record_forces import positions_of as positions_of
from stickslip.identify.fits.results import AnyLaw_co as AnyLaw_co
from stickslip.identify.fits.results import Estimate as Estimate
from stickslip.identify.fits.results import FORCES as FORCES
from stickslip.identify.fits.results import Fit as Fit
from stickslip.identify.fits.results import READINGS as READINGS
from stickslip.identify.fits.results import estimates_for as estimates_for
from stickslip.identify.fits.results import far_above_dry as far_above_dry
from stickslip.identify.fits.rig_uncertainties import refuse_load as refuse_load
from stickslip.identify.fits.rig_uncertainties import span_of as span_of
from stickslip.identify.fits.rig_uncertainties import uncertainties_of as uncertainties_of
from stickslip.identify.fits.settings import BLOCKS as BLOCKS
from stickslip.identify.fits.settings import CHANCE as CHANCE
from stickslip.identify.fits.settings import Hold as Hold
from stickslip.identify.fits.settings import MOST as MOST
from stickslip.identify.fits.settings import ROUNDING as ROUNDING
from stickslip.identify.fits.settings import ROUNDS as ROUNDS
from stickslip.identify.fits.settings import RecordSettings as RecordSettings
from stickslip.identify.fits.settings import SETTLED as SETTLED
from stickslip.identify.fits.settings import SURE as SURE
from stickslip.identify.fits.settings import TAKES_PART as TAKES_PART
from stickslip.identify.fits.shooting.multiple_shooting import DELAY as DELAY
from stickslip.identify.fits.shooting.multiple_shooting import Shooting as Shooting
from stickslip.identify.fits.shooting.segments import measured_quantity as measured_quantity
from stickslip.identify.fits.shooting.segments import segments_of as segments_of
from stickslip.identify.fits.travel_model import TravelModel as TravelModel
from stickslip.identify.fits.travel_model import Trial as Trial
from stickslip.identify.fits.travel_model import durations as durations
from stickslip.identify.fits.travel_model import is_rig as is_rig
from stickslip.identify.fits.travel_model import last_digit as last_digit
from stickslip.identify.fits.travel_model import quantities_read as quantities_read
from stickslip.identify.fits.travel_model import standard_errors as standard_errors
from stickslip.identify.fits.travel_model import trials_of as trials_of
from stickslip.identify.fits.travel_model import under_cycles as under_cycles
from stickslip.identify.fits.validation import AnyLaw as AnyLaw
from stickslip.identify.fits.validation import LAW as LAW
from stickslip.identify.fits.validation import Laws as Laws
from stickslip.identify.fits.validation import Parameters as Parameters
from stickslip.identify.fits.validation import called as called
from stickslip.identify.fits.validation import check_given as check_given
from stickslip.identify.fits.validation import check_varied as check_varied
from stickslip.identify.fits.validation import covers as covers
from stickslip.identify.fits.validation import fixed_values as fixed_values
from stickslip.identify.fits.validation import law_quantities as law_quantities
from stickslip.identify.fits.validation import names_of as names_of
from stickslip.identify.fits.validation import refuse_of_laws as refuse_of_laws
from stickslip.identify.fits.validation import varied_paths as varied_paths

__all__ = [
    "DELAY",
    "Estimate",
    "Fit",
    "RecordSettings",
    "drives_itself",
    "durations",
    "starting_law",
]
