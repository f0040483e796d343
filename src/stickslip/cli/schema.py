"""``stickslip schema``."""

from stickslip.cli.output import print_json
from stickslip.experiments import rig_schema

__all__ = ["run"]


def run() -> None:
    """Print the schema of rig files."""
    print_json(rig_schema())
