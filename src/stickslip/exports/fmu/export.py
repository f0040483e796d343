"""Exports a mechanism with its law as an FMU."""

import hashlib
import io
import math
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from stickslip.documents import write_file
from stickslip.drives import Sum
from stickslip.errors import InputError
from stickslip.exports.fmu.binary import FOLDERS, compiled, compiler_here
from stickslip.exports.fmu.description import Fmi, Heading, model_description
from stickslip.exports.fmu.inputs import label_of, told_from_outside, with_inputs
from stickslip.exports.fmu.tables import model_header
from stickslip.exports.fmu.variables import variables_of
from stickslip.exports.identifiers import identifier
from stickslip.formatting import printable
from stickslip.formulation import formulate
from stickslip.friction import Friction, FrictionLaw, Laws, PrintedForm
from stickslip.mechanisms import Mechanism, told_fields
from stickslip.quantities import Quantity
from stickslip.simulation import check_pair, initial_state
from stickslip.solver import EventDriven, gather, object_files, within_stops

EXCHANGE = 1e-9
"""Relative tolerance that is stored for solvers of importers, as CVode does not reach 1e-12 where
stops or links meet bristles. In co-simulation only a finer one counts."""
END = Quantity("t_end", "s", above=0)
MOST_STEPS = 2000
SAMPLES = 400
"""Steps and times of the run that tells how large states are."""
USUAL_BRISTLE = 1e-5
"""Deflection of bristles that never moved [m or rad]: presliding is of micrometres."""
DATE = (1980, 1, 1, 0, 0, 0)
"""Date of all files: the same model gives the same FMU whenever it is made."""


def export_fmu(
    mechanism: Mechanism,
    law: Friction,
    path: str | Path,
    *,
    t_end: float,
    y0: Mapping[str, float] | Sequence[float] | None = None,
    inputs: Sequence[str] = (),
    fmi: Fmi = 3,
    name: str | None = None,
    title: str = "",
    solver: EventDriven | None = None,
    portable: bool = True,
    force: bool = False,
) -> Path:
    r"""Export a mechanism with a friction law as an FMU, for co-simulation and model exchange.

    The FMU needs no Python and runs on Linux. In co-simulation, the event-driven solver is inside.
    Changes of mode are located exactly, however long the communication steps are. Without inputs
    its results are those of `simulate` and do not depend on these steps at all; inputs are held
    over each step. In model exchange, the importer's solver integrates the modes, and the FMU says
    when and how they change.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back, as in `simulate`.
    path : str or Path
        File to write, ``.fmu``.
    t_end : float
        Time at which a simulation ends unless the importer says otherwise [s]. Drives that repeat
        themselves in pieces, such as `Square`, are known up to this time.
    y0 : mapping or sequence, optional
        Initial states, as in `simulate`; the importer can set other ones.
    inputs : sequence of str
        Drives of the mechanism that become inputs, and contact inputs that it was given. The other
        ones run as they are; contact inputs of the law that nothing tells are inputs too.
    fmi : {2, 3}
        Version of the standard, 2.0 or 3.0.
    name : str, optional
        Name of the model; that of the file if not given.
    title : str
        Description of the model; mechanism and law in words if not given.
    solver : EventDriven, optional
        Tolerances of the solver.
    portable : bool
        Whether the FMU runs on all processors of this platform, or else on those like this one.
    force : bool
        Whether a file that exists is replaced.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If an argument cannot be used, this is not Linux on x86-64, or there is no C compiler.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> from stickslip.exports import export_fmu
    >>> block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> export_fmu(block, law, "block.fmu", t_end=1.0)  # doctest: +SKIP
    PosixPath('block.fmu')
    """
    target = Path(path)
    if fmi not in (2, 3):
        raise InputError(f"fmi must be 2 or 3, got {fmi!r}.")
    if target.suffix != ".fmu":
        raise InputError(f"an FMU is a file with the ending .fmu, got {target}.")
    if target.exists() and not force:
        raise InputError(
            f"{target} already exists; give --force (in Python force=True) to replace it."
        )
    compiler_here()
    stop = END.check("export_fmu", "t_end", t_end)
    solver = EventDriven() if solver is None else solver
    mechanism, inputs = told_from_outside(mechanism, law, inputs)
    laws = check_pair(mechanism, law)
    if isinstance(laws, PrintedForm):
        raise InputError(
            f"{type(laws).__name__} has no exact event-driven solution: export the corrected law"
            f" {laws.corrected.__name__}."
        )
    driven, drives = with_inputs(mechanism, inputs)
    labels = {field: label_of(*at) for field, at in told_fields(driven).items()}
    found = {labels.get(name, name): one for name, one in drives.items()}
    start = within_stops(driven, initial_state("export_fmu", driven, laws, y0))
    model = formulate(driven, laws)
    numbers = gather(driven, laws, model, stop)
    nominals = _nominals(driven, laws, solver, start, stop)
    variables = variables_of(driven, laws, model, y0=start, nominals=nominals, inputs=found)
    names = [one.name for one in variables]
    twice = [one for one in found if names.count(one) > 1]
    if twice:
        raise InputError(
            f"the input {twice[0]!r} has the name of another variable: name the drive by its path."
        )
    settings = {
        "DEFAULT_STOP": stop,
        "LAST_TIME": stop if _ends(driven) else math.inf,
        "STEP_CAP": numbers.time_scale / 6.0,
        "TOLERANCE": solver.tolerance_for(laws),
        "STORED_TOLERANCE": EXCHANGE,
    }
    objects = object_files(model, common=portable)
    table = numbers.table.tolist()
    seed = model_header(
        model, variables, table=table, nominals=nominals, settings=settings, token=""
    )
    token = _token(seed, *objects.values(), str(fmi).encode())
    header = model_header(
        model, variables, table=table, nominals=nominals, settings=settings, token=token
    )
    label = name if name is not None else target.stem
    heading = Heading(
        name=printable(label),
        identifier=identifier(label),
        token=token,
        description=printable(title or model.title),
        stop=stop,
        tolerance=EXCHANGE,
    )
    binary = compiled(objects, header, fmi)
    write_file(
        target,
        _zipped(
            {
                "modelDescription.xml": model_description(heading, variables, fmi),
                f"binaries/{FOLDERS[fmi]}/{heading.identifier}.so": binary,
            }
        ),
    )
    return target


