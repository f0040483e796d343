# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.data import catalogue as catalogue
from stickslip.data.checking.data_quality import CURE as CURE
from stickslip.data.checking.data_quality import Checks as Checks
from stickslip.data.checking.data_quality import MainsLine as MainsLine
from stickslip.data.checking.data_quality import check as check
from stickslip.data.checking.data_quality import findings_text as findings_text
from stickslip.data.checking.data_quality import is_narrow as is_narrow
from stickslip.data.checking.data_quality import lines_of as lines_of
from stickslip.data.checking.data_quality import refusal as refusal
from stickslip.data.checking.data_quality import refuse_faults as refuse_faults
from stickslip.data.checking.data_quality import refuse_lack as refuse_lack
from stickslip.data.checking.data_quality import refuse_same as refuse_same
from stickslip.data.checking.data_quality import refuse_unused as refuse_unused
from stickslip.data.checking.data_quality import resting_readings as resting_readings
from stickslip.data.checking.data_quality import volts_sentence as volts_sentence
from stickslip.data.checking.data_quality import with_doubts as with_doubts
from stickslip.data.checking.data_quality import with_order as with_order
from stickslip.data.checking.data_quality import words_of as words_of
from stickslip.data.checking.finding import Finding as Finding
from stickslip.data.checking.finding import SEVERITIES as SEVERITIES
from stickslip.data.checking.finding import grouped as grouped
from stickslip.data.checking.finding import sentences_of as sentences_of
from stickslip.data.checking.motion import inertia_of as inertia_of
from stickslip.data.checking.motion import swing_of as swing_of
from stickslip.data.differentiation import as_readings as as_readings
from stickslip.data.differentiation import between_gaps as between_gaps
from stickslip.data.differentiation import interval_of as interval_of
from stickslip.data.differentiation import noise_of as noise_of
from stickslip.data.differentiation import step_of as step_of
from stickslip.data.differentiation import usual_top_speed as usual_top_speed
from stickslip.data.differentiation import velocity_of as velocity_of
from stickslip.data.differentiation import without_outliers as without_outliers
from stickslip.data.estimates import HARD as HARD
from stickslip.data.estimates import LOAD as LOAD
from stickslip.data.estimates import LawEstimates as LawEstimates
from stickslip.data.estimates import equated as equated
from stickslip.data.estimates import spread_of as spread_of
from stickslip.data.estimates import unit_on as unit_on
from stickslip.data.measurement import Levels as Levels
from stickslip.data.measurement import Line as Line
from stickslip.data.measurement import Measurement as Measurement
from stickslip.data.measurement import QUANTITIES as QUANTITIES
from stickslip.data.measurement import as_turning as as_turning
from stickslip.data.measurement import levels_at as levels_at
from stickslip.data.measurement import tells_load as tells_load
from stickslip.data.measurement import unit_of_input as unit_of_input
from stickslip.data.readers.columns import Column as Column
from stickslip.data.readers.columns import Reading as Reading
from stickslip.data.readers.columns import column_of as column_of
from stickslip.data.readers.columns import motor_constants as motor_constants
from stickslip.data.readers.columns import spelled as spelled
from stickslip.data.readers.guess import Guess as Guess
from stickslip.data.readers.guess import guess_data as guess_data
from stickslip.data.readers.layout import Layout as Layout
from stickslip.data.readers.layout import regular_times as regular_times
from stickslip.data.readers.robot_guess import guess_robot as guess_robot
from stickslip.data.readers.table_reader import data_file as data_file
from stickslip.data.readers.table_reader import is_data_file as is_data_file
from stickslip.data.readers.table_reader import log_files as log_files
from stickslip.data.readers.toml import parse as parse
from stickslip.data.readers.toml import read_bytes as read_bytes
from stickslip.data.records import UNIT_LOAD as UNIT_LOAD
from stickslip.data.records import load_measurement as load_measurement
from stickslip.data.records import read_data as read_data
from stickslip.data.rig import CarriedLaw as CarriedLaw
from stickslip.data.rig import KnownLaws as KnownLaws
from stickslip.data.rig import LoopSamples as LoopSamples
from stickslip.data.rig import Published as Published
from stickslip.data.rig import Rig as Rig
from stickslip.data.rig import as_recorded as as_recorded
from stickslip.data.rig import as_tolerance as as_tolerance
from stickslip.data.rig import bristle_remark as bristle_remark
from stickslip.data.rig import carried as carried
from stickslip.data.rig import carried_by_contact as carried_by_contact
from stickslip.data.rig import command_of as command_of
from stickslip.data.rig import estimates_by_contact as estimates_by_contact
from stickslip.data.rig import extrapolations as extrapolations
from stickslip.data.rig import loop_samples as loop_samples
from stickslip.data.rig import unfitted_bristles as unfitted_bristles
from stickslip.data.rig import with_voltage as with_voltage
from stickslip.data.rigs.guessed_rig import filmed_rig as filmed_rig
from stickslip.data.rigs.guessed_rig import guess_films as guess_films
from stickslip.data.rigs.guessed_rig import guessed_rig as guessed_rig
from stickslip.data.rigs.rig_builder import load_rig as load_rig
from stickslip.data.rigs.rig_builder import rig_schema as rig_schema
from stickslip.data.rigs.rig_writer import rig_toml as rig_toml
from stickslip.data.tolerances import GAP as GAP
from stickslip.data.travels import is_filmed as is_filmed
from stickslip.data.travels import scale_of as scale_of
from stickslip.data.travels import settled_speed as settled_speed
from stickslip.data.travels import travels_of_films as travels_of_films
from stickslip.data.travels import whole_cycles as whole_cycles
from stickslip.data.units import check_uncertainty as check_uncertainty
from stickslip.data.units import gain_factor as gain_factor
from stickslip.data.units import read_gain as read_gain
from stickslip.data.units import read_number as read_number

__all__ = [
    "CarriedLaw",
    "Checks",
    "Finding",
    "Guess",
    "KnownLaws",
    "LawEstimates",
    "Layout",
    "Line",
    "Measurement",
    "Published",
    "QUANTITIES",
    "Rig",
    "bristle_remark",
    "carried",
    "carried_by_contact",
    "catalogue",
    "check",
    "extrapolations",
    "guess_data",
    "guess_robot",
    "guessed_rig",
    "load_measurement",
    "load_rig",
    "rig_schema",
    "settled_speed",
    "travels_of_films",
    "unfitted_bristles",
]
