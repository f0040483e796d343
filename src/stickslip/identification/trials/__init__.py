"""Whether several trials share one law."""
