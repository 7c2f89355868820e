"""Equations of the rigid model, for Python floats (`m` is the module math) and for JAX (`m` is jax.numpy).

The equations are those of docs/theory/04-rigid.md with the unknowns Q_A/F_a, Q_A'/F_a, Q_B/F_a, p, u, tau, s.
Speeds are divided by W including its sign, so driving and back-driving differ only in the sign of the friction.
"""

from typing import Any, NamedTuple

TOLERANCE = 1e-10
MOST_STEPS = 8


class Case(NamedTuple):
    """An operating point in dimensionless form, scaled by ball radius, axial load and relative speed W."""

    friction: Any
    radius: Any
    arc: Any
    cos_a: Any
    sin_b: Any
    cos_b: Any
    sin_2b: Any
    cos_2b: Any
    k: tuple
    mu: Any
    inertia: Any
    nut_speed: Any
    load: Any
    weights: tuple
    start: tuple


def larger(a, b):
    return 0.5 * (a + b + abs(a - b))


def case(point, m):
    """Convert an operating point from user units, and add the weights of the equations and the starting point."""
    ball_mm, pitch_mm, lead_deg, contact_deg, f, density, screw_rpm, nut_rpm, axial, balls = point
    r_b, r_m, deg = 0.5e-3 * ball_mm, 0.5e-3 * pitch_mm, m.pi / 180.0
    sin_a, cos_a = m.sin(lead_deg * deg), m.cos(lead_deg * deg)
    sin_b, cos_b = m.sin(contact_deg * deg), m.cos(contact_deg * deg)
    sin_2b, cos_2b = 2.0 * sin_b * cos_b, (cos_b - sin_b) * (cos_b + sin_b)
    speed = screw_rpm - nut_rpm
    sign, w, nut_speed = m.copysign(1.0, speed), speed * m.pi / 30.0, nut_rpm / speed
    load = axial / balls
    radius, friction = r_m / r_b, f * sign
    mu = 4.0 / 3.0 * m.pi * r_b * r_b * r_b * density * r_m * w * w / load
    arc, tan_a = radius / cos_a, sin_a / cos_a

    d = m.sqrt(cos_b * cos_b + tan_a * tan_a)
    sin_psi, cos_psi = tan_a / d, cos_b / d
    lever = cos_a * cos_b + sin_a * tan_a / cos_b
    p = 0.5 - 0.5 * cos_a * lever / radius
    rate = p + nut_speed
    push = sin_b - friction * d
    h = m.copysign(1.0, rate) * sign
    unloaded = push / (sin_2b - friction * (cos_2b + h * sin_psi) / cos_psi)
    margin = p * tan_a - 2.5 * f * sin_2b * unloaded * abs(rate)
    q = 1.0 / (cos_a * push)
    u = -margin * radius / lever
    tau = -u * sin_psi / cos_psi - p * arc
    s = -2.0 * friction * q / (d * cos_a)

    row = 1.0 / larger(1.0, mu)
    # min(1, |P/W|) = 1 / max(1, |W/P|)
    normal = larger(1.0, 1.0 / abs(rate)) / (mu * larger(1.0, rate * rate))
    return Case(
        friction, radius, arc, cos_a, sin_b, cos_b, sin_2b, cos_2b,
        (sin_a, cos_a * sin_b, cos_a * cos_b), mu, 0.4 * mu / radius, nut_speed, load,
        (row, row, row, row, normal, row, row), (q, unloaded * mu * rate * rate, q, p, u, tau, s),
    )  # fmt: skip


def friction_force(c, load, along, across, m):
    force = c.friction * load / m.sqrt(along * along + across * across)
    return force * along, force * across


def residual(c, y, m):
    """Return the residual, multiplied by the weights of the equations."""
    q_a, q_m, q_b, p, u, tau, s = y
    (k_t, k_n, k_e), rate = c.k, p + c.nut_speed
    gyro = c.inertia * rate
    a_t, a_e = friction_force(c, q_a, c.arc * p + tau, -u, m)
    m_t, m_x = friction_force(c, q_m, c.arc * p + tau * c.cos_2b + s * c.sin_2b / gyro, -u, m)
    b_t, b_e = friction_force(c, q_b, c.arc * (p - 1.0) - tau + k_e, u - k_t, m)
    unloaded_n, unloaded_e = c.cos_2b * q_m - c.sin_2b * m_x, -c.sin_2b * q_m - c.cos_2b * m_x
    centrifugal = c.mu * rate * rate
    rows = (
        -(a_t + m_t + b_t),
        q_a - q_b + unloaded_n - centrifugal * c.cos_b,
        -(a_e + b_e) + unloaded_e + centrifugal * c.sin_b,
        a_e + m_x - b_e + k_e * s - gyro * k_n * tau,
        -c.sin_2b * m_t + gyro * (k_t * tau - k_e * u),
        -(a_t + c.cos_2b * m_t - b_t) + gyro * k_n * u - k_t * s,
        -k_t * (a_t + m_t) + k_n * (q_a + unloaded_n) + k_e * (unloaded_e - a_e) - 1.0,
    )
    return tuple(w * r for w, r in zip(c.weights, rows))


def answer(c, y, m):
    """Return the efficiency, the loads of A, A' and B [N], p, u, tau and s, and whether the root is physical."""
    q_a, q_m, q_b, p, u, tau, s = y
    k_t, _, k_e = c.k
    b_t, b_e = friction_force(c, q_b, c.arc * (p - 1.0) - tau + k_e, u - k_t, m)
    torque = (
        k_t * (c.radius * c.sin_b * q_b + (c.radius * c.cos_b - 1.0) * b_e)
        + c.cos_a * (c.cos_b - c.radius) * b_t
    )
    # The efficiency is the ratio of ideal torque to torque or, for the other sign of W, the inverse ratio.
    efficiency = (c.radius * k_t / c.cos_a / torque) ** m.copysign(1.0, c.friction)
    limit = 10.0 * c.arc
    physical = (q_a > 0) & (q_m > 0) & (q_b > 0)
    physical &= (abs(p) < limit) & (abs(u) < limit) & (abs(tau) < limit)
    return (efficiency, q_a * c.load, q_m * c.load, q_b * c.load, p, u, tau, s), physical
