"""Find which slots of a run's vectors each kernel reads and writes: python -m tools.slots.

A slot is a place with a name in `kernels.state_layout`; where those lie whose size depends on the
model, `iw` tells under the same name. A function reads a slot if what is there when it begins
matters, and writes it if something else may be there when it ends: one that is written and not read
is a result, or scratch. What a function calls is followed, so that the lists are what a caller may
rely on. What the equations read in every run, parameters and values of the drives, is left out.
Tests compare the lists with what kernels do at run time.

Followed are statements in their order. A loop is taken to run once or more, and to fill the slot
that it writes to; a single number stands for its slot where the slot has no more.
"""

import ast
from dataclasses import dataclass, field
from functools import cache

from tools import structure

KERNELS = f"{structure.PACKAGE}.engine.kernels"
VECTORS = ("w", "iw")
DRIVES = "drives"
"""Name for the first places, which hold value, slope and start of each drive."""
BEHIND = {"guards_at": "guard slopes", "directions_at": "directions", "columns_at": "columns"}
"""Functions that return places behind SIZE, and the names of what is there."""
CALLS = {
    "call_model": ["w", "place", "name", "mode", "flags", "t", "at", "to"],
    "call_contacts": ["w", "place", "iw", "name", "t", "at", "to"],
}
"""What calls the equations, and what works them out for several contacts, with the arguments."""
LEFT = {"call_contacts": {"ANSWER", "CHANGED"}}
"""What they leave beside their results."""
PYTHON = {"backend", "entries", "state_layout"}
"""Modules that only Python runs, or that differ between the tiers."""
TABLES = (
    "MODES",
    "LAW_FLAGS",
    "OPEN",
    "CANDIDATES",
    "FORCED",
    "BEFORE",
    "CLOSED",
    "ASKED",
    "KEPT",
    "STRUCK",
    "FOLLOWERS",
)
"""Tables in `iw` that change in a run of several contacts; the others are sizes and places."""
ROWS = "LAW_ROWS"
"""Numbers of the laws of several contacts; a table of this name has their places."""

PLACES = {
    "at", "to", "slot", "a", "b", "pivots", "matrix", "columns", "right", "levels",
    "rates", "clamped", "used",
}  # fmt: skip
"""Names of parameters that are places; others are numbers that are added to one."""
MADE_BEFORE = {
    # new state, dense output, Jacobian and df/dt are those of the step that was accepted
    "attempt": {"STAGES", "Y1"},
    "accepted_step": {"MATRIX", "Y1"},
    "probe_sizes": {"Y1"},
    "advance": {"DENSE", "DRIFT", "MATRIX", "SAMPLED"},
    "run": {"DENSE", "FRACTION", "LENGTH", "Y1"},
    "play": {"DENSE"},  # there is no row at first, so that one is restored
    "pass_instant": {"columns 4"},  # moments are there, by the piece or by the first event
}
"""Slots that are written before they are read, where only the logic of a function tells."""

Slots = set[str]


@dataclass
class Effects:
    """What a function does to slots, and to the places that its parameters name, ``<name>``."""

    reads: Slots = field(default_factory=set)
    writes: Slots = field(default_factory=set)
    surely: Slots = field(default_factory=set)
    """Written wherever the function ends."""


def layout() -> dict[str, list[str]]:
    """Return the slots of each vector in their order."""
    tree = ast.parse(structure.sources()[f"{KERNELS}.state_layout"].read_text("utf-8"))
    names = [
        node.targets[0].id
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    ]
    first = names[names.index("TIME") : names.index("NUMBERS")]
    places = names[names.index("GIVEN") : names.index("SIZE") + 1]
    own = names[names.index("SLIP_FACTORS") : names.index("WORKS") + 1]
    own += ["BOX", "CHANGES", "TURN"]
    own += names[names.index("MOTION_POINT") : names.index("BRISTLE_SLOPES") + 1]
    own += names[names.index("LOOPS") : names.index("REACHED_SO_FAR") + 1]
    int_vectors = names[names.index("MODE") : names.index("WHOLES")]
    return {"w": [*first, DRIVES, *places, ROWS, *own], "iw": [*int_vectors, *TABLES]}


class Bare(ast.NodeTransformer):
    """Writes names of other modules without the module: `layout.TIME` as `TIME`."""

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        return node if ast.unparse(node.value) == "math" else ast.Name(node.attr, node.ctx)


