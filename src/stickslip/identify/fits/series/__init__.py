"""What is computed from records in time before any fit."""
