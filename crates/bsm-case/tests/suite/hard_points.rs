//! Tests of operating points that were difficult for the `traction` model. The points are stored as
//! cases in `validation/hard`, and the description of each case states the difficulty. `bsm solve`
//! can also solve these cases.

use std::f64::consts::FRAC_PI_2;
use std::fs;
use std::path::Path;

use bsm_case::Case;
use bsm_dyn::{Evidence, Model, ModelWorkspace, Reason, Solution, Status};

/// Solves all cases in a folder and returns their names and solutions.
fn solve_cases_in_folder(folder: &str) -> Vec<(String, Solution)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/hard").join(folder);
    let mut work = ModelWorkspace::default();
    let answer = |entry: Result<fs::DirEntry, _>| {
        let path = entry.expect("folder entry").path();
        let problem = Case::read(&path).and_then(|case| case.problem(&Model::Traction.into()));
        (path.display().to_string(), problem.expect("a complete case").solve(&mut work))
    };
    fs::read_dir(folder).expect("cases").map(answer).collect()
}

/// Test campaigns with extreme inputs found these points. Earlier versions gave no result for them,
/// gave a power balance that was dominated by rounding errors, or found no solution although points
/// at lower and higher speeds were solved.
#[test]
fn points_that_failed_in_earlier_versions_are_solved() {
    let answers = solve_cases_in_folder("solved");
    assert_eq!(answers.len(), 14);
    for (name, solution) in answers {
        assert_eq!(solution.status(), Status::Converged, "{name}: {:?}", solution.reason());
    }
}

/// The point in the folder `off_branch` has a solution, which was found by a search from many
/// random starting points. The solver misses this solution: the branch of states that begins at
/// small inertia ends before this point, and other branches are not searched.
#[test]
fn root_on_an_untraced_branch_is_missed_but_not_excluded_by_proof() {
    let answers = solve_cases_in_folder("off_branch");
    assert_eq!(answers.len(), 1);
    for (name, solution) in answers {
        let evidence = solution.evidence();
        assert!(matches!(evidence, Some(Evidence::Traced { .. })), "{name}: {solution:?}");
    }
}

/// At the operating points in the folder `no_solution`, the balls are pressed out of their grooves,
/// or friction moves the balls off their flanks.
#[test]
fn balls_that_leave_their_flanks_have_no_solution() {
    let answers = solve_cases_in_folder("no_solution");
    assert_eq!(answers.len(), 3);
    for (name, solution) in answers {
        assert_eq!(solution.status(), Status::NoSolution, "{name}: {solution:?}");
        let Some(Reason::BallLeavesFlank { screw, .. }) = solution.reason() else {
            panic!("{name}: {solution:?}")
        };
        assert!(*screw > FRAC_PI_2, "{name}: {screw}");
    }
}
