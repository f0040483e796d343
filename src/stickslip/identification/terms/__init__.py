"""What the evidence engine says of records: their series, laws of its structures, its findings."""
