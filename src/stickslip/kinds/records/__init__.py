"""Records in time, and measured friction: each law along the records."""
