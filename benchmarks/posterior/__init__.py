"""One posterior for tables, records and free motions: a model of the judge to come, and its study.

``python -m benchmarks.posterior`` judges made-up tables, measured records and swings by it; see
`benchmarks.posterior.study`. `stickslip select` does not use it yet. A measurement is a law plus
what it does not know (`nodes`), with what every experiment may have (`table_model`,
`record_model`); `judgement` reads names, bands, parameters and odds from its draws, and
`refinement` states free motions after runs.
"""
