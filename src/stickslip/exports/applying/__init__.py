"""Friction written into the model file of another program, which otherwise stays as it is."""