class Kernel:
    """One function of the kernels, with what its names may stand for."""

    def __init__(self, node: ast.FunctionDef, slots: dict[str, list[str]]) -> None:
        self.node = node
        self.parameters = [arg.arg for arg in node.args.args]
        self.slots = slots
        self.known: dict[str, Slots] = {
            arg.arg: {f"<{arg.arg}>"}
            for arg in node.args.args
            if arg.annotation is not None and ast.unparse(arg.annotation) == "int"
        }
        while self._learn():
            pass

    def _learn(self) -> bool:
        before = sum(map(len, self.known.values()))
        for node in ast.walk(self.node):
            if isinstance(node, ast.Assign):
                for target in node.targets:
                    self._bind(target, node.value)
            elif isinstance(node, ast.For):
                self.known.setdefault(ast.unparse(node.target), set()).update(
                    self._ranged(node.iter)
                )
        return sum(map(len, self.known.values())) > before

    def _bind(self, target: ast.expr, value: ast.expr) -> None:
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            for elt, other in zip(target.elts, value.elts, strict=True):
                self._bind(elt, other)
        elif isinstance(target, ast.Name):
            self.known.setdefault(target.id, set()).update(self.places(value))

    def _ranged(self, node: ast.expr) -> Slots:
        """Return where the places of a loop lie: from one slot up to another, or beside one."""
        order = self.slots["w"]
        ends = [self.places(item) for item in getattr(node, "args", ())]
        if ends and all(len(end) == 1 and end <= {*order} for end in ends):
            first, last = (order.index(*end) for end in (ends[0], ends[-1]))
            return set(order[:last] if len(ends) == 1 else order[first:last])
        return ends[0] if len(ends) > 1 else set()

    def places(self, node: ast.expr) -> Slots:
        """Return the slots that an expression for a place may mean, `<name>` for a parameter."""
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            if name not in BEHIND:
                return set()
            which = f" {ast.unparse(node.args[0])}" if name == "columns_at" else ""
            return {BEHIND[name] + which}
        if isinstance(node, ast.Subscript):
            name, inner = ast.unparse(node.slice), self.places(node.slice)
            if ast.unparse(node.value) != "iw":
                return set()
            return {name} & {*self.slots["w"], *TABLES} or inner & {ROWS}
        if isinstance(node, ast.Name):
            if node.id in self.slots["w"]:
                return {node.id}
            if node.id == "NUMBERS":
                return {DRIVES}
            return self.known.get(node.id, set())
        inner = [
            iter_child_node
            for iter_child_node in ast.iter_child_nodes(node)
            if isinstance(iter_child_node, ast.expr)
        ]
        if isinstance(node, ast.IfExp):
            inner = [node.body, node.orelse]
        return set().union(*map(self.places, inner))


@cache
def kernels() -> dict[str, Kernel]:
    """Return the functions of the kernels by name."""
    slots = layout()
    return {
        node.name: Kernel(node, slots)
        for module, path in structure.sources().items()
        if module.startswith(f"{KERNELS}.") and module.rpartition(".")[2] not in PYTHON
        for node in Bare().visit(ast.parse(path.read_text("utf-8"))).body
        if isinstance(node, ast.FunctionDef)
    }


@cache
def effects(name: str) -> Effects:
    """Return what a kernel reads and writes, with what it calls."""
    if name in CALLS:
        left = {"<to>"} | LEFT.get(name, set())
        return Effects({"<at>"}, left, left)
    result = Walk(kernels()[name]).effects
    result.reads -= MADE_BEFORE.get(name, set())
    return result


