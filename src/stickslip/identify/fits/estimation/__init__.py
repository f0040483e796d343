"""Parameters, least squares, and how surely the estimates are known."""
