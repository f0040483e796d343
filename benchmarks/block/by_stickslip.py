"""The block in stickslip."""

from benchmarks.block.problem import MU_K, MU_S, G, M, Places, Run, pushes
from benchmarks.measuring import TIERS
from benchmarks.peers import BOTH, Engine
from stickslip import Coulomb, EventDriven, SpringBlock, simulate
from stickslip.engine.solver import prepare
from stickslip.mechanisms.drives import Sampled

LAW = Coulomb(kinetic_coefficient=MU_K, static_coefficient=MU_S)


def build(tier: str, hold: float, seconds: float) -> Run:
    forces, starts, ends = zip(*pushes(hold, seconds), strict=True)
    block = SpringBlock(mass=M, gravity=G, drive=Sampled(times=starts, values=forces))
    if tier == "compiled":
        prepare(block, LAW)
    solver = EventDriven(tier=tier)

    def run() -> Places:
        result = simulate(block, LAW, t_end=ends[-1], solver=solver)
        before, after = result.at(ends[-2:])["x"]
        return Places(before=float(before), after=float(after))

    return run


def engines(tiers: tuple[str, ...]) -> tuple[Engine, ...]:
    return tuple(
        Engine(
            name=TIERS[tier],
            levels=BOTH,
            build=lambda hold, seconds, tier=tier: build(tier, hold, seconds),
        )
        for tier in tiers
    )