def _nominals(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    solver: EventDriven,
    y0: Sequence[float],
    stop: float,
) -> list[float]:
    """Return the size of each state [SI], by which importers scale their absolute tolerances.

    It is the largest in a run, down to a power of ten. A state that does not move in it, because
    an input is to move it, is given one that is usual.
    """
    brief = replace(solver, max_steps=MOST_STEPS, estimate_error=False)
    run = brief.run(mechanism, law, y0=y0, t_end=stop)
    seen = run.at(np.linspace(*run.span, SAMPLES))
    moving = 2 * len(mechanism.coordinates)
    found = []
    for index, state in enumerate(run.states):
        largest = float(np.abs(seen[state]).max(initial=0.0))
        usual = 1.0 if index < moving else USUAL_BRISTLE
        known = math.isfinite(largest) and largest > 0.0
        found.append(10.0 ** math.floor(math.log10(largest)) if known else usual)
    return found


def _ends(mechanism: Mechanism) -> bool:
    """Whether the tables of drives end: a drive repeats itself in pieces."""
    parts = list(mechanism.drives().values())
    while parts:
        drive = parts.pop()
        if isinstance(drive, Sum):
            parts += drive.parts
        elif drive.repeats() is not None and drive.pieces(0.0):
            return True
    return False


def _token(text: str, *contents: bytes) -> str:
    """Return a hash in the form of an identifier that tools know."""
    digest = hashlib.sha256("\n".join([version("stickslip"), text]).encode())
    for content in contents:
        digest.update(content)
    found = digest.hexdigest()
    return (
        "{" + "-".join(found[a:b] for a, b in ((0, 8), (8, 12), (12, 16), (16, 20), (20, 32))) + "}"
    )


def _zipped(contents: Mapping[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            info = zipfile.ZipInfo(name, DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, content)
    return buffer.getvalue()
