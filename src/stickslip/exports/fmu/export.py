"""Exports a mechanism with its law as an FMU."""

import hashlib
import io
import json
import math
import platform
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

import numpy as np

from stickslip.engine.formulation import PAINLEVE, Model, formulate
from stickslip.engine.kernels import exchange, state_layout
from stickslip.engine.kernels import state_layout as enums
from stickslip.engine.kernels.batch import happened
from stickslip.engine.kernels.contacts.motion import first_contact_guard
from stickslip.engine.kernels.equations import CONSTANTS_OF, WALLS_OF
from stickslip.engine.simulation import check_pair, initial_state
from stickslip.engine.solver import (
    EventDriven,
    gather,
    object_files,
    reasons,
    status_of,
    within_stops,
)
from stickslip.engine.trajectory import Status
from stickslip.errors import CompilationError, InputError
from stickslip.exports.fmu import description
from stickslip.exports.program import identifier
from stickslip.friction import Friction, FrictionLaw, Laws, PrintedForm
from stickslip.mechanisms import Mechanism, told_fields
from stickslip.mechanisms.drives import Sum
from stickslip.quantities import Quantity
from stickslip.show.documents import write_file
from stickslip.show.formatting import printable

SLOTS = (
    "ADDRESS", "BOOKS", "CONSTANTS", "DRIFT", "EVENTS", "MODE", "PIECE", "POINT", "REST_IS_FINAL",
    "SAMPLED", "SEVERAL", "STAGES", "STATUS", "STEPS", "TIME", "VALUES", "Y",
)  # fmt: skip
"""Places in the vectors of a run."""
IN_HEADER = ("CONSTANTS", "DRIFT", "POINT", "SAMPLED", "STAGES", "VALUES", "Y")
"""Those that depend on the model."""
SIZES = (
    "SIZE", "N_STATES", "N_GUARDS", "N_COLUMNS", "N_DRIVES", "MOST_EVENTS", "ROW_COLUMNS",
    "WALL_COLUMNS",
)  # fmt: skip
"""Places of sizes in the whole numbers of a run."""
QUESTIONS = (
    "ENTER", "RATES_AT", "GUARDS_AT", "COLUMNS_AT", "FALLEN", "JUMP", "LOOK", "NOTE", "CUT",
    "RETUNE", "SHOWN", "PLACE", "ALONG",
)  # fmt: skip
"""What the kernels are asked in model exchange."""
ENDS = (Status.LIFT_OFF, Status.LIMIT, Status.PAINLEVE)
"""How a run ends by itself, where it goes on no more but did not fail."""
LEAST_TOLERANCE = 1e-13
TOO_MANY = "The step took too many steps of the solver; results so far are kept."


def model_header(
    model: Model,
    variables: Sequence[description.Variable],
    *,
    table: Sequence[float],
    nominals: Sequence[float],
    settings: dict[str, float],
    token: str,
) -> str:
    """Return the header with all numbers of a model."""
    header = model.sizes.header
    roles = [variable.role for variable in variables]
    lines = [f"#define AT_{name} {_slot(name, header)}" for name in SLOTS]
    lines += [f"#define {name} {header[getattr(state_layout, name)]}" for name in SIZES]
    lines += [
        f"#define WHOLES {len(header)}",
        f"#define FIRST_TABLE {state_layout.HEADER}",
        f"#define FIRST_NUMBER {state_layout.NUMBERS}",
        *(
            f"#define FIRST_{role.upper()} {roles.index(role)}"
            for role in ("state", "derivative", "indicator")
        ),
        f"enum question {{ {', '.join(f'{q} = {getattr(exchange, q)}' for q in QUESTIONS)} }};",
        f"#define EVENT_COLUMNS {state_layout.EVENT_COLUMNS}",
        f"#define WALLS_OF {WALLS_OF}",
        f"#define CONSTANTS_OF {CONSTANTS_OF}",
        f"#define STATUS_FULL {enums.FULL}",
        f"#define STATUS_END_TIME {enums.END_TIME}",
        # stops are looked at before the coordinates are turned to those of the equations
        f"#define N_STOPS {0 if header[state_layout.IS_TURNED] else header[state_layout.N_WALLS]}",
        f"#define MOST_STEPS {1_000_000}",
        f"#define LEAST_TOLERANCE {_real(LEAST_TOLERANCE)}",
        *(f"#define {name} {_real(value)}" for name, value in settings.items()),
        f"#define TOKEN {_text(token)}",
        f"#define TABLE_SIZE {len(table)}",
        f"#define N_PIECES {len(table) // (1 + 3 * len(model.drives))}",
        f"#define N_INPUTS {sum(variable.role == 'input' for variable in variables)}",
        f"#define N_VARIABLES {len(variables)}",
        _array("int64_t HEADER_NUMBERS", map(str, header)),
        _array("double TABLE", map(_real, table)),
        _array("double NOMINALS", map(_real, nominals)),
        _array("bool IS_EVENT", _are_events(model)),
        _array("struct variable VARIABLES", map(_row, variables)),
    ]
    endings = list(_endings(model))
    lines += [
        f"#define N_ENDINGS {len(endings)}",
        _array("struct ending ENDINGS", endings),
    ]
    return "\n".join(["/* Numbers of a model, written by a program. */", *lines, ""])


