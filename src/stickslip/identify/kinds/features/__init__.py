"""The force of a spring that pulls a block, compared by features of stick-slip."""
