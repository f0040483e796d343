"""Rate-and-state friction from velocity steps."""
