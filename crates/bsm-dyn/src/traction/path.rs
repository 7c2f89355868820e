#![allow(warnings)]
//! experiment
use std::f64::consts::FRAC_PI_2;

use bsm_newton::implicit_slopes;

use super::*;

const PATH: usize = BALL + 1;

/// What the path met.
#[derive(Debug, Clone)]
pub(super) enum End {
    Guess(Reason),
    First(Reason),
    Creep(f64),
    Friction(f64, [f64; 2]),
    Rate(f64, f64, [f64; 2]),
    Left([f64; 2], &'static str),
}

#[derive(Default)]
pub(super) struct Trace {
    pub(super) steps: usize,
    pub(super) points: usize,
    pub(super) other: bool,
    pub(super) static_angles: [f64; 2],
    pub(super) static_rate: f64,
}

#[derive(Clone, Copy)]
enum Along {
    Friction,
    Rate { unit: f64 },
}

struct Path<'a> {
    at: &'a Rolling<'a>,
    along: Along,
    /// The prediction and the direction of the path, over the scale of each unknown.
    from: [f64; PATH],
    towards: [f64; PATH],
}

impl Along {
    /// Friction and rate, and their derivative by u
    fn at(self, friction: f64, u: f64) -> ([f64; 2], [f64; 2]) {
        match self {
            Self::Friction => ([u.exp(), 0.0], [u.exp(), 0.0]),
            Self::Rate { unit } => ([friction, unit * u.sinh()], [0.0, unit * u.cosh()]),
        }
    }
}

impl Path<'_> {
    fn residual<D: Lanes<f64>>(&self, z: &[D; PATH]) -> Result<[D; PATH], EvalError> {
        let y: [D; BALL] = std::array::from_fn(|i| z[i]);
        let u = z[BALL];
        let ([friction, rate], slope) = self.along.at(self.at.pair.friction, u.re());
        let du = u - u.re();
        let friction = du * slope[0] + friction;
        let rate = du * slope[1] + rate;
        let state = self.at.rubbed(&y, friction)?;
        let left = self.at.left(&y, &state, rate);
        let mut plane = D::from(0.0);
        for (i, z) in z.iter().enumerate() {
            plane += (*z - self.from[i]) * self.towards[i];
        }
        Ok(std::array::from_fn(|i| if i < BALL { left[i] } else { plane }))
    }

    /// Direction of the path at a point.
    fn tangent(&self, z: &[f64; PATH], newton: &mut Workspace) -> Option<[f64; PATH]> {
        let mut column = [0.0; PATH];
        column[BALL] = -1.0;
        let status = implicit_slopes(self, z, &self.weights(z), &mut column, newton).expect("sizes");
        let sign = newton.orientation();
        (status == bsm_newton::Status::Converged).then_some(column.map(|x| x * sign))
    }

    fn weights(&self, z: &[f64; PATH]) -> [f64; PATH] {
        let y: [f64; BALL] = std::array::from_fn(|i| z[i]);
        let ([friction, rate], _) = self.along.at(self.at.pair.friction, z[BALL]);
        let weights = self.at.weights_of(&y, friction, rate);
        std::array::from_fn(|i| if i < BALL { weights[i] } else { 1.0 })
    }

    fn run(&self, z: &mut [f64; PATH], newton: &mut Workspace) -> Report {
        let weights = self.weights(z);
        let scales = Scales { x: &[1.0; PATH], f: &weights };
        let options = Options { residual_tol: 1e-8, residual_goal: 1e-8, max_steps: self.at.most_steps(), ..Options::default() };
        solve(self, z, &scales, &options, newton).expect("sizes")
    }
}

impl System for Path<'_> {
    fn dim(&self) -> usize {
        PATH
    }

    fn residual(&self, x: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r.copy_from_slice(&Path::residual(self, x.try_into().expect("eight unknowns"))?);
        Ok(())
    }

    fn linearize(&self, x: &[f64], r: &mut [f64], jac: MatMut<'_, f64>) -> Result<(), EvalError> {
        linearize(|y| Path::residual(self, &y), x, r, jac)
    }

    fn equation(&self, i: usize) -> String {
        if i < BALL { layout::equation(i).to_owned() } else { "path".to_owned() }
    }
}

