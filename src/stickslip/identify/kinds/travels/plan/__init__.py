"""Plans of travels: what to measure, as a sheet, tables and a page."""
