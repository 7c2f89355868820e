/* The rigid equations of rigid.py in C for a compiled solver: conversion of inputs, residual and outputs. */

#include <math.h>

typedef struct {
    double friction, radius, arc, cos_a, sin_b, cos_b, sin_2b, cos_2b, k[3];
    double mu, inertia, nut_speed, load, weights[7];
} Case;

static Case c;

/* Converts from user units, and writes the first-order starting point to y. */
void set_up(const double *point, double *y)
{
    const double pi = acos(-1.0), deg = pi / 180.0;
    const double r_b = 0.5e-3 * point[0], r_m = 0.5e-3 * point[1], f = point[4];
    const double speed = point[6] - point[7], w = speed * pi / 30.0, sign = copysign(1.0, w);
    const double sin_a = sin(point[2] * deg), cos_a = cos(point[2] * deg), tan_a = sin_a / cos_a;
    c.sin_b = sin(point[3] * deg);
    c.cos_b = cos(point[3] * deg);
    c.sin_2b = 2.0 * c.sin_b * c.cos_b;
    c.cos_2b = (c.cos_b - c.sin_b) * (c.cos_b + c.sin_b);
    c.cos_a = cos_a;
    c.k[0] = sin_a;
    c.k[1] = cos_a * c.sin_b;
    c.k[2] = cos_a * c.cos_b;
    c.load = point[8] / point[9];
    c.radius = r_m / r_b;
    c.arc = c.radius / cos_a;
    c.friction = f * sign;
    c.mu = 4.0 / 3.0 * pi * r_b * r_b * r_b * point[5] * r_m * w * w / c.load;
    c.inertia = 0.4 * c.mu / c.radius;
    c.nut_speed = point[7] / speed;

    const double d = sqrt(c.cos_b * c.cos_b + tan_a * tan_a);
    const double sin_psi = tan_a / d, cos_psi = c.cos_b / d;
    const double lever = cos_a * c.cos_b + sin_a * tan_a / c.cos_b;
    const double p = 0.5 - 0.5 * cos_a * lever / c.radius, rate = p + c.nut_speed;
    const double push = c.sin_b - c.friction * d, h = copysign(1.0, rate) * sign;
    const double unloaded = push / (c.sin_2b - c.friction * (c.cos_2b + h * sin_psi) / cos_psi);
    const double margin = p * tan_a - 2.5 * f * c.sin_2b * unloaded * fabs(rate);
    y[0] = y[2] = 1.0 / (cos_a * push);
    y[1] = unloaded * c.mu * rate * rate;
    y[3] = p;
    y[4] = -margin * c.radius / lever;
    y[5] = -y[4] * sin_psi / cos_psi - p * c.arc;
    y[6] = -2.0 * c.friction * y[0] / (d * cos_a);

    for (int i = 0; i < 7; i++)
        c.weights[i] = 1.0 / fmax(1.0, c.mu);
    c.weights[4] = 1.0 / (c.mu * fmax(1.0, rate * rate) * fmin(1.0, fabs(rate)));
}

typedef struct {
    double t, x;
} Force;

static Force friction_force(double load, double along, double across)
{
    const double force = c.friction * load / sqrt(along * along + across * across);
    return (Force){force * along, force * across};
}

static Force at_screw(const double *y)
{
    return friction_force(y[2], c.arc * (y[3] - 1.0) - y[5] + c.k[2], y[4] - c.k[0]);
}

/* Calculates the weighted residual. */
void residual(const double *y, double *r)
{
    const double q_a = y[0], q_m = y[1], q_b = y[2], p = y[3], u = y[4], tau = y[5], s = y[6];
    const double rate = p + c.nut_speed, gyro = c.inertia * rate;
    const Force a = friction_force(q_a, c.arc * p + tau, -u), b = at_screw(y);
    const Force m = friction_force(q_m, c.arc * p + tau * c.cos_2b + s * c.sin_2b / gyro, -u);
    const double unloaded_n = c.cos_2b * q_m - c.sin_2b * m.x;
    const double unloaded_e = -c.sin_2b * q_m - c.cos_2b * m.x;
    const double centrifugal = c.mu * rate * rate;
    r[0] = -(a.t + m.t + b.t);
    r[1] = q_a - q_b + unloaded_n - centrifugal * c.cos_b;
    r[2] = -(a.x + b.x) + unloaded_e + centrifugal * c.sin_b;
    r[3] = a.x + m.x - b.x + c.k[2] * s - gyro * c.k[1] * tau;
    r[4] = -c.sin_2b * m.t + gyro * (c.k[0] * tau - c.k[2] * u);
    r[5] = -(a.t + c.cos_2b * m.t - b.t) + gyro * c.k[1] * u - c.k[0] * s;
    r[6] = -c.k[0] * (a.t + m.t) + c.k[1] * (q_a + unloaded_n) + c.k[2] * (unloaded_e - a.x) - 1.0;
    for (int i = 0; i < 7; i++)
        r[i] *= c.weights[i];
}

/* Writes efficiency and loads to out, and returns whether the root is physical. */
int answer(const double *y, double *out)
{
    const double limit = 10.0 * c.arc;
    const Force b = at_screw(y);
    const double torque = c.k[0] * (c.radius * c.sin_b * y[2] + (c.radius * c.cos_b - 1.0) * b.x)
                          + c.cos_a * (c.cos_b - c.radius) * b.t;
    const double ideal = c.radius * c.k[0] / c.cos_a;
    out[0] = c.friction > 0.0 ? ideal / torque : torque / ideal;
    for (int i = 0; i < 3; i++)
        out[1 + i] = y[i] * c.load;
    for (int i = 3; i < 7; i++)
        out[1 + i] = y[i];
    return y[0] > 0.0 && y[1] > 0.0 && y[2] > 0.0 && fabs(y[3]) < limit && fabs(y[4]) < limit
           && fabs(y[5]) < limit;
}