def _slot(name: str, header: Sequence[int]) -> int:
    """Return a place in the vectors of a run; those of model-sized slots stand in the header."""
    place: int = getattr(state_layout, name)
    return place if name not in IN_HEADER else header[place]


def _are_events(model: Model) -> Iterable[str]:
    """Yield whether the fall of each guard is an event: switches without a name are none."""
    names, header = reasons(model), list(model.sizes.header)
    for guard in range(model.sizes.guards):
        if model.contacts and guard < first_contact_guard(header):
            yield "1"
        else:
            row = [0.0, 0.0, 0.0, float(guard), 0.0, 0.0, 0.0]
            yield str(int(names[happened(row, 0, header)] is not None))


def _endings(model: Model) -> Iterable[str]:
    """Yield what follows from each status of a run, and of one step of too many."""
    on = (enums.RUNNING, enums.END_TIME, enums.STEP_LIMIT, enums.FULL)
    for code in range(enums.LIMITED + len(model.limits)):
        if code in on:
            yield '{GOES_ON, ""}'
            continue
        status = status_of(code, model)
        name = "" if code < enums.LIMITED else model.limits[code - enums.LIMITED]
        which = f" ({name})" if name and name != PAINLEVE else ""
        outcome = "HAS_ENDED" if status in ENDS else "HAS_FAILED"
        yield f"{{{outcome}, {_text(status.value + which)}}}"
    yield f"{{HAS_FAILED, {_text(TOO_MANY)}}}"


def _row(variable: description.Variable) -> str:
    quantity = variable.quantity
    is_bound = variable.role == "parameter"
    open_ = is_bound and quantity.above is not None
    low = quantity.above if is_bound and quantity.above is not None else quantity.low
    words = quantity.range if is_bound else "a finite number"
    numbers = (_real(x) for x in (variable.start, low if is_bound else -math.inf))
    high = _real(quantity.high if is_bound else math.inf)
    return (
        f"{{{_text(variable.name)}, {variable.role.upper()}, {int(variable.whole)},"
        f" {int(variable.tunable)}, {variable.index}, {', '.join(numbers)}, {high}, {int(open_)},"
        f" {variable.at_least}, {_text(words)}}}"
    )


def _array(name: str, items: Iterable[str]) -> str:
    rows = ",\n    ".join(items)
    return f"static const {name}[] = {{\n    {rows}\n}};"


def _real(number: float) -> str:
    """Return a number in C without rounding."""
    if math.isinf(number):
        return "HUGE_VAL" if number > 0 else "-HUGE_VAL"
    return float(number).hex()


