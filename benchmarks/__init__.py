"""How fast and how right: each case against SciPy with the modes and events coded by hand."""
