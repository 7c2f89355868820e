"""Solve the traction model at the points in a file with SciPy and with JAX. The script traction.sh calls this file.

SciPy and JAX use the same equations: `m` is math or jax.numpy for numbers, and `xp` is numpy or jax.numpy for arrays.
They come from docs/theory/06-elastic-contact.md and 09-traction.md and have the unknowns (T1). All quantities are
divided by ball radius, axial load and relative speed W. The first axis of arrays is the contact, with the nut first.
"""

import importlib.metadata
import json
import math
import os
import statistics
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

TOLERANCE = 1e-10
RUNS = 3

# Quadrature: accuracy, number of nodes in a whole panel, and number of nodes in one part of a split panel or beside a
# spin pole.
ACCURACY = 1e-8
PANEL, PART = 16, 12
MOST_INNER = 24
CREEP = 1e-4
FAR, TINY = 8.0, 1e-150


def legendre(nodes):
    """Return the Gauss-Legendre rule on [0, 1]."""
    places, weights = np.polynomial.legendre.leggauss(nodes)
    return 0.5 * (places + 1.0), 0.5 * weights


def chebyshev():
    """Return node positions and weights along a line for each number of nodes (T19), padded with zero weights."""
    places, weights = np.zeros((2, MOST_INNER + 1, MOST_INNER))
    for count in range(1, MOST_INNER + 1):
        angle = np.pi * np.arange(1, count + 1) / (count + 1)
        places[count, :count] = np.cos(angle)
        weights[count, :count] = 2.0 / (count + 1) * np.sin(angle) ** 2
    return places, weights


INNER = chebyshev()
# Largest permitted relative differences. The limit for the efficiency is the smallest error bound that bsm states
# (T25). The limit for loads and angles is the accuracy of the quadrature, because bsm does not change the number of
# nodes (T19) near a root.
AGREEMENT = 1e-9, 1e-8
# If the relative difference is larger, the two solvers have found different roots.
SAME_ROOT = 1e-4
# A panel has 24 nodes, whether it is split or not. Nodes that a whole panel does not need have zero weight.
(whole, whole_weights), (part, part_weights) = legendre(PANEL), legendre(PART)
SLOTS = 2 * PART
WHOLE = np.append(whole, whole[: SLOTS - PANEL]), np.append(whole_weights, np.zeros(SLOTS - PANEL))
SPLIT = np.tile(part, 2), np.tile(part_weights, 2)
FIRST = np.arange(SLOTS) < PART
# Value of sinh^2 (T18) below which the spin pole counts as being inside the contact ellipse.
LEAST = np.sinh(-np.log(ACCURACY) / (2.0 * (MOST_INNER + 1))) ** 2


class Layout(NamedTuple):
    """Array sizes. `inside`: panels may be split because of poles inside. `inner`: number of nodes along a line."""

    inside: bool
    inner: int


# Passes of JAX. The first pass solves all points, and each further pass solves the remaining
# points. Each entry contains the size of the arrays and the maximum number of steps.
PASSES = [(Layout(False, 8), 8), (Layout(False, 12), 20), (Layout(True, MOST_INNER), 40)]


class Case(NamedTuple):
    """An operating point. Each tuple contains one value for the nut and one for the screw."""

    friction: Any
    radius: Any
    arc: Any
    sin_a: Any
    cos_a: Any
    offset: tuple
    reach: Any
    approach: tuple
    semi_axes: tuple
    pressed: tuple
    creep: Any
    mass: Any
    nut_speed: Any
    load: Any
    start: tuple


def hertz(ratio, m):
    """Return the axis ratio b/a and the complete integrals K and E for a curvature ratio: (H7) and text below (H11)."""
    log_kappa = 2.0 / m.pi * m.log(ratio)
    # Newton's method is applied to logarithms and needs one step fewer than the loop takes. The
    # arithmetic-geometric means converge in five steps up to kappa = 100.
    for _ in range(5):
        q = m.exp(-log_kappa)
        parameter = 1.0 - q * q
        a, g, r = 1.0, q, 0.0
        for i in range(1, 7):
            a, g, c = 0.5 * (a + g), m.sqrt(a * g), 0.5 * (a - g)
            r += 2.0**i * c * c / parameter
        slope = ((1.0 + r) * (1.0 - 3.0 * r) + 4.0 * r / parameter) / ((1.0 + r) * (1.0 - r))
        k = m.pi / (2.0 * a)
        e = k * (1.0 - 0.5 * parameter * (1.0 + r))
        log_kappa += (m.log(ratio) - m.log((1.0 - r) / (q * q * (1.0 + r)))) / slope
    return q, k, e


