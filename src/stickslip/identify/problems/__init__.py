"""What belongs to one kind of measurement each."""
