//! Tests that compare the program with published results, and documents with the code.

mod architecture;
mod documents;
mod equation_tags;
mod formulas;
mod published;
mod sources;
mod tradeoff;
