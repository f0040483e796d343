"""The block in heyoka, with modes and events by hand."""

import functools

from benchmarks.block.problem import F_K, F_S, M, Places, Run, pushes
from benchmarks.peers import BOTH, Engine


@functools.cache
def slipping() -> object:
    """Return the integrator of a slip forward, compiled once."""
    import heyoka as hy

    x, v = hy.make_vars("x", "v")
    return hy.taylor_adaptive(
        [(x, v), (v, (hy.par[0] - F_K) / M)], [0.0, 0.0], tol=1e-9,
        t_events=[hy.t_event(v, direction=hy.event_direction.negative)],
    )  # fmt: skip


def build(hold: float, seconds: float) -> Run:
    import heyoka as hy

    slip = slipping()
    ran_on = hy.taylor_outcome.time_limit
    parts = pushes(hold, seconds)

    def run() -> Places:
        x, slips, places = 0.0, False, []
        slip.state[:] = 0.0
        slip.reset_cooldowns()
        for force, start, end in parts:
            if force > F_S and not slips:
                slip.state[:], slips = (x, 0.0), True
            if slips:
                slip.time, slip.pars[0] = start, force
                slips = slip.propagate_until(end)[0] == ran_on
                x = float(slip.state[0])
            places.append(x)
        return Places(before=places[-2], after=places[-1])

    return run


def engines() -> tuple[Engine, ...]:
    return (Engine(name="heyoka, modes and events by hand", levels=BOTH, build=build),)
