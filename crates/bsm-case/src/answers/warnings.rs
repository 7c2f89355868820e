//! Number of warnings about a solution, as a column of tables. The texts of the warnings are in the
//! column `message`.

use bsm_dyn::Solution;

use crate::vocabulary::number::count;
use crate::vocabulary::quantity::quantities;
use crate::{Case, Numbers, Record};

quantities! { pub(crate) QUANTITIES, read(&usize) of Warnings;
    "warnings" {
        warnings [""] Scalar(|number| Some(count(*number))),
            "number of warnings that bsm solve prints for this point; the column message contains their texts";
    }
}

/// Returns the number of warnings about a solution. [`Numbers::why`] contains the texts of the
/// warnings.
pub(crate) fn numbers(case: &Case, solution: &Solution) -> Numbers {
    let texts = Record::new(solution.clone()).all_warnings(case);
    read(&texts.len(), |_| true).with_reason((!texts.is_empty()).then(|| texts.join("; ")))
}
