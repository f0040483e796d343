"""Several contacts at once, in each engine: blocks that come to rest, an arm, clutches."""
