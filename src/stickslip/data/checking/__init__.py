"""What may be wrong with a record, one family of remarks a module."""
