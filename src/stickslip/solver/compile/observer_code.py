"""Machine code of the observer of a record, one file on a machine."""

import functools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, final

from typing_extensions import override

from stickslip.kernels import observer
from stickslip.solver.compile.image_cache import name_of
from stickslip.solver.compile.kernels_code import as_function, function_of, signature_of
from stickslip.solver.compile.object_code import ObjectCode, maker
from stickslip.solver.compile.translation import exported, translated


@final
class ObserverCode(ObjectCode):
    """Machine code of `stickslip.kernels.observer.observe`."""

    @property
    @override
    def title(self) -> str:
        return "the observer of records"

    @property
    @override
    def name(self) -> str:
        sources = [Path(one).read_text("utf-8") for one in (observer.__file__, __file__)]
        return name_of("\n".join([maker(), *sources]))

    @property
    @override
    def symbols(self) -> Sequence[str]:
        return ("observe",)

    @property
    @override
    def seconds(self) -> float:
        return 0.2

    @override
    def text(self) -> str:
        parts: list[Any] = [observer.looked_up, observer.strained, observer.observe]
        own = signature_of(observer.observe)
        return f"{translated([function_of(one) for one in parts])}\n{exported('observe', own)}"


CODE = ObserverCode()


@functools.cache
def observe() -> Callable[..., Any]:
    """Return the compiled function, loaded once in a process."""
    CODE.load()
    return as_function(CODE.addresses["observe"], signature_of(observer.observe))
