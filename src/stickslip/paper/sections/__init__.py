"""The audit as sections of a page: headings state what was found."""