def _text(words: str) -> str:
    """Return a text in C; letters outside ASCII as bytes of UTF-8."""
    plain = json.dumps(words, ensure_ascii=False)
    # Two quotes end an escape, which C would read on through further hexadecimal digits.
    return "".join(
        c if c.isascii() else '""'.join(f"\\x{b:02x}" for b in c.encode()) + '""' for c in plain
    )


FOLDERS: Mapping[description.Fmi, str] = {2: "linux64", 3: "x86_64-linux"}
"""Folder of the binaries by version of FMI."""
COMPILERS = ("cc", "gcc", "clang")
# Products are not fused into sums, and nothing but the model is in the binary: the same model gives
# the same file.
FLAGS = (
    "-std=c99", "-O1", "-fPIC", "-shared", "-s", "-ffp-contract=off",
    "-Wl,-z,defs", "-Wl,-Bsymbolic", "-Wl,--version-script=exports.map", "-Wl,--build-id=none",
)  # fmt: skip


def compiler_here() -> str:
    """Return the C compiler; refuse early where no binary can be made."""
    if platform.system() != "Linux" or platform.machine() != "x86_64":
        raise InputError(
            f"an FMU is made on Linux on x86-64, and this is {platform.system()} on"
            f" {platform.machine()}: export the rig on such a machine."
        )
    for name in COMPILERS:
        path = shutil.which(name)
        if path is not None:
            return path
    raise InputError(
        "an FMU is linked by the C compiler of the system, and there is none (cc, gcc or clang):"
        " install one, as with `apt install gcc` (it is not needed to run the FMU)."
    )


def compiled(objects: Mapping[str, bytes], header: str, fmi: description.Fmi) -> bytes:
    """Return the binary."""
    compiler = compiler_here()
    sources = files("stickslip.exports.fmu").joinpath("c")
    names = ("instance.h", "exchange.h", "calls.h", f"fmi{fmi}.c")
    texts = {name: sources.joinpath(name).read_bytes() for name in names}
    texts["model.h"] = header.encode()
    texts["exports.map"] = f"{{ global: fmi{fmi}*; local: *; }};\n".encode()
    with tempfile.TemporaryDirectory(prefix="stickslip-fmu-") as name:
        folder = Path(name)
        for file, content in (texts | dict(objects)).items():
            (folder / file).write_bytes(content)
        command = [compiler, *FLAGS, "-o", "fmu.so", f"fmi{fmi}.c", *objects, "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            raise CompilationError(f"{' '.join(command)} failed: {done.stderr.strip()}")
        return (folder / "fmu.so").read_bytes()


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
    fmi: description.Fmi = 3,
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
    mechanism, inputs = description.told_from_outside(mechanism, law, inputs)
    laws = check_pair(mechanism, law)
    if isinstance(laws, PrintedForm):
        raise InputError(
            f"{type(laws).__name__} has no exact event-driven solution: export the corrected law"
            f" {laws.corrected.__name__}."
        )
    driven, drives = description.with_inputs(mechanism, inputs)
    labels = {field: description.label_of(*at) for field, at in told_fields(driven).items()}
    found = {labels.get(name, name): drive for name, drive in drives.items()}
    start = within_stops(driven, initial_state("export_fmu", driven, laws, y0))
    model = formulate(driven, laws)
    numbers = gather(driven, laws, model, stop)
    nominals = _nominals(driven, laws, solver, start, stop)
    variables = description.variables_of(
        driven, laws, model, y0=start, nominals=nominals, inputs=found
    )
    names = [variable.name for variable in variables]
    twice = [key for key in found if names.count(key) > 1]
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
    # The token is a hash of all that the FMU has, itself left out.
    seed = model_header(
        model, variables, table=table, nominals=nominals, settings=settings, token=""
    )
    token = _token(seed, *objects.values(), str(fmi).encode())
    header = model_header(
        model, variables, table=table, nominals=nominals, settings=settings, token=token
    )
    label = name if name is not None else target.stem
    heading = description.Heading(
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
                "modelDescription.xml": description.model_description(heading, variables, fmi),
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
    # A short run: sizes are wanted to a power of ten.
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
