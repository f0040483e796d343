"""What is compiled before a law is fitted."""

import logging
from collections.abc import Iterable, Sequence

from stickslip.errors import CompilationError
from stickslip.friction import BristleLaw, FrictionLaw
from stickslip.identification.travels.model import Trial, under_cycles
from stickslip.solver import Progress, is_writable, prepare, warm_up

__all__ = ["compile_for"]

LOG = logging.getLogger("stickslip")


def compile_for(
    trials: Sequence[Trial], laws: Iterable[FrictionLaw], *, progress: Progress | None = None
) -> None:
    """Compile the laws whose fit to trials takes so many slow runs that it is worth the wait.

    These are the laws with bristles, if there are several trials, and all laws if the trials are
    of many cycles.

    Parameters
    ----------
    trials : sequence of Trial
        Trials, whose mechanisms are compiled with the laws.
    laws : iterable of FrictionLaw
        Laws to fit.
    progress : callable, optional
        Called with the number of modules done and of all to compile, and the pair in work.
    """
    cycles = under_cycles(trials)
    slow = [law for law in laws if cycles or isinstance(law, BristleLaw)]
    if len(trials) < 2 or not slow:
        return
    pairs = [(trial.mechanism, law) for law in slow for trial in trials]
    if len(slow) > 1 and is_writable():  # for a single law a process would win nothing
        try:
            warm_up(pairs, ensembles=False, progress=progress)
        except CompilationError as error:
            LOG.warning("%s; going on without processes", error)
    for mechanism, law in pairs:
        prepare(mechanism, law)
