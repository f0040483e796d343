"""``stickslip schema``."""

from stickslip.cli.console import document, print_json
from stickslip.experiments import rig_schema

__all__ = ["run"]


def run() -> None:
    """Print the schema of rig files, with the head that all documents have."""
    print_json(document("rig-schema", rig_schema()))
