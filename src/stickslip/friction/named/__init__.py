"""Laws of the literature, each a composition with what its source says of it."""
