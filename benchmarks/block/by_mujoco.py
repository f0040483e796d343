"""The block in MuJoCo: as a box on a plane, and as a slide joint with frictionloss."""

import functools

from benchmarks.block.problem import F_K, HEIGHT, MU_K, SETTLE, SIDE, G, M, Places, Run, pushes
from benchmarks.peers import Engine

BODY = f'<geom type="box" size="{SIDE / 2} {SIDE / 2} {HEIGHT / 2}" mass="{M}"/>'
BOX = f"""
  <default><geom friction="{MU_K} 0.005 0.0001"/></default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body pos="0 0 {HEIGHT / 2}"><freejoint/>{BODY}</body>
  </worldbody>"""
JOINT = """
  <worldbody>
    <body><joint type="slide" axis="1 0 0" frictionloss="{f}" {stiff}/>{body}</body>
  </worldbody>"""
STIFF = 'solreffriction="0.0002 1" solimpfriction="0.999 0.9999 0.001"'
"""A time constant of two steps, and as little softness as the documentation allows."""
FINE = 'timestep="0.0001" integrator="implicitfast" noslip_iterations="5"'
ELLIPTIC = f'{FINE} cone="elliptic" impratio="100"'


def build(world: str, option: str, hold: float, seconds: float) -> Run:
    import mujoco

    text = f'<mujoco><option gravity="0 0 -{G}" {option}/>{world}</mujoco>'
    model = mujoco.MjModel.from_xml_string(text)
    settled, data = mujoco.MjData(model), mujoco.MjData(model)
    step = model.opt.timestep
    mujoco.mj_step(model, settled, nstep=round(SETTLE / step))

    def run() -> Places:
        mujoco.mj_copyData(data, model, settled)
        places = [float(data.qpos[0])]
        for force, start, end in pushes(hold, seconds):
            data.xfrc_applied[1, 0] = force
            mujoco.mj_step(model, data, nstep=round((end - start) / step))
            places.append(float(data.qpos[0]))
        return Places(before=places[-2] - places[0], after=places[-1] - places[0])

    return run


def engines() -> tuple[Engine, ...]:
    plain, stiff = (JOINT.format(f=F_K, stiff=stiff, body=BODY) for stiff in ("", STIFF))
    settings = (
        ("MuJoCo, box, defaults (2 ms)", BOX, ""),
        ("MuJoCo, box, elliptic, 0.1 ms, impratio, noslip", BOX, ELLIPTIC),
        ("MuJoCo, joint frictionloss, defaults (2 ms)", plain, ""),
        ("MuJoCo, joint frictionloss, stiff, 0.1 ms, noslip", stiff, FINE),
    )
    return tuple(
        Engine(name=name, build=functools.partial(build, world, option))
        for name, world, option in settings
    )
