"""What the posterior says of truths that are known, and of measured records: its study.

``python -m benchmarks.posterior`` judges made-up tables, measured records and swings; see
`benchmarks.posterior.study`.
"""
