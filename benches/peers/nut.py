"""Solve the nut of `crates/bsm-nut/examples/times.rs` with SciPy, which minimizes the same energy."""

import json
import sys
import time

import numpy as np
from scipy import optimize, sparse


def problem(case):
    """Return functions for energy, gradient and Hessian, and the starting point of all unknowns."""
    theta, z = np.array(case["places"]).T
    r, alpha, beta = case["pitch_radius"], case["lead_angle"], case["contact_angle"]
    distance, stiffness = case["arc_distance"], case["stiffness"]
    count = len(theta)
    zeta = z - z.mean()
    sin, cos = np.sin(theta), np.cos(theta)
    x, y = r * cos, r * sin
    normal = np.stack([-cos, -sin, 0 * cos])
    binormal = np.stack([np.sin(alpha) * sin, -np.sin(alpha) * cos, np.cos(alpha) + 0 * cos])
    zero, one = 0 * x, 0 * x + 1
    moves = [(zero, zero, one), (one, zero, zero), (zero, one, zero), (zero, -zeta, y), (zeta, zero, -x)]
    size = 6 + 2 * count
    rows = np.arange(count)

    def couple(axis, ring, bar):
        dense = np.stack([sum(a * b for a, b in zip(axis, move)) for move in moves] + [ring + zero], axis=1)
        left = sparse.csr_matrix(dense)
        along = sparse.diags(bar + zero)
        return sparse.hstack([left, along, -along]).tocsr()

    to_b, to_n = couple(binormal, 0.0, np.cos(alpha)), couple(normal, -1.0, 0.0)
    chains = sparse.lil_matrix((size, size))
    chains[5, 5] = case["ring_N_m"]
    for body, (ea, anchor) in enumerate(case["bars"]):
        first = 6 + body * count
        for i in range(count - 1):
            k = ea / (z[i + 1] - z[i])
            a, b = first + i, first + i + 1
            chains[a, a] += k
            chains[b, b] += k
            chains[a, b] -= k
            chains[b, a] -= k
        end = 0 if anchor < z[0] else count - 1
        chains[first + end, first + end] += ea / abs(z[end] - anchor)
    chains = chains.tocsr()
    load = np.zeros(size)
    load[0] = case["axial_load_N"]
    lever = distance * np.sin(beta), distance * np.cos(beta)

    def balls(unknowns):
        w_b, w_n = to_b @ unknowns, to_n @ unknowns
        sides = []
        for sign in (1.0, -1.0):
            b, n = lever[0] + sign * w_b, lever[1] + w_n
            length = np.hypot(b, n)
            approach = np.maximum(length - distance, 0.0)
            q = stiffness * approach**1.5
            sides.append((sign * b / length, n / length, q, approach, length))
        return sides

    def energy(u):
        stored = sum(0.4 * stiffness * (a**2.5).sum() for *_, a, _ in balls(u))
        return stored + 0.5 * u @ (chains @ u) - load @ u

    def gradient(u):
        g = chains @ u - load
        for m_b, m_n, q, *_ in balls(u):
            g = g + to_b.T @ (q * m_b) + to_n.T @ (q * m_n)
        return g

    def hessian(u):
        h = chains
        for m_b, m_n, q, approach, length in balls(u):
            along, turn = 1.5 * stiffness * np.sqrt(approach), q / length
            bb, bn, nn = (
                along * m_b * m_b + turn * (1 - m_b * m_b),
                (along - turn) * m_b * m_n,
                along * m_n * m_n + turn * (1 - m_n * m_n),
            )
            h = h + to_b.T @ sparse.diags(bb) @ to_b + to_n.T @ sparse.diags(nn) @ to_n
            cross = to_b.T @ sparse.diags(bn) @ to_n
            h = h + cross + cross.T
        return h

    start = np.zeros(size)
    start[0] = (load[0] / (count * stiffness * (np.sin(beta) * np.cos(alpha)) ** 2.5)) ** (2 / 3)
    return energy, gradient, hessian, start


def newton(gradient, hessian, u):
    """Find the minimum by Newton's method without a line search, using the sparse LU decomposition of SciPy."""
    for _ in range(60):
        g = gradient(u)
        if np.abs(g).max() < 1e-8:
            break
        u = u - sparse.linalg.spsolve(hessian(u).tocsc(), g)
    return u


def timed(solve, runs):
    times = []
    for _ in range(runs):
        begin = time.perf_counter()
        u = solve()
        times.append(time.perf_counter() - begin)
    return sorted(times)[runs // 2], u


def main():
    cases = json.load(open(sys.argv[1], encoding="utf-8"))
    print("| balls | solver | time | over ours | displacement off by |")
    print("|---|---|---|---|---|")
    for case in cases:
        ours, u_z = case["seconds"], case["displacement"][0]
        print(f"| {case['balls']} | bsm-nut, {case['steps']} steps | {1e6 * ours:.0f} us | 1 | |")
        if case["balls"] > 1000:
            continue
        energy, gradient, hessian, start = problem(case)
        solvers = {
            "Newton on SciPy's sparse LU": lambda: newton(gradient, hessian, start),
            "SciPy minimize trust-constr": lambda: optimize.minimize(
                energy, start, jac=gradient, hess=hessian, method="trust-constr",
                options={"gtol": 1e-8, "xtol": 1e-16, "maxiter": 300},
            ).x,
        }
        for name, solve in solvers.items():
            seconds, u = timed(solve, 5 if case["balls"] <= 100 else 1)
            off = abs(u[0] / u_z - 1)
            print(f"| {case['balls']} | {name} | {1e6 * seconds:.0f} us | {seconds / ours:.0f} | {off:.1e} |")


main()
