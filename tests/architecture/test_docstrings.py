"""What the check of docstrings finds, and that the lists of `tools.slots` are what kernels do."""

import ast
import inspect
import sys
import textwrap
from collections.abc import Callable, Sequence
from typing import Any

import pytest
from tools import docstrings, slots

from stickslip import BlockChain, Coulomb, EventDriven, LuGre, SpringBlock, Stribeck, simulate
from stickslip.engine.formulation import formulate
from stickslip.engine.kernels import entries, state_layout
from stickslip.engine.simulation import check_pair
from stickslip.mechanisms.drives import Pulse

GOOD = '''
def height(along: float, off: float) -> float:
    """Return a height.

    Parameters
    ----------
    along : float
        Place along the ground [m].
    off : float
        Distance from it [m].

    Returns
    -------
    float
        Height [m].

    Raises
    ------
    ValueError
        If it is negative.
    """
    if along < 0.0:
        raise ValueError
    return along + off


class Point:
    """A point."""

    x: float
    """Place [m]."""
'''


def faults(source: str) -> list[str]:
    return [fault for _, _, fault in docstrings.faults(ast.parse(source))]


def test_complete_docstrings_have_no_fault() -> None:
    assert faults(GOOD) == []


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("along : float", "across : float", "instead of along, off"),
        ("def height(along", "def height(far: int, along", "instead of far, along, off"),
        ("    off : float\n        Distance from it [m].\n", "", "instead of along, off"),
        ("off : float\n", "off\n", "no type or no word of off"),
        ("        Distance from it [m].\n", "", "no type or no word of off"),
        ("Parameters\n    ----------", "Takes\n    -----", "no section Parameters"),
        ("Returns\n    -------\n    float\n        Height [m].", "", "no section Returns"),
        ("ValueError\n        If it", "KeyError\n        If it", "no ValueError in"),
        ('\n    """Place [m]."""', "", "no word on x"),
    ],
)
def test_a_gap_in_a_docstring_is_a_fault(old: str, new: str, fault: str) -> None:
    changed = GOOD.replace(old, new, 1)
    assert changed != GOOD
    assert any(fault in found for found in faults(changed)), faults(changed)


@pytest.mark.parametrize(
    ("mark", "is_exempt"),
    [
        ("@app.command()", True),
        ('@data.command("show")', True),
        ('@command(app, "show")', True),
        ("@app.callback()", False),
        ("@command", False),
        ("@final", False),
    ],
)
def test_only_commands_have_their_help_for_a_docstring(mark: str, is_exempt: bool) -> None:
    source = f"""
    {mark}
    def show(name: str, as_json: bool = False) -> None:
        '''Show a record.'''
    """
    expected = [] if is_exempt else ["no section Parameters (name, as_json)"]
    assert faults(textwrap.dedent(source)) == expected


@pytest.mark.parametrize(
    ("value", "is_told"),
    [('Field(description="Place [m].")', True), ("Field(default=0.0)", False), ("0.0", False)],
)
def test_a_description_tells_a_field(value: str, is_told: bool) -> None:
    source = f"""
    class Point(Table):
        '''A point.'''

        x: float = {value}
    """
    assert faults(textwrap.dedent(source)) == ([] if is_told else ["no word on x"])


def test_private_functions_overrides_and_single_arguments_need_no_sections() -> None:
    source = """
    def _inner(a: int, b: int) -> int:
        return a + b

    def one(a: int) -> int:
        '''Return it.'''
        return a

    class Kind(Base):
        '''A kind.'''

        @override
        def add(self, a: int, b: int) -> int:
            return a + b
    """
    assert faults(textwrap.dedent(source)) == []


@pytest.mark.parametrize(
    ("name", "is_told"), [("columns", True), ("reduce_all", False), ("_inner", True)]
)
def test_a_public_method_has_a_docstring_on_its_class_or_on_a_base(
    name: str, is_told: bool
) -> None:
    (node,) = ast.parse(f"class Final(Reducer):\n    def {name}(self): ...").body
    assert isinstance(node, ast.ClassDef)
    silent = [*docstrings.silent_methods(node, "stickslip.engine.solver.reducers")]
    assert silent == ([] if is_told else [(2, f"Final.{name}")])