def case(point, m):
    """Convert an operating point from user units, and add the starting point."""
    (ball_mm, pitch_mm, lead_deg, contact_deg, f, density, screw_rpm, nut_rpm, axial, balls) = point[:10]
    conformities, young, poisson = point[10:12], 1e9 * point[12], point[13]
    r_b, r_m, deg = 0.5e-3 * ball_mm, 0.5e-3 * pitch_mm, m.pi / 180.0
    sin_a, cos_a = m.sin(lead_deg * deg), m.cos(lead_deg * deg)
    sin_b, cos_b = m.sin(contact_deg * deg), m.cos(contact_deg * deg)
    speed, load, radius = screw_rpm - nut_rpm, axial / balls, r_m / r_b
    w, nut_speed = speed * m.pi / 30.0, nut_rpm / speed
    mass = 4.0 / 3.0 * m.pi * r_b * r_b * r_b * density * r_b * w * w / load
    arc, advance = radius / cos_a, radius * sin_a / cos_a
    # Contact modulus (H1), in scaled units of force and length
    modulus = young / (2.0 * (1.0 - poisson * poisson)) * r_b * r_b / load
    offset, approach, semi_axes, pressed = [], [], [], []
    for side, conformity in zip((1.0, -1.0), conformities):
        groove = 2.0 * conformity
        offset.append(groove - 1.0)
        # (H3) to (H6)
        center = radius - side * offset[-1] * cos_b
        bent = side * cos_b * center / (center * center + advance * advance)
        along, across = 1.0 - bent / (1.0 + groove * bent), 1.0 - 1.0 / groove
        q, k, e = hertz(along / across, m)
        # (H8), (H9), (E2)
        a = (3.0 * e / (m.pi * q * q * (along + across) * modulus)) ** (1.0 / 3.0)
        approach.append(3.0 * k / (2.0 * m.pi * a * modulus))
        semi_axes.append((a, a * q))
        pressed.append(2.0 * groove / (groove + 1.0))
    reach = (offset[0] + offset[1]) * cos_b
    # The factor c of (T9) is 1, because every ellipse here is shorter than the ball.
    start = begin((sin_a, cos_a, arc, nut_speed), (offset, approach, reach), (sin_b, cos_b), m)
    return Case(
        m.copysign(f, w), radius, arc, sin_a, cos_a, tuple(offset), reach, tuple(approach), tuple(semi_axes),
        tuple(pressed), CREEP, mass, nut_speed, load, start,
    )  # fmt: skip


def larger(a, b):
    return 0.5 * (a + b + abs(a - b))


def begin(helix, jones, angle, m):
    """Return the motion of a ball that rolls without friction or inertia, spinning only at the screw: (P4), (W3)-(W5)."""
    (sin_a, cos_a, arc, nut_speed), (offset, approach, reach), (sin_b, cos_b) = helix, jones, angle
    for _ in range(4):
        q = 1.0 / (cos_a * sin_b)
        cos_b = reach / (offset[0] + offset[1] + (approach[0] + approach[1]) * q ** (2.0 / 3.0))
        sin_b = m.sqrt(1.0 - cos_b * cos_b)
    p = 0.5 * (1.0 - cos_a * cos_b / arc)
    about_t, about_n, about_b = 0.5 * sin_a, p * arc * sin_b, -p * arc * cos_b
    along, around = sin_a * about_t + cos_a * about_b, sin_a * about_b - cos_a * about_t
    return (q, 0.0 * q, q, p + nut_speed, along, about_n, around)


