"""Truths that bands are judged by: made by closed forms and integrators of their own."""