fn on_flanks(angles: [f64; 2]) -> bool {
    angles.iter().all(|a| (0.0..FRAC_PI_2).contains(a))
}

impl Rolling<'_> {
    pub(super) fn angles(&self, y: &[f64; BALL]) -> [f64; 2] {
        self.state(y).map_or([f64::NAN; 2], |s| s.loaded.angles)
    }

    fn rate(&self, y: &[f64; BALL]) -> f64 {
        y[PRECESSION] + self.offset()
    }

    fn most_steps(&self) -> usize { if self.creep > 0.5 { 50 } else { 10 } }

    /// Follows; `event` is what changes its sign where the path is to be left, `land` solves there
    /// and says whether to stop.
    fn track(
        &self,
        along: Along,
        z: &mut [f64; PATH],
        first: f64,
        trace: &mut Trace,
        newton: &mut Workspace,
        event: impl Fn(&[f64; PATH]) -> f64,
        mut land: impl FnMut(&mut [f64; BALL]) -> (bool, bool, usize),
        ends: impl Fn(&[f64; PATH]) -> bool,
    ) -> bool {
        let mut length = first;
        let mut direction = [0.0; PATH];
        direction[BALL] = 1.0;
        let start = Path { at: self, along, from: *z, towards: direction };
        let Some(tangent) = start.tangent(z, newton) else { return false };
        // u grows first.
        let oriented = tangent[BALL].signum();
        direction = tangent.map(|x| x * oriented);
        for _ in 0..2000 {
            trace.points += 1;
            let scale: [f64; PATH] = std::array::from_fn(|i| if i == BALL { 1.0 } else { 1.0 + z[i].abs() });
            // direction is d z/ds with |d z / scale| = 1
            let norm = (0..PATH).map(|i| (direction[i] / scale[i]).powi(2)).sum::<f64>().sqrt();
            for d in &mut direction { *d /= norm; }
            let from: [f64; PATH] = std::array::from_fn(|i| z[i] + length * direction[i]);
            let towards = std::array::from_fn(|i| direction[i] / scale[i].powi(2));
            let path = Path { at: self, along, from, towards };
            let mut next = from;
            let report = path.run(&mut next, newton);
            trace.steps += report.steps.len();
            let moved: [f64; PATH] = std::array::from_fn(|i| next[i] - z[i]);
            let distance = (0..PATH).map(|i| (moved[i] / scale[i]).powi(2)).sum::<f64>().sqrt();
            let cosine = (0..PATH).map(|i| moved[i] * towards[i]).sum::<f64>() / distance;
            let tangent = if report.converged() { path.tangent(&next, newton) } else { None };
            let calm = report.converged() && cosine > 0.9 && tangent.is_some();
            if !calm {
                length *= 0.5;
                if length < 1e-7 {
                    if std::env::var("VERBOSE").is_ok() { println!("   {:?} {:.2e} {} lambda {:?} {:?} cos {cosine} z {z:?} dir {direction:?}", report.status, report.residual, report.worst_equation_name, report.steps.iter().map(|s| (s.residual as f32, s.lambda as f32)).collect::<Vec<_>>(), report.refusal); }
                    return false;
                }
                continue;
            }
            let (before, after) = (event(z), event(&next));
            if before * after <= 0.0 && before != 0.0 {
                let t = before / (before - after);
                let mut y = std::array::from_fn(|i| z[i] + t * moved[i]);
                let guess: [f64; BALL] = y;
                let (converged, stop, steps) = land(&mut y);
                trace.steps += steps;
                let off = (0..BALL).map(|i| ((y[i] - guess[i]) / scale[i]).powi(2)).sum::<f64>().sqrt();
                if !converged || off > distance {
                    length = 0.3 * distance;
                    if length < 1e-7 { return false; }
                    continue;
                }
                if stop {
                    z[..BALL].copy_from_slice(&y);
                    return true;
                }
            }
            *z = next;
            direction = tangent.expect("calm").map(|x| x * oriented);
            length = distance * if report.steps.len() <= 4 { 1.6 } else if report.steps.len() > 7 { 0.7 } else { 1.0 };
            length = length.min(1.0);
            if std::env::var("SHOW").is_ok() { let y: [f64; BALL] = std::array::from_fn(|i| z[i]); let held = along.at(self.pair.friction, z[BALL]).0[1]; println!("  {:3} P^ {held:.3e} P {:.3e} loads {:.3e} {:.3e} omega {:.2e} {:.2e} {:.2e} angles {:.3?}", trace.points, self.rate(&y), y[0], y[2], y[4], y[5], y[6], self.angles(&y)); }
            if ends(z) {
                return true;
            }
        }
        false
    }

    pub(super) fn show(&self, y: &[f64; BALL], sign: f64) {
        let mut wide = Workspace::new(PATH);
        let (rate, mu) = (self.rate(y), self.pair.inertia_ratio());
        let unit = rate.signum() * rate.abs().min((0.1 / mu).sqrt()).min(self.pair.friction / mu);
        let mut z = [0.0; PATH];
        z[..BALL].copy_from_slice(y);
        z[BALL] = (rate / unit).asinh();
        let mut trace = Trace::default();
        let mut n = std::cell::Cell::new(0);
        // reversed: u -> -u
        z[BALL] *= sign;
        let along = Along::Rate { unit: unit * sign };
        let ok = self.track(along, &mut z, 0.1, &mut trace, &mut wide, |_| 1.0, |y| (true, false, 0), |z| {
            let y: [f64; BALL] = std::array::from_fn(|i| z[i]);
            n.set(n.get() + 1);
            let held = unit * sign * z[BALL].sinh();
            if n.get() % 3 == 0 { println!("  {:3} P^ {held:.3e} c {:.2e} P {:.3e} loads {:.3e} {:.3e} omega {:.2e} {:.2e} {:.2e} angles {:.3?}", n.get(), mu * held * held, self.rate(&y), y[0], y[2], y[4], y[5], y[6], self.angles(&y)); }
            n.get() > 150 || !self.angles(&y).iter().all(|a| (-1.2..FRAC_PI_2 + 1.2).contains(a))
        });
        println!("  ended {ok} after {}", n.get());
    }

    pub(super) fn followed(&self, newton: &mut Workspace, trace: &mut Trace) -> Result<([f64; BALL], f64), End> {
        let still = self.pair.with_inertia(0.0);
        let guess = Grip::guess(&still).map_err(|e| End::Guess(e.1))?;
        let mut y = self.unknowns(&guess.loaded, &guess.to_nut);
        let faint = self.pair.friction.min(1e-3);
        let begin = 10.0 * self.lever(&y);
        let mut last = None;
        let stride = Stride { first: 2.0, shortest: 1e-3 };
        let slow = self.pair.with_inertia(0.0);
        let mut steps = 0;
        let mut wide = Workspace::new(PATH);
        let mut z = [0.0; PATH];
        z[..BALL].copy_from_slice(&y);
        follow(&mut y, (begin.ln(), self.creep.ln()), stride, |log, y| {
            let at = Rolling { pair: &slow, creep: log.exp(), ..*self };
            z[..BALL].copy_from_slice(y);
            z[BALL] = faint.ln();
            let mut towards = [0.0; PATH];
            towards[BALL] = 1.0;
            let path = Path { at: &at, along: Along::Friction, from: z, towards };
            let mut end = z;
            let r = path.run(&mut end, &mut wide);
            y.copy_from_slice(&end[..BALL]);
            steps += r.steps.len();
            let c = r.converged();
            last = Some(r);
            c
        }).map_err(|e| match e { None => {
            let r = last.take().unwrap();
            if std::env::var("VERBOSE").is_ok() { println!("   first {:?} {:.2e} {} lambda {:?} {:?} z {z:?} loads {:?} axes {:?} angles {:?}", r.status, r.residual, r.worst_equation_name, r.steps.iter().map(|s| (s.residual as f32, s.lambda as f32)).collect::<Vec<_>>(), r.refusal, guess.loaded.loads, self.pair.semi_axes, guess.loaded.angles); }
            End::First(Reason::from(r))
        }, Some(x) => End::Creep(x) })?;
        trace.steps = steps;
        z[..BALL].copy_from_slice(&y);
        z[BALL] = faint.ln();
        let goal = self.pair.friction.ln();
        let outside = |z: &[f64; PATH], margin: f64| {
            let y: [f64; BALL] = std::array::from_fn(|i| z[i]);
            !self.angles(&y).iter().all(|a| (-margin..FRAC_PI_2 + margin).contains(a))
        };
        if faint < self.pair.friction {
            let ok = self.track(Along::Friction, &mut z, 0.5, trace, &mut wide, |z| z[BALL] - goal, |y| {
                let at = Rolling { pair: &slow, ..*self };
                let r = at.run(y, newton);
                (r.converged(), true, r.steps.len())
            }, |z| outside(z, 1.2) || z[BALL] < faint.ln() - 2.0);
            y.copy_from_slice(&z[..BALL]);
            let angles = self.angles(&y);
            if !ok {
                return Err(if outside(&z, 0.0) { End::Left(angles, "friction stops") } else { End::Friction(z[BALL].exp() / self.pair.friction, angles) });
            }
            if outside(&z, 1.2) { return Err(End::Left(angles, "friction far")); }
        }
        trace.static_angles = self.angles(&y);
        trace.static_rate = self.rate(&y);
        let (rate, mu) = (self.rate(&y), self.pair.inertia_ratio());
        let unit = rate.signum() * rate.abs().min((0.1 / mu).sqrt()).min(self.pair.friction / mu);
        let most = 2.0 * (1.0 + self.pair.nut_speed.abs());
        let at = |u: f64| unit * u.sinh();
        let mut left = None;
        let mut residual = 0.0;
        let begin = y;
        let mut result = Err(End::Left([0.0; 2], "?"));
        for sign in [1.0, -1.0] {
            z[..BALL].copy_from_slice(&begin);
            z[BALL] = 0.0;
            let ok = self.track(Along::Rate { unit: sign * unit }, &mut z, (rate / unit).asinh().min(1.0), trace, &mut wide, |z| {
                let y: [f64; BALL] = std::array::from_fn(|i| z[i]);
                self.rate(&y) - sign * at(z[BALL])
            }, |y| {
                let r = self.run(y, newton);
                residual = r.residual;
                let angles = self.angles(y);
                let stop = r.converged() && on_flanks(angles);
                if r.converged() && !stop && left.is_none() { left = Some(angles); }
                (r.converged(), stop, r.steps.len())
            }, |z| outside(z, 1.2) || at(z[BALL]).abs() > most);
            y.copy_from_slice(&z[..BALL]);
            let angles = self.angles(&y);
            let end = sign * at(z[BALL]);
            if !ok {
                let e = if outside(&z, 0.0) { End::Left(left.unwrap_or(angles), if left.is_some() { "root" } else { "stops" }) } else { End::Rate(end, self.rate(&y), angles) };
                if sign > 0.0 { result = Err(e); }
            }
            else if outside(&z, 1.2) { if sign > 0.0 { result = Err(End::Left(left.unwrap_or(angles), if left.is_some() { "root" } else { "far" })); }}
            else if end.abs() > most { if sign > 0.0 { result = Err(match left { Some(x) => End::Left(x, "root"), None => End::Rate(end, self.rate(&y), angles) }); }}
            else { trace.other = sign < 0.0; return Ok((y, residual)); }
        }
        return result;
        Ok((y, residual))
    }
}