def test_sections_of_a_function_that_no_page_shows_are_a_fault() -> None:
    tree = ast.parse(GOOD)
    found = [fault for _, _, fault in docstrings.faults(tree, "stickslip.nowhere")]
    assert found == [
        f"section {name}, but no page shows it" for name in ("Parameters", "Raises", "Returns")
    ]


class Watched(list[float]):
    """A vector that tells the kernel at work which of its places are read and written."""

    frames: list["Frame"]

    def __getitem__(self, place: Any) -> Any:
        if self.frames:
            self.frames[-1].read({(self.name, place)})
        return super().__getitem__(place)

    def __setitem__(self, place: Any, value: Any) -> None:
        if self.frames:
            self.frames[-1].written.add((self.name, place))
        super().__setitem__(place, value)

    def __init__(self, name: str, values: Sequence[float], frames: list["Frame"]) -> None:
        super().__init__(values)
        self.name, self.frames = name, frames


class Frame:
    """What one call has read, of what it did not write itself before, and written."""

    def __init__(self, *, apart: bool) -> None:
        self.apart = apart  # of the equations of several contacts
        self.reads: set[tuple[str, int]] = set()
        self.written: set[tuple[str, int]] = set()
        self.made: set[tuple[str, int]] = set()  # by what is called by its address

    def read(self, places: set[tuple[str, int]]) -> None:
        self.reads |= places - self.written - self.made

    def called(self, other: "Frame") -> None:
        """Take over what a call has done, of one by its address only that it is done."""
        if self.apart or not other.apart:
            self.read(other.reads)
            self.written |= other.written
            self.made |= other.made
        else:
            self.made |= other.written | other.made


class Watch:
    """Runs the plain kernels for one model and collects which slots each of them touched."""

    def __init__(self, header: Sequence[int], monkeypatch: pytest.MonkeyPatch) -> None:
        self.frames: list[Frame] = []
        self.reads: dict[str, set[str]] = {}
        self.writes: dict[str, set[str]] = {}
        self.places: dict[tuple[str, str], set[str]] = {}
        order = slots.layout()
        first = order["w"].index(slots.DRIVES)
        places = {name: getattr(state_layout, name) for name in order["w"] if name != slots.DRIVES}
        self.starts = [(places[name], name) for name in order["w"][:first]]
        self.starts += [(state_layout.NUMBERS, slots.DRIVES)]
        # rows of laws stand before the states; what one contact has no room for is at 0
        behind = [name for name in order["w"][first + 1 :] if name != slots.ROWS]
        found = [(header[places[name]], name) for name in behind if header[places[name]]]
        self.starts += sorted(found, key=lambda one: (one[0], one[1] == "SIZE"))
        self.room = range(state_layout.NUMBERS, header[state_layout.Y])
        state = [name for name in order["iw"] if name not in slots.TABLES]
        self.wholes = {getattr(state_layout, name): name for name in state}
        contacts = header[state_layout.N_CONTACTS]
        for name in slots.TABLES if contacts else ():
            coordinates = header[state_layout.N_COORDINATES]
            many = name in ("LAW_FLAGS", "OPEN", "CLOSED", "ASKED")
            length = contacts if many else coordinates
            if name == "FOLLOWERS":
                length = header[state_layout.N_DIRECTIONS] - coordinates
            table = header[getattr(state_layout, name)]
            self.wholes |= dict.fromkeys(range(table, table + length), name)
        modules = [m for name, m in sys.modules.items() if name.startswith(f"{slots.KERNELS}.")]
        for name in slots.kernels():
            for module in modules:
                if inspect.isfunction(getattr(module, name, None)):
                    monkeypatch.setattr(module, name, self._wrapped(name, getattr(module, name)))
        for entry in ("run", "sense"):
            own = self._wrapped(entry, getattr(entries, f"enter_{entry}"))
            monkeypatch.setattr(
                entries, f"enter_{entry}", self._entered(own, slots.kernels()[entry])
            )

    def _entered(self, function: Any, kernel: slots.Kernel) -> Callable[..., Any]:
        def entered(*arguments: Any) -> Any:
            given = dict(zip(kernel.parameters, arguments, strict=True))
            vectors = {n: Watched(n, given[n], self.frames) for n in slots.VECTORS if n in given}
            answer = function(*(given | vectors).values())
            for name, vector in vectors.items():
                given[name][:] = vector
            return answer

        return entered

    def _wrapped(self, name: str, function: Any) -> Callable[..., Any]:
        apart = function.__module__.startswith(f"{slots.KERNELS}.contacts.")

        def wrapped(*arguments: Any) -> Any:
            self.frames.append(Frame(apart=apart))
            answer = function(*arguments)
            frame = self.frames.pop()
            if self.frames:
                self.frames[-1].called(frame)
            self.reads.setdefault(name, set()).update(map(self.slot, frame.reads))
            self.writes.setdefault(name, set()).update(map(self.slot, frame.written))
            kernel = slots.kernels()[name]
            given = dict(zip(kernel.parameters, arguments, strict=True))
            for one in slots.PLACES & given.keys():
                self.places.setdefault((name, one), set()).add(self.slot(("w", given[one])))
            return answer

        return wrapped

    def slot(self, place: tuple[str, int]) -> str:
        """Return the name of a place; what equations read of every run has none of its own."""
        vector, index = place
        if vector == "iw":
            return self.wholes.get(index, slots.DRIVES)  # sizes and places are no slots
        if index in self.room:
            return slots.DRIVES
        return [name for at, name in self.starts if at <= index][-1]  # slots before it may be empty

    def told(self, name: str, found: set[str]) -> set[str]:
        """Return the slots of a list, places behind SIZE as one, and those of parameters."""
        answer = {slots.DRIVES, "ADDRESS", "SEVERAL", *slots.LEFT["call_contacts"]}
        known = {name for _, name in self.starts} | set(self.wholes.values())
        for text in found:
            if text.startswith("<"):
                answer |= self.places.get((name, text[1:-1]), set())
            else:
                answer.add(text if text in known else "SIZE")
        return answer


