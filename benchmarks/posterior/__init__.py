"""What the posterior says of truths that are known and of measured records, beside what is asked.

``python -m benchmarks posterior`` prints all of it; see `benchmarks.posterior.numbers`.
"""
