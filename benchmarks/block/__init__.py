"""One block, pushed and then held, in each engine."""