def poles(q, slip_across, creep, xp):
    """Return the real parts and the widths of the poles (T16), sorted from left to right."""
    q_0, q_1, q_2 = q
    s_1, s_2 = xp.where(q_1 < 0.0, -1.0, 1.0), xp.where(q_2 < 0.0, -1.0, 1.0)
    q_2 = xp.where(xp.abs(q_2) < TINY, TINY, q_2)
    d = q_1 * q_1 - 4.0 * q_0 * q_2
    t = -0.5 * (q_1 + s_1 * xp.sqrt(xp.maximum(d, 0.0)))
    t = xp.where(xp.abs(t) < TINY, TINY, t)
    lines = xp.stack([xp.where(d < 0.0, -0.5 * q_1 / q_2, x) for x in (t / q_2, q_0 / t)], axis=-1)
    b_0, b_1 = (xp.abs(b) for b in slip_across(xp.clip(lines, -1.0, 1.0)))
    # (T15)
    least = xp.sqrt(xp.maximum(b_0 - b_1, 0.1 * b_1) ** 2 + creep * creep)
    root = xp.sqrt(d[:, None] + 4j * xp.abs(q_2)[:, None] * least)
    t = -0.5 * (q_1[:, None] + s_1[:, None] * (root.real + 1j * s_2[:, None] * root.imag))
    far, near = t[:, 0] / q_2, (q_0 - 1j * least[:, 1]) / t[:, 1]
    both = xp.stack([far, near], axis=-1)
    at = xp.clip(both.real, -FAR, FAR)
    width = xp.clip(xp.abs(both.imag), 1e-100, FAR)
    swap = (at[:, 1] < at[:, 0])[:, None]
    return xp.where(swap, at[:, ::-1], at), xp.where(swap, width[:, ::-1], width)


def nodes(slip, layout, xp):
    """Return positions of the nodes relative to the semi-axes, fractions of the load (T14), and whether all nodes fit.

    The axes of the arrays are the contacts, the lines, and the nodes of each line. Without a layout, the arrays are as large as needed.
    """
    q, roll, turn, sag, creep = slip

    def along(x):
        return q[0][:, None] + (q[1][:, None] + q[2][:, None] * x) * x

    def across(x):
        chord = xp.sqrt(xp.maximum((1.0 - x) * (1.0 + x), 0.0))
        return roll[:, None] * (1.0 - sag[:, None] * x * x), turn[:, None] * chord

    def analyticity(x):
        """Return sinh^2(eta) of (T18) at the positions x."""
        v, (b_0, b_1) = along(x), across(x)
        square, spin = v * v + creep * creep, b_1 * b_1
        far = (xp.abs(b_0) - xp.abs(b_1)) * (xp.abs(b_0) + xp.abs(b_1)) + square
        both = xp.sqrt(far * far + 4.0 * spin * square) + xp.abs(far)
        up, down = xp.where(far < 0.0, 2.0 * square, both), xp.where(far < 0.0, both, 2.0 * spin)
        return up / xp.maximum(down, TINY)

    at, width = poles(q, across, creep, xp)
    middle = xp.clip(0.5 * (at[:, 0] + at[:, 1]), -1.0, 1.0)
    low, high = xp.stack([-xp.ones(2), middle], axis=-1), xp.stack([middle, xp.ones(2)], axis=-1)
    split = (analyticity(at) < LEAST) & (low < at) & (at < high)
    # (T17)
    begin, end = xp.arcsinh((low - at) / width), xp.arcsinh((high - at) / width)
    slots = (SLOTS if split.any() else PANEL) if layout is None else (SLOTS if layout.inside else PANEL)
    place, part, first = WHOLE[0][:slots], WHOLE[1][:slots], FIRST[:slots]
    base, length = begin[..., None], (end - begin)[..., None]
    if slots == SLOTS:
        cut = split[..., None]
        base = xp.where(cut, xp.where(first, base, 0.0), base)
        length = xp.where(cut, xp.where(first, -begin[..., None], end[..., None]), length)
        place, part = (xp.where(cut, x, y) for x, y in zip(SPLIT, (place, part)))
    tau = base + length * place
    xi = (at[..., None] + width[..., None] * xp.sinh(tau)).reshape(2, -1)
    load = (length * part * width[..., None] * xp.cosh(tau)).reshape(2, -1)
    load = load * 0.75 * xp.maximum((1.0 - xi) * (1.0 + xi), 0.0)

    # Number of nodes (T19), which is equal for eight neighboring lines
    square = analyticity(xi)
    inside = square < LEAST
    least = xp.where(inside, xp.inf, square).reshape(2, -1, 8).min(-1)
    eta = xp.arcsinh(xp.sqrt(xp.minimum(least, 1e300)))
    count = xp.clip(xp.ceil(-np.log(ACCURACY) / (2.0 * eta)) - 1.0, 2, MOST_INNER).astype(int)
    near = bool(inside.any()) if layout is None else layout.inside
    room = MOST_INNER if near else int(count.max()) if layout is None else layout.inner
    resolved = True if layout is None or near else (count <= room).all() & ~inside.any() & ~split.any()
    count = xp.repeat(count, 8, axis=1)
    s, weight = (xp.asarray(table[:, :room])[count] for table in INNER)
    if near:
        # Quadrature (T20), which also uses 24 nodes
        sinh = xp.clip(xp.sqrt(square), 1e-100, FAR)
        b_0, b_1 = across(xi)
        phi_0 = xp.arccos(xp.clip(-b_0 / xp.where(b_1 == 0.0, TINY, b_1) / xp.sqrt(1.0 + square), -1.0, 1.0))
        left, right = -xp.arcsinh(phi_0 / sinh), xp.arcsinh((np.pi - phi_0) / sinh)
        base, length = xp.where(FIRST, left[..., None], 0.0), xp.where(FIRST, -left[..., None], right[..., None])
        tau = base + length * SPLIT[0]
        phi = xp.clip(phi_0[..., None] + sinh[..., None] * xp.sinh(tau), 0.0, np.pi)
        drawn = length * SPLIT[1] * sinh[..., None] * xp.cosh(tau) * xp.sin(phi) ** 2 * (2.0 / np.pi)
        s = xp.where(inside[..., None], xp.cos(phi), s)
        weight = xp.where(inside[..., None], drawn, weight)
    return (xi, s, load[..., None] * weight), resolved


