"""Solvers: the event-driven one, and the fixed step of a block diagram."""

from stickslip.lazy import attach

HOMES = {
    "BreakAway": "block_diagram",
    "EventCount": "reducers",
    "EventDriven": "event_driven",
    "EventTimes": "reducers",
    "Final": "reducers",
    "FixedStep": "fixed_step",
    "Max": "reducers",
    "Mean": "reducers",
    "Method": "fixed_step",
    "Min": "reducers",
    "Output": "reducers",
    "Progress": "compile.precompile",
    "Samples": "reducers",
    "Sensitivity": "reducers",
    "SoftConstraint": "block_diagram",
    "Solver": "base",
    "WarmUp": "compile.precompile",
    "prepare": "run",
    "warm_up": "compile.precompile",
}

INSIDE = {
    "BareRun": "event_driven",
    "Equations": "evaluator",
    "IncrementalEnsemble": "incremental_ensemble",
    "IncrementalRun": "incremental_run",
    "as_numbers": "ensembles",
    "check_columns": "ensembles",
    "column_units": "base",
    "gather": "drive_schedule",
    "notice": "compile.modules",
    "object_files": "compile.modules",
    "observe": "compile.observer_code",
    "path_units": "base",
    "reasons": "reducers",
    "run_ensemble": "ensembles",
    "states_along": "compile.states_code",
    "status_of": "event_driven",
    "within_stops": "initial_states",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
