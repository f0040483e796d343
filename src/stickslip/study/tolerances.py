"""Tolerances that several studies share."""

ROUNDING = 1e-9
"""Share that rounding makes of a force, a limit, a period or a state."""
TRANSIENT = 1e-6
"""Share that is left of a transient after many cycles."""
ALIKE = 0.001
"""Share within which motions, forces and energies count as the same."""
PERCENT = 0.01
"""Share that counts as a difference, and least share of draws in valid ranges."""
FINE = 4001
"""Even times at which a run is looked at, beside the ends of its steps."""
FEWEST_CYCLES = 3
"""Cycles that tell whether they are alike."""
MOST_STEPS = 100_000
"""Steps, or times of all cycles together, of one run."""