def friction(axes, pressed, motion, creep, layout, xp, fixed):
    """Return the friction force along t and t x N and the moment about t, N and t x N, divided by fQ (T22). Apply `fixed` to the slip from which the nodes are placed, so that derivatives do not include the motion of the nodes."""
    (a, b), (speed, w_t, w_n, w_c) = axes, motion
    sag = 0.5 * a * a / pressed
    # (T12), (T13)
    q = speed + w_c, w_n * a, -w_c * sag
    place, resolved = nodes(fixed((q, w_t, w_n * b, sag, creep)), layout, xp)
    xi, s, weight = place
    h = 1.0 - sag[:, None] * xi * xi
    reach = b[:, None] * xp.sqrt(xp.maximum((1.0 - xi) * (1.0 + xi), 0.0))
    v_t = q[0][:, None] + (q[1][:, None] + q[2][:, None] * xi) * xi
    v_c = (w_t[:, None] * h)[..., None] + (w_n[:, None] * reach)[..., None] * s
    pull = weight / xp.sqrt((v_t * v_t + creep * creep)[..., None] + v_c * v_c)
    # (T21)
    t, c = v_t * pull.sum(-1), (pull * v_c).sum(-1)
    moment = (pull * v_c * s).sum(-1)
    spin = a[:, None] * xi * t + reach * moment
    return [x.sum(-1) for x in (-t, c, -h * c, -spin, -h * t)], resolved


