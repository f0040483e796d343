"""A rig with its law as a functional mock-up unit, FMI 2.0 or 3.0, with the solver inside."""
