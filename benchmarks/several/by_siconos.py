"""The blocks in Siconos, in an interpreter of its own: relays, with the Moreau scheme.

Run as a script by that interpreter, it reads a problem as one line of JSON, and answers every
further line with the last places.
"""

import functools
import json
import os
import subprocess
import sys


def places(problem: dict[str, object]) -> list[float]:
    """Return where the blocks come to rest; places and speeds are states of first order."""
    import numpy as np
    import siconos.kernel as sk

    n, step = len(problem["levels"]), problem["step"]
    matrix, inputs = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, n))
    matrix[:n, n:] = np.eye(n)
    matrix[n:, :n] = -np.array(problem["stiffness"])
    inputs[n:] = np.diag(problem["levels"])
    outputs = np.hstack([np.zeros((n, n)), np.eye(n)])
    system = sk.FirstOrderLinearTIDS(np.concatenate([np.zeros(n), problem["speeds"]]), matrix)
    relays = sk.Interaction(sk.RelayNSL(n), sk.FirstOrderLinearTIR(outputs, inputs))
    model = sk.NonSmoothDynamicalSystem(0.0, problem["t_end"])
    model.insertDynamicalSystem(system)
    model.link(relays, system)
    scheme = sk.EulerMoreauOSI(0.5)
    clock = sk.TimeDiscretisation(0.0, step)
    simulation = sk.TimeStepping(model, clock, scheme, sk.Relay())
    while simulation.hasNextEvent():
        simulation.computeOneStep()
        simulation.nextStep()
    return [float(x) for x in system.x()[:n]]


def main() -> None:
    problem = json.loads(sys.stdin.readline())
    answers = os.dup(1)
    os.dup2(2, 1)  # Siconos writes to the standard output
    for _ in sys.stdin:
        os.write(answers, (json.dumps(places(problem)) + "\n").encode())


if __name__ == "__main__":
    main()
else:
    import numpy as np

    from benchmarks.measuring import Missing
    from benchmarks.peers import WORKERS, Engine
    from benchmarks.several.problem import Case, Run, levels, speeds, stiffness

    PYTHON = os.environ.get("SICONOS_PYTHON", "/usr/bin/python3")
    """Interpreter that imports siconos; Debian's, whose NumPy it was built with."""

    def build(case: Case, step: float) -> Run:
        n = len(case.mechanism.coordinates)
        problem = {
            "levels": levels(n).tolist(), "speeds": speeds(n).tolist(),
            "stiffness": stiffness(n).tolist(), "step": step, "t_end": case.t_end,
        }  # fmt: skip
        worker = subprocess.Popen(
            [PYTHON, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip
        WORKERS.append(worker.pid)
        worker.stdin.write(json.dumps(problem) + "\n")

        def run() -> np.ndarray:
            worker.stdin.write("\n")
            worker.stdin.flush()
            return np.array(json.loads(worker.stdout.readline()))

        return run

    @functools.cache
    def installed() -> bool:
        try:
            result = subprocess.run(
                [PYTHON, "-c", "import siconos.kernel"], check=False, capture_output=True
            )
        except OSError:
            return False
        return result.returncode == 0

    def engines(name: str, case: Case) -> tuple[Engine | Missing, ...]:
        if name != "chain":
            return ()
        if not installed():
            where = "Debian's `python3-siconos`; `SICONOS_PYTHON` names another interpreter"
            return (Missing(solver="Siconos", reason=where),)
        return tuple(
            Engine(
                name=f"Siconos, relays, Moreau, {1e3 * step:g} ms",
                build=functools.partial(build, case, step),
            )
            for step in (1e-3, 1e-4)
        )