def evaluate(c, y, layout, m, xp, fixed):
    """Return the residuals (P5), the screw torque, both contact angles, and whether there are enough nodes."""
    q_a, tilt, q_b, p, along, radial, around = y
    loads = q_a, q_b
    growth = m.cbrt(q_a), m.cbrt(q_b)
    # (P2), (J7)
    l_a, l_b = (c.offset[i] + c.approach[i] * growth[i] * growth[i] for i in range(2))
    sin_t, cos_t = m.sin(tilt), m.cos(tilt)
    s, d = (l_a + l_b) * cos_t, (l_a - l_b) * sin_t
    beta = m.atan2(d, s) + m.acos(c.reach / m.sqrt(s * s + d * d))
    sin_b, cos_b = m.sin(beta), m.cos(beta)
    # (K7), (K8)
    k = c.sin_a, c.cos_a * sin_b, c.cos_a * cos_b
    n = 0.0, cos_b, -sin_b
    k_n = -c.cos_a, c.sin_a * sin_b, c.sin_a * cos_b
    # (T4), (K12)
    to_nut = [along * k[i] + radial * n[i] + around * k_n[i] for i in range(3)]
    motions = to_nut, [to_nut[i] - k[i] for i in range(3)]
    # (K9)
    normals = (cos_t, -sin_t), (-cos_t, -sin_t)
    motion = (
        [c.arc * (p - c.nut_speed), c.arc * (p - c.nut_speed - 1.0)],
        [w[0] for w in motions],
        [w[1] * n_y + w[2] * n_z for w, (n_y, n_z) in zip(motions, normals)],
        [w[2] * n_y - w[1] * n_z for w, (n_y, n_z) in zip(motions, normals)],
    )
    # (P6)
    axes = [[growth[i] * c.semi_axes[i][axis] for i in range(2)] for axis in range(2)]
    known = xp.array(axes), xp.array(c.pressed), xp.array(motion), c.creep
    sums, resolved = friction(*known, layout, xp, fixed)
    forces, moments = [], []
    for i, (n_y, n_z) in enumerate(normals):
        # (T2)
        f_t, f_c, m_t, m_n, m_c = (c.friction * loads[i] * x[i] for x in sums)
        forces.append((f_t, loads[i] * n_y - f_c * n_z, loads[i] * n_z + f_c * n_y))
        moments.append((m_t, m_n * n_y - m_c * n_z, m_n * n_z + m_c * n_y))
    # (B4); (B5) with (T5); (B6)
    thrown, gyro = c.mass * c.radius * p * p, 0.4 * c.mass * p
    left = [forces[0][i] + forces[1][i] - thrown * n[i] for i in range(3)]
    left += [moments[0][i] + moments[1][i] - gyro * (radial * k_n[i] - around * n[i]) for i in range(3)]
    left.append(sum(forces[0][i] * k[i] for i in range(3)) - 1.0)
    # Torque (B7), with k x n instead of the component of n x F along k
    torque = sum(moments[1][i] * k[i] - c.radius * k_n[i] * forces[1][i] for i in range(3))
    return left, torque, (beta - tilt, beta + tilt), resolved


def weights(c):
    """Return the weights of the equations (T3) at the starting point."""
    force = 1.0 / larger(1.0, c.mass * c.radius * c.start[3] ** 2)
    return [force] * 3 + [force / abs(c.friction)] * 3 + [force]


def answer(c, y, evaluated, m):
    """Return the efficiency, the loads [N] and contact angles [deg] of nut and screw, and whether the solution is valid."""
    _, torque, angles, resolved = evaluated
    # The efficiency is the ratio of ideal torque to torque or, for the other sign of W, the inverse ratio (B8).
    efficiency = (c.radius * c.sin_a / c.cos_a / torque) ** m.copysign(1.0, c.friction)
    right, good = 0.5 * m.pi, (y[0] > 0.0) & (y[2] > 0.0) & resolved
    for angle in angles:
        good &= (angle > 0.0) & (angle < right)
    return (efficiency, y[0] * c.load, y[2] * c.load, *(angle * 180.0 / m.pi for angle in angles)), good


def scipy_hybr(points):
    """Solve the points one by one with hybr, which stops when its step is small, so that the residual is very small."""
    from scipy.optimize import root

    def same(x):
        return x

    def solve(point):
        c = case(point, math)
        scale = np.array(weights(c))

        def residual(y):
            return scale * np.array(evaluate(c, y.tolist(), None, math, np, same)[0])

        found = root(residual, np.array(c.start), method="hybr", tol=0.01 * TOLERANCE)
        if not np.linalg.norm(found.fun) <= TOLERANCE:
            return None
        y = found.x.tolist()
        numbers, good = answer(c, y, evaluate(c, y, None, math, np, same), math)
        return numbers if good else None

    return lambda: [solve(point) for point in points]


