//! Times and results of other solvers, compared with the solver of this project, as a table and as
//! JSON.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::equations::Answer;

/// Largest difference between two results that counts as agreement.
/// The load at contact A' and the unknowns u and τ affect the balance equations only through the
/// inertia forces, which may be small. A residual of 1e-10 therefore causes errors of 1e-10 divided
/// by the dimensionless inertia forces in these three quantities. For this reason, their
/// differences are multiplied by the dimensionless inertia forces.
const AGREEMENT: f64 = 1e-8;

/// Relative difference in efficiency or in a load above which two answers count as different roots.
const SAME_ROOT: f64 = 1e-4;

/// Indices of quantities in an [`Answer`].
const UNLOADED_FLANK_LOAD: usize = 2;
const U: usize = 5;
const TAU: usize = 6;

/// Result that the solver of this project finds at a point.
#[derive(Debug)]
pub(crate) struct Reference {
    pub(crate) answer: Answer,
    /// Ratio of the inertia forces to the load, limited to 1.
    pub(crate) inertia: f64,
}

/// Time and answers of one compared solver.
#[derive(Debug, Deserialize)]
pub(crate) struct Peer {
    pub(crate) name: String,
    pub(crate) ns_per_point: f64,
    /// Answer at each point; `None` if the solver found no root.
    pub(crate) answers: Vec<Option<Answer>>,
}

/// Results of the solvers that run in Python.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct Python {
    pub(crate) peers: Vec<Peer>,
    /// Solvers that could not run, with reasons.
    pub(crate) missing: Vec<String>,
    /// Names and versions of the libraries that were used.
    pub(crate) versions: Vec<String>,
}

/// A line of the table, which contains the results of one solver.
#[derive(Debug, Serialize)]
struct Line {
    peer: String,
    ns_per_point: f64,
    over_batch: f64,
    over_nalgebra: f64,
    share_solved: f64,
    /// Number of points at which the compared solver found a different root than the solver of this
    /// project.
    other_answers: usize,
    /// Largest relative difference in the efficiency and in the loads at contacts A and B, and
    /// largest difference in the unknowns p and s.
    worst_loaded: f64,
    /// Largest relative difference in the load at contact A', and largest difference in u and τ.
    worst_inertial: f64,
    /// Largest of the differences in `worst_inertial`, after each difference has been multiplied by
    /// the ratio of inertia forces to load at its point.
    worst_inertial_scaled: f64,
    agrees: bool,
}

/// All lines of the table, and the solvers that did not run.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    points: usize,
    lines: Vec<Line>,
    missing: Vec<String>,
    versions: Vec<String>,
}

impl Report {
    /// Compares all solvers with the reference. Ratios refer to the times of the entries named
    /// `batch` and `newton`.
    ///
    /// * `may_differ`: true if a compared solver is permitted to find another root.
    pub(crate) fn of(
        peers: &[Peer],
        reference: &[Reference],
        (batch, newton): (&str, &str),
        may_differ: bool,
        python: Python,
    ) -> Self {
        let time =
            |name| peers.iter().find(|p| p.name == name).map_or(f64::NAN, |p| p.ns_per_point);
        let lines = peers.iter().chain(&python.peers).map(|peer| {
            let worst = Worst::of(&peer.answers, reference);
            let solved = peer.answers.iter().flatten().count() - worst.other_answers;
            Line {
                peer: peer.name.clone(),
                ns_per_point: peer.ns_per_point,
                over_batch: peer.ns_per_point / time(batch),
                over_nalgebra: peer.ns_per_point / time(newton),
                share_solved: share(solved, reference.len()),
                other_answers: worst.other_answers,
                worst_loaded: worst.loaded,
                worst_inertial: worst.inertial,
                worst_inertial_scaled: worst.inertial_scaled,
                agrees: peer.answers.len() == reference.len()
                    && solved > 0
                    && worst.loaded <= AGREEMENT
                    // If contact A' hardly slides, u and τ cannot be calculated accurately from the
                    // slip at A', which is an output.
                    && (may_differ
                        || worst.inertial_scaled <= AGREEMENT && worst.other_answers == 0),
            }
        });
        Self {
            points: reference.len(),
            lines: lines.collect(),
            missing: python.missing,
            versions: python.versions,
        }
    }

    /// Returns true if every solver agrees with the reference at all points where it found a root.
    pub(crate) fn agrees(&self) -> bool {
        self.lines.iter().all(|line| line.agrees)
    }
}

#[expect(clippy::cast_precision_loss, reason = "counts of points are small")]
fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole as f64
}

/// Largest differences over all points at which a solver found an answer.
#[derive(Default)]
struct Worst {
    loaded: f64,
    inertial: f64,
    inertial_scaled: f64,
    other_answers: usize,
}

impl Worst {
    fn of(answers: &[Option<Answer>], reference: &[Reference]) -> Self {
        let mut worst = Self::default();
        for (answer, reference) in answers.iter().zip(reference) {
            let Some(answer) = answer else { continue };
            let mut here = Self::default();
            for (i, (theirs, ours)) in answer.iter().zip(&reference.answer).enumerate() {
                let size =
                    if i <= UNLOADED_FLANK_LOAD + 1 { ours.abs() } else { ours.abs().max(1.0) };
                let off = (theirs - ours).abs() / size;
                // A difference that is NaN counts as infinite.
                let off = if off.is_nan() { f64::INFINITY } else { off };
                if [UNLOADED_FLANK_LOAD, U, TAU].contains(&i) {
                    here.inertial = here.inertial.max(off);
                    here.inertial_scaled = here.inertial_scaled.max(off * reference.inertia);
                } else {
                    here.loaded = here.loaded.max(off);
                }
            }
            let apart = |i: usize| (answer[i] / reference.answer[i] - 1.0).abs();
            // The answer counts as a different root if its efficiency or its load at contact A or B
            // differs from the reference. An answer whose difference is NaN also counts as a
            // different root.
            if ![0, 1, 3].into_iter().all(|i| apart(i) <= SAME_ROOT) {
                worst.other_answers += 1;
                continue;
            }
            worst.loaded = worst.loaded.max(here.loaded);
            worst.inertial = worst.inertial.max(here.inertial);
            worst.inertial_scaled = worst.inertial_scaled.max(here.inertial_scaled);
        }
        worst
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} points", self.points)?;
        writeln!(f)?;
        writeln!(
            f,
            "| solver | ns/point | ratio to bsm batch, 1 thread | ratio to Newton on nalgebra | solved | \
             other answers | worst η, Q_A, Q_B, p, s | worst Q_A', u, τ | worst Q_A', u, τ × inertia | agrees |"
        )?;
        writeln!(f, "|---|---:|---:|---:|---:|---:|---:|---:|---:|---|")?;
        for line in &self.lines {
            writeln!(
                f,
                "| {} | {:.0} | {:.2} | {:.2} | {:.2} % | {} | {:.0e} | {:.0e} | {:.0e} | {} |",
                line.peer,
                line.ns_per_point,
                line.over_batch,
                line.over_nalgebra,
                100.0 * line.share_solved,
                line.other_answers,
                line.worst_loaded,
                line.worst_inertial,
                line.worst_inertial_scaled,
                if line.agrees { "yes" } else { "NO" },
            )?;
        }
        for missing in &self.missing {
            writeln!(f, "missing: {missing}")?;
        }
        if !self.versions.is_empty() {
            writeln!(f, "with {}", self.versions.join(", "))?;
        }
        Ok(())
    }
}
