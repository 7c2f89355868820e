"""Benchmark the Python solvers at the points in a file, and write their results. The script run.sh calls this file."""

import ctypes
import importlib.metadata
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import rigid


def scipy_numpy(points):
    """Solve the equations with hybr. Python floats are used, because they are faster than numpy for seven numbers."""
    import numpy
    from scipy.optimize import root

    def solve(point):
        case = rigid.case(point, math)

        def residual(y):
            return numpy.array(rigid.residual(case, y.tolist(), math))

        found = root(residual, numpy.array(case.start), method="hybr", tol=rigid.TOLERANCE)
        if not numpy.linalg.norm(found.fun) <= rigid.TOLERANCE:
            return None
        answer, physical = rigid.answer(case, found.x.tolist(), math)
        return answer if physical else None

    return lambda: [solve(point) for point in points]


def scipy_compiled(points):
    """Solve the equations, which are implemented in C, with hybr. Fixed buffers reduce the overhead of the calls."""
    import numpy
    from scipy.optimize import root

    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder, "rigid.so")
        source = Path(__file__).with_name("rigid.c")
        compiler = ["gcc", "-O3", "-march=native", "-shared", "-fPIC"]
        subprocess.run([*compiler, "-o", library, source, "-lm"], check=True)
        code = ctypes.CDLL(str(library))
    table, y, r, out = numpy.array(points), numpy.empty(7), numpy.empty(7), numpy.empty(8)
    at = [ctypes.c_void_p(buffer.ctypes.data) for buffer in (y, r, out)]

    def residual(x):
        y[:] = x
        code.residual(at[0], at[1])
        return r.copy()

    def solve(i):
        code.set_up(ctypes.c_void_p(table.ctypes.data + i * table.strides[0]), at[0])
        found = root(residual, y.copy(), method="hybr", tol=rigid.TOLERANCE)
        y[:] = found.x
        solved = numpy.linalg.norm(found.fun) <= rigid.TOLERANCE and code.answer(at[0], at[2])
        return out.tolist() if solved else None

    return lambda: [solve(i) for i in range(len(points))]


def jax_newton(points):
    """Solve all points in one call of JAX. The compilation time is not measured."""
    import jax

    jax.config.update("jax_platforms", "cpu")
    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp
    import numpy

    def solve(point):
        case = rigid.case(tuple(point), jnp)

        def residual(y):
            return jnp.stack(rigid.residual(case, tuple(y), jnp))

        def go_on(state):
            _, r, steps = state
            return (jnp.linalg.norm(r) > rigid.TOLERANCE) & (steps < rigid.MOST_STEPS)

        def step(state):
            y, r, steps = state
            y = y - jnp.linalg.solve(jax.jacfwd(residual)(y), r)
            return y, residual(y), steps + 1

        start = jnp.stack(case.start)
        y, r, _ = jax.lax.while_loop(go_on, step, (start, residual(start), 0))
        answer, physical = rigid.answer(case, tuple(y), jnp)
        return jnp.stack(answer), physical & (jnp.linalg.norm(r) <= rigid.TOLERANCE)

    table, batch = numpy.array(points), jax.jit(jax.vmap(solve))

    def run():
        answers, solved = (numpy.asarray(part) for part in batch(table))
        return [answer if good else None for answer, good in zip(answers, solved)]

    return run


def timed(name, make, points, runs):
    """Return the median time of several runs. The first run is not measured."""
    run = make(points)
    answers = run()
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        answers = run()
        times.append(time.perf_counter() - start)
    answers = [None if answer is None else list(map(float, answer)) for answer in answers]
    ns_per_point = statistics.median(times) * 1e9 / len(points)
    return {"name": name, "ns_per_point": ns_per_point, "answers": answers}


def main(points_file, results_file):
    # All solvers run on one thread, including the thread pools of JAX.
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    data = json.loads(Path(points_file).read_text())
    peers, missing = [], []
    for name, make in [
        ("SciPy hybr, residual in Python", scipy_numpy),
        ("SciPy hybr, residual in C", scipy_compiled),
        ("JAX, jit(vmap(Newton))", jax_newton),
    ]:
        try:
            peers.append(timed(name, make, data["points"], data["runs"]))
        except (ImportError, OSError, subprocess.CalledProcessError) as error:
            missing.append(f"{name}: {error}")
    versions = [f"Python {sys.version.split()[0]}"]
    for package in ["numpy", "scipy", "jax"]:
        try:
            versions.append(f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            pass
    results = {"peers": peers, "missing": missing, "versions": versions}
    Path(results_file).write_text(json.dumps(results))


if __name__ == "__main__":
    main(*sys.argv[1:])