def jax_newton(points):
    """Solve all points in one call with small arrays and few steps. Then solve the points that have not converged again, with larger arrays."""
    import jax

    jax.config.update("jax_platforms", "cpu")
    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp

    def solve(point, layout, most_steps):
        c = case(tuple(point), jnp)
        scale = jnp.stack(weights(c))

        def at(y):
            return evaluate(c, tuple(y), layout, jnp, jnp, jax.lax.stop_gradient)

        def residual(y):
            return scale * jnp.stack(at(y)[0])

        def go_on(state):
            _, r, _, steps = state
            return (jnp.linalg.norm(r) > TOLERANCE) & (steps < most_steps)

        def step(state):
            y, r, part, steps = state
            trial = y - part * jnp.linalg.solve(jax.jacfwd(residual)(y), r)
            left = residual(trial)
            # A residual that is NaN never counts as smaller.
            better = jnp.linalg.norm(left) < jnp.linalg.norm(r)
            y, r = jnp.where(better, trial, y), jnp.where(better, left, r)
            return y, r, jnp.where(better, 1.0, 0.5 * part), steps + 1

        start = jnp.stack(c.start)
        y, r, _, _ = jax.lax.while_loop(go_on, step, (start, residual(start), 1.0, 0))
        numbers, good = answer(c, tuple(y), at(y), jnp)
        return jnp.stack(numbers), good & (jnp.linalg.norm(r) <= TOLERANCE)

    table, batch = np.array(points), jax.jit(jax.vmap(solve, in_axes=(0, None, None)), static_argnums=(1, 2))

    def run():
        answers, left = [None] * len(table), np.arange(len(table))
        for layout, most_steps in PASSES:
            if len(left):
                numbers, solved = (np.asarray(part) for part in batch(table[left], layout, most_steps))
                for place, number in zip(left[solved], numbers[solved]):
                    answers[place] = number.tolist()
                left = left[~solved]
        return answers

    return run


def timed(make, points):
    """Return the answers and the median time of several runs. The first run is not measured."""
    run = make(points)
    answers, times = run(), []
    for _ in range(RUNS):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return answers, statistics.median(times)


def same_root(answers, reference):
    """Return a mask of the points at which both solvers found the same root."""
    both = [(a, b) for a, b in zip(answers, reference) if a is not None and b is not None]
    return [(a, b) for a, b in both if all(abs(x / y - 1.0) <= SAME_ROOT for x, y in zip(a, b))]


def worst(both, places):
    """Return the largest relative difference between two arrays."""
    differences = [abs(a[i] / b[i] - 1.0) for a, b in both for i in places]
    # A difference that is NaN counts as infinite.
    return max((math.inf if math.isnan(x) else x for x in differences), default=math.inf)


def main(file):
    # All solvers run on one thread, including the thread pools of JAX.
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    data = json.loads(Path(file).read_text())
    points, reference = data["points"], data["answers"]
    peers = [("bsm batch, 1 thread", reference, data["batch"]), ("bsm, point by point", reference, data["single"])]
    for name, make in [("SciPy hybr, residual in NumPy", scipy_hybr), ("JAX, jit(vmap(Newton))", jax_newton)]:
        peers.append((name, *timed(make, points)))
    header = "solver, time relative to bsm batch on 1 thread, time relative to bsm point by point, us/point, not solved, other answers, worst η, worst Q and β"
    print(f"| {header.replace(', ', ' | ')} |\n{'|---' * 8}|")
    agree = True
    for name, answers, seconds in peers:
        same = same_root(answers, reference)
        off = worst(same, [0]), worst(same, range(1, 5))
        missing = sum(answer is None for answer in answers)
        others = len(answers) - missing - len(same)
        agree &= all(x <= most for x, most in zip(off, AGREEMENT)) and (data["ordinary"] or not others)
        over = [seconds / data[way] for way in ("batch", "single")]
        us = 1e6 * seconds / len(points)
        print(f"| {name} | {over[0]:.2f} | {over[1]:.2f} | {us:.1f} | {missing} | {others} | {off[0]:.0e} | {off[1]:.0e} |")
    versions = [f"{package} {importlib.metadata.version(package)}" for package in ("numpy", "scipy", "jax")]
    print(f"\n{len(points)} points; Python {sys.version.split()[0]}, {', '.join(versions)}")
    if not agree:
        print(f"a peer differs by more than {AGREEMENT} in efficiency, or loads and angles", file=sys.stderr)
    return 0 if agree else 3


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
