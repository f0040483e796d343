"""Files of measurements, as tables of SI numbers."""