class Walk:
    """Goes through the statements of a kernel in their order."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self.effects = Effects()
        self._ends: list[Slots] = []
        self._loops: list[str] = []
        self._fresh: Slots = set()
        last = self._block(kernel.node.body, set())
        ends = [*self._ends, *([] if last is None else [last])]
        self.effects.surely = set.intersection(*ends) if ends else set()

    def _block(self, body: list[ast.stmt], written: Slots) -> Slots | None:
        """Return what is written for sure behind some statements, None if none is reached."""
        for node in body:
            after = self._statement(node, written)
            if after is None:
                return None
            written = after
        return written

    def _statement(self, node: ast.stmt, written: Slots) -> Slots | None:
        if isinstance(node, ast.If):
            written = self._read(node.test, written)
            ways = [self._block(body, {*written}) for body in (node.body, node.orelse)]
            open_ways = [way for way in ways if way is not None]
            return set.intersection(*open_ways) if open_ways else None
        if isinstance(node, ast.For):
            return self._loop(node, self._read(node.iter, written))
        if isinstance(node, ast.While):
            written = self._read(node.test, written)
            self._loops.append("")
            self._block(node.body, {*written})
            self._loops.pop()
            return written
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.expr) and not isinstance(child.__dict__.get("ctx"), ast.Store):
                written = self._read(child, written)
        if isinstance(node, ast.Assign | ast.AugAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            for target in targets:
                written = self._store(target, written, isinstance(node, ast.AugAssign))
        if isinstance(node, ast.Return):
            self._ends.append(written)
        return None if isinstance(node, ast.Return | ast.Break | ast.Continue) else written

    def _loop(self, node: ast.For, written: Slots) -> Slots:
        """Go through a loop twice: what ends before its own variable is empty at first."""
        until = [ast.unparse(item) for item in getattr(node.iter, "args", [])]
        if len(until) == 1 and until[0] in self._fresh:
            return written
        variable = ast.unparse(node.target)
        self._loops.append(variable)
        self._fresh.add(variable)
        once = self._block(node.body, {*written})
        self._fresh.remove(variable)
        if once is not None:
            self._block(node.body, {*once})
        self._loops.pop()
        return written if once is None else once

    def _slots(self, node: ast.expr) -> Slots:
        """Return the slots that an expression with an index means; none if of another vector."""
        if not isinstance(node, ast.Subscript) or ast.unparse(node.value) not in VECTORS:
            return set()
        if ast.unparse(node.value) == "w":
            return self.kernel.places(node.slice) or {DRIVES}
        name, state = ast.unparse(node.slice), {*self.kernel.slots["iw"]} - {*TABLES}
        inner = self.kernel.places(node.slice) & {*TABLES}
        if not isinstance(node.slice, ast.Name) or inner:
            return inner
        return state if name.islower() else {name} & state  # sizes and places are no slots

    def _store(self, target: ast.expr, written: Slots, adds: bool) -> Slots:
        slots = self._slots(target)
        self.effects.writes |= slots
        if adds:
            self.effects.reads |= slots - written
        everywhere = bool(self._loops) or (slots <= single() and len(slots) == 1)
        return written | slots if everywhere else written

    def _read(self, node: ast.expr, written: Slots) -> Slots:
        """Note what an expression reads, and what the functions do that it calls."""
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.expr):
                written = self._read(child, written)
        self.effects.reads |= self._slots(node) - written
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            name = node.func.id
            if name in kernels() or name in CALLS:
                theirs = effects(name)
                self.effects.reads |= self._passed(theirs.reads, name, node.args) - written
                self.effects.writes |= self._passed(theirs.writes, name, node.args)
                written = written | self._passed(theirs.surely, name, node.args)
        return written

    def _passed(self, slots: Slots, name: str, arguments: list[ast.expr]) -> Slots:
        """Return what slots and parameters of a called function are here."""
        names = CALLS[name] if name in CALLS else kernels()[name].parameters
        result: Slots = set()
        for slot in slots:
            if slot.startswith("<"):
                result |= self.kernel.places(arguments[names.index(slot[1:-1])])
            else:
                result.add(slot)
        return result


@cache
def single() -> Slots:
    """Return the slots of one number."""
    order = layout()
    return {*order["iw"], *order["w"][: order["w"].index("POLYNOMIAL")]}


def shown(slots: Slots, kernel: Kernel) -> str:
    """Return slots in the order of the layout, what is behind them, and places of parameters."""
    order = [*kernel.slots["w"], *kernel.slots["iw"]]
    behind = sorted(slot for slot in slots if slot not in order and not slot.startswith("<"))
    places = [
        parameter
        for parameter in kernel.parameters
        if f"<{parameter}>" in slots and parameter in PLACES
    ]
    return ", ".join(
        [*(f"`{place}`" for place in places), *(o for o in order if o in slots), *behind]
    )


def lines(name: str) -> list[str]:
    """Return the lists of a kernel in words."""
    kernel, result = kernels()[name], effects(name)
    told = (shown(result.reads, kernel), shown(result.writes, kernel))
    return [f"{w}: {text}." for w, text in zip(("Reads", "Writes"), told, strict=True) if text]


if __name__ == "__main__":
    for name in kernels():
        print(name, *lines(name), sep="\n    ")
