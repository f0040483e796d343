"""Machine code of a model's equations: made by LLVM in a tenth of a second, and kept in a file.

Numba, which takes a second or more for each model, is not asked: here everything is known to be a
real number or a place (`translation`). LLVM gets the settings that numba gives it, so that results
are the same.

Code that is loaded stays until the process ends, since vectors of runs hold its address.
"""

import functools
import itertools
import threading
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any, final

from stickslip.errors import CompilationError
from stickslip.formulation import Model
from stickslip.solver.compile import translation
from stickslip.solver.compile.codegen import numbered
from stickslip.solver.compile.module_cache import (
    has_image,
    image_of,
    keep_image,
    name_of,
    processor,
)

__all__ = ["EquationsCode", "code_of"]

_LOCK = threading.RLock()
_loaded: dict["EquationsCode", tuple[int, Any]] = {}
"""Addresses of equations, and what keeps them in memory."""
_numbers = itertools.count()
"""What is put into memory needs names that were never used."""


@final
@dataclass(frozen=True)
class EquationsCode:
    """Machine code of the equations of a mechanism with a law, whatever their parameters."""

    title: str = field(compare=False)
    """Mechanism and law in words."""
    text: str
    """Program text of the functions."""
    numbers: tuple[tuple[str, int], ...]
    """Names of the functions that are called, and their numbers."""

    @property
    def name(self) -> str:
        """Name of its file, which depends on all that decides what is in it but the processor."""
        return name_of("\n".join([_maker(), repr(self.numbers), self.text]))

    def is_ready(self) -> bool:
        """Whether it is in this process."""
        return self in _loaded

    def is_kept(self) -> bool:
        """Whether there is a file of it for this kind of processor."""
        return has_image(self.name)

    @property
    def address(self) -> int:
        """Address of a C function of (number, mode, flags, t, w, at, to), once it is ready."""
        return _loaded[self][0]

    def load(self) -> bool:
        """Load it, or compile it and keep it; return whether it was compiled.

        Two processes that do so at once both compile: to wait for each other would take as long.
        """
        with _LOCK:
            if self.is_ready() and self.is_kept():
                return False
            image = image_of(self.name)
            compiled = image is None
            if image is None:
                image = _compiled(translation.translated(self.text, dict(self.numbers)))
                keep_image(self.name, image)
            if not self.is_ready():
                _loaded[self] = _linked(self.name, image)
            return compiled


@functools.lru_cache(maxsize=256)
def code_of(model: Model) -> EquationsCode:
    """Return the machine code of a model's equations, which may have yet to be made."""
    return EquationsCode(model.title, model.text, tuple(numbered(model).items()))


@functools.cache
def _maker() -> str:
    """Return what decides, beside the text, which machine code comes of it."""
    sources = [Path(path).read_text("utf-8") for path in (__file__, translation.__file__)]
    return name_of("\n".join([f"llvmlite {version('llvmlite')}", *sources]))


@functools.cache
def _machine() -> Any:
    """Return LLVM's description of this kind of processor."""
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    triple, name, features = processor()
    target = binding.Target.from_triple(triple)
    # Code that may lie anywhere in memory, far from the C library.
    return target.create_target_machine(cpu=name, features=features, opt=3, reloc="pic")


def _compiled(text: str) -> bytes:
    """Return the object code of a module."""
    from llvmlite import binding

    machine = _machine()
    module = binding.parse_assembly(text, binding.create_context())
    module.triple = machine.triple
    module.data_layout = str(machine.target_data)
    module.verify()
    options = binding.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = False
    builder = binding.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


@functools.cache
def _linker() -> Any:
    from llvmlite import binding

    return binding.create_lljit_compiler(_machine(), use_jit_link=True)


def _linked(name: str, image: bytes) -> tuple[int, Any]:
    """Put object code into memory; return the address of its one function, and its keeper."""
    from llvmlite import binding

    library = binding.JITLibraryBuilder().add_object_img(image).add_current_process()
    library.export_symbol(translation.ENTRY)
    try:
        tracker = library.link(_linker(), f"{name}.{next(_numbers)}")
    except RuntimeError as error:
        raise CompilationError(f"compiled equations cannot be loaded: {error}") from error
    return tracker[translation.ENTRY], tracker