BLOCK = {"mass": 1.0, "stiffness": 100.0, "drive": Pulse(level=10.0, duration=0.1)}
RUNS = {
    "linear": (SpringBlock(**BLOCK), Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)),
    "stops": (
        SpringBlock(**BLOCK, upper_stop=0.03, restitution=0.5),
        Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35),
    ),
    "smooth": (
        SpringBlock(**BLOCK),
        Stribeck(kinetic_coefficient=0.2, static_coefficient=0.4, stribeck_velocity=0.05),
    ),
    "stiff": (
        SpringBlock(**BLOCK),
        LuGre(
            kinetic_coefficient=0.2,
            static_coefficient=0.3,
            stribeck_velocity=0.01,
            bristle_stiffness=1e3,
            bristle_damping=10.0,
        ),
        {"x": 0.02},
        0.3,
    ),
    "several contacts": (
        BlockChain(blocks=2, mass=1.0, coupling=5.0, stiffness=2.0),
        {
            "block-1": Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35),
            "block-2": Stribeck(
                kinetic_coefficient=0.2, static_coefficient=0.4, stribeck_velocity=0.05
            ),
        },
        {"x1": 0.25, "v1": 0.02},
        0.05,
    ),
}


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.slow] * ("contacts" in kind)) for kind in RUNS]
)
def test_kernels_touch_no_slot_but_those_that_they_list(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    block, law, y0, t_end = RUNS[kind] if len(RUNS[kind]) == 4 else (*RUNS[kind], {"x": 0.02}, 0.6)
    several = kind == "several contacts"  # whose slopes stand where they do in no other run
    header = formulate(block, check_pair(block, law), slopes=several).sizes.header
    watch = Watch(header, monkeypatch)
    run = simulate(block, law, t_end=t_end, y0=y0, solver=EventDriven(tier="python"))
    run.sensitivity(run.states[0], "mass")
    for name in watch.reads:
        listed = slots.effects(name)
        assert watch.reads[name] <= watch.told(name, listed.reads), f"{name} reads"
        assert watch.writes[name] <= watch.told(name, listed.writes), f"{name} writes"
    own = "decide" if several else "handle_event"
    assert {"run", "advance", "finish_step", "sense", own} <= watch.reads.keys()
