"""Rig files: TOML to objects, and back."""
