"""The friction benchmark: laws and peers fitted to public records, judged on what was not seen.

A `Task` says which part of a record is fitted, which part judges, and by what. `run` gives a task
to stickslip and to its peers.
"""
