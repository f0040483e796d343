"""The numbers of a model as tables in C, from which the binary of an FMU is compiled."""

import json
import math
from collections.abc import Iterable, Sequence

from stickslip.exports.fmu.variables import Variable
from stickslip.formulation import PAINLEVE, Model
from stickslip.kernels import enums, exchange, state_layout
from stickslip.kernels.contacts.guards import first_contact_guard
from stickslip.kernels.equations import CONSTANTS_OF, WALLS_OF
from stickslip.kernels.reducers import happened
from stickslip.solver import reasons, status_of
from stickslip.trajectory import Status

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
ENDS = (Status.LIFT_OFF, Status.LIMIT, Status.PAINLEVE, Status.HELD)
"""How a run ends by itself, where it goes on no more but did not fail."""
LEAST_TOLERANCE = 1e-13
TOO_MANY = "The step took too many steps of the solver; results so far are kept."


def model_header(
    model: Model,
    variables: Sequence[Variable],
    *,
    table: Sequence[float],
    nominals: Sequence[float],
    settings: dict[str, float],
    token: str,
) -> str:
    """Return the header with all numbers of a model."""
    header = model.sizes.header
    roles = [one.role for one in variables]
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
        f"#define N_INPUTS {sum(one.role == 'input' for one in variables)}",
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


def _row(variable: Variable) -> str:
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
    return "".join(
        c if c.isascii() else '""'.join(f"\\x{b:02x}" for b in c.encode()) + '""' for c in plain
    )
