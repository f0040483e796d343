"""Machine code that LLVM makes, keeps in a file, and puts into memory.

LLVM gets settings under which it does not change a result: no fast mathematics, no fused products.
Code that is loaded stays until the process ends, since vectors of runs hold addresses in it.
"""

import functools
import itertools
import threading
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from stickslip.errors import CompilationError
from stickslip.solver.compile import translation
from stickslip.solver.compile.image_cache import (
    Processor,
    common_processor,
    has_image,
    image_of,
    keep_image,
    name_of,
    processor,
)

LONG = 1.0
"""Time for compiling [s] that nobody should spend in each process without being told."""
_LOCK = threading.RLock()
_loaded: dict["ObjectCode", tuple[Mapping[str, int], Any]] = {}
"""Addresses of functions, and what keeps them in memory."""
_numbers = itertools.count()
"""What is put into memory needs names that were never used."""


class ObjectCode(ABC):
    """Functions that are compiled at once and kept in one file."""

    @property
    @abstractmethod
    def title(self) -> str:
        """What it is, for a message."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of its file, which depends on all that decides what is in it but the processor."""

    @property
    @abstractmethod
    def symbols(self) -> Sequence[str]:
        """Names of the functions that are called from outside."""

    @property
    @abstractmethod
    def seconds(self) -> float:
        """Processor time that compiling takes [s, measured], for a message."""

    @abstractmethod
    def text(self) -> str:
        """Return the functions in LLVM's language."""

    def is_ready(self) -> bool:
        """Whether it is in this process."""
        return self in _loaded

    def is_kept(self, *, common: bool = False) -> bool:
        """Whether there is a file of it for this kind of processor, or for all of the platform."""
        return has_image(self.name, common_processor() if common else None)

    @property
    def addresses(self) -> Mapping[str, int]:
        """Address of each function, once it is ready."""
        return _loaded[self][0]

    def load(self) -> bool:
        """Load it, or compile it and keep it; return whether it was compiled.

        Two processes that do so at once both compile: to wait for each other would take as long.
        """
        with _LOCK:
            if self.is_ready() and self.is_kept():
                return False
            image, compiled = self._image(None)
            if not self.is_ready():
                _loaded[self] = _linked(self.name, image, self.symbols)
            return compiled

    def image(self, *, common: bool) -> bytes:
        """Return the object code itself, which a linker takes."""
        with _LOCK:
            return self._image(common_processor() if common else None)[0]

    def _image(self, kind: Processor | None) -> tuple[bytes, bool]:
        """Return the object code for a kind of processor, and whether it had to be compiled."""
        image = image_of(self.name, kind)
        if image is not None:
            return image, False
        image = _compiled(self.text(), kind)
        keep_image(self.name, image, warns=self.seconds > LONG, kind=kind)
        return image, True


@functools.cache
def maker() -> str:
    """Return what decides, beside a text, which machine code comes of it."""
    sources = [Path(path).read_text("utf-8") for path in (__file__, translation.__file__)]
    return name_of("\n".join([f"llvmlite {version('llvmlite')}", *sources]))


@functools.cache
def _machine(kind: Processor) -> Any:
    """Return LLVM's description of a kind of processor."""
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    triple, name, features = kind
    target = binding.Target.from_triple(triple)
    # Code that may lie anywhere in memory, far from the C library.
    return target.create_target_machine(cpu=name, features=features, opt=3, reloc="pic")


def _compiled(text: str, kind: Processor | None = None) -> bytes:
    """Return the object code of a module."""
    from llvmlite import binding

    machine = _machine(kind or processor())
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

    return binding.create_lljit_compiler(_machine(processor()), use_jit_link=True)


def _linked(name: str, image: bytes, symbols: Sequence[str]) -> tuple[Mapping[str, int], Any]:
    """Put object code into memory; return the addresses of its functions, and its keeper."""
    from llvmlite import binding

    library = binding.JITLibraryBuilder().add_object_img(image).add_current_process()
    for symbol in symbols:
        library.export_symbol(symbol)
    try:
        tracker = library.link(_linker(), f"{name}.{next(_numbers)}")
    except RuntimeError as error:
        raise CompilationError(f"compiled code cannot be loaded: {error}") from error
    return {symbol: tracker[symbol] for symbol in symbols}, tracker
