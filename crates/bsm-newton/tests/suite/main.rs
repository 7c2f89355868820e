//! Tests of Newton's method, brackets, continuation and matrices on standard problems.

mod bracket;
mod linear;
mod path;
mod standard_problems;
