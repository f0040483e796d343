"""``python -m benchmarks.posterior [tables|special|records|swings ...] --seed S --count N``."""

from benchmarks.posterior.study import main

main()
