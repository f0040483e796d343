"""The formats of model files by name."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

from stickslip.documents import check_xml, read_bytes
from stickslip.errors import InputError
from stickslip.exports.applying.bam import Bam
from stickslip.exports.applying.markup import root_of
from stickslip.exports.applying.mjcf import Mjcf
from stickslip.exports.applying.models import Model
from stickslip.exports.applying.ros2 import Ros2
from stickslip.exports.applying.urdf import Urdf
from stickslip.exports.applying.usd import Newton, Physx
from stickslip.quantities import named

CONSUMERS: Final[Mapping[str, type[Model]]] = MappingProxyType(
    {one.name: one for one in (Urdf, Mjcf, Physx, Newton, Bam, Ros2)}
)
"""What laws can be applied to."""


XML: Final = (".xml", ".urdf", ".mjcf", ".xacro")
"""Names of files that are XML, or should be."""


def read_model(path: Path, to: str | None = None) -> Model:
    """Read a file in the format that it seems to have, or in a named one."""
    data = read_bytes(path)
    fitting = [one for one in CONSUMERS.values() if one.recognises(path, data)]
    if to is not None:
        wanted: type[Model] = named(CONSUMERS, to, "format")
        if wanted not in fitting:
            raise InputError(f"{path} is no file of {wanted.title}.")
        return wanted(path, data)
    if len(fitting) > 1:
        choices = " or ".join(f"--to {one.name}, {one.title}" for one in fitting)
        raise InputError(f"{path} has room for friction of several programs: choose by {choices}.")
    if not fitting:
        raise _unknown(path, data)
    return fitting[0](path, data)


def _unknown(path: Path, data: bytes) -> InputError:
    if data.startswith((b"PXR-USDC", b"PK")):
        return InputError(f"{path} is binary USD: write it as text first, with usdcat -o new.usda.")
    root = root_of(data)
    if root or path.suffix.lower() in XML:
        check_xml(data, str(path))
        return InputError(
            f"{path} has the root <{root}>; a URDF file has <robot>, an MJCF file <mujoco>."
        )
    known = "; ".join(one.title for one in CONSUMERS.values())
    return InputError(f"{path} is none of the files that friction can be written into: {known}.")
