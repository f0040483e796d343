"""What the page of a selection on travels shows."""
