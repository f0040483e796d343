"""Importing this module tells Gymnasium the environments.

``make("stickslip.exports.gym:...")`` imports it. That is work at import, which no other module
does: Gymnasium knows no other way to find them.
"""

from stickslip.exports.adapters import register_environments

register_environments()
