//! Tests of published results, and of documents that must agree with the code.

mod architecture;
mod documents;
mod equation_tags;
mod formulas;
mod published;
mod sources;
mod tradeoff;
