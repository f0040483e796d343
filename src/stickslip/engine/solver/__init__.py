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
    "Progress": "compile.modules",
    "Samples": "reducers",
    "Sensitivity": "reducers",
    "SoftConstraint": "block_diagram",
    "Solver": "run",
    "WarmUp": "compile.modules",
    "prepare": "run",
    "warm_up": "compile.modules",
}

INSIDE = {
    "BareRun": "event_driven",
    "Equations": "backend",
    "Form": "event_driven",
    "IncrementalEnsemble": "incremental",
    "IncrementalRun": "incremental",
    "as_numbers": "ensembles",
    "check_columns": "ensembles",
    "column_units": "run",
    "gather": "starts",
    "notice": "compile.modules",
    "object_files": "compile.modules",
    "observe": "compile.states",
    "path_units": "run",
    "reasons": "reducers",
    "run_ensemble": "ensembles",
    "states_along": "compile.states",
    "status_of": "event_driven",
    "within_stops": "starts",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES, inside=INSIDE)
