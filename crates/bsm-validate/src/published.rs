//! The published data: compiled in, or from a folder.

use std::borrow::Cow;
use std::fs;
use std::path::Path;

use bsm_case::{Case, CaseError, Catalog};
use serde::Deserialize;

use crate::ValidateError;

/// A file of published data.
#[derive(Debug, Clone)]
pub(crate) struct File {
    name: &'static str,
    text: Cow<'static, str>,
}

impl File {
    /// Returns all rows of a table, which must not be empty.
    pub(crate) fn rows<T: for<'de> Deserialize<'de>>(&self) -> Result<Vec<T>, ValidateError> {
        let reader = csv::Reader::from_reader(self.text.as_bytes());
        let rows: Result<Vec<T>, _> = reader.into_deserialize().collect();
        let rows = rows.map_err(|error| ValidateError::of(self.name, error))?;
        if rows.is_empty() {
            let why = "the table has no rows, so nothing would be checked";
            return Err(ValidateError::of(self.name, why));
        }
        Ok(rows)
    }

    /// Returns the lists of a file.
    pub(crate) fn catalog(&self) -> Result<Catalog, ValidateError> {
        Catalog::from_json(self.text.as_bytes())
            .map_err(|error| ValidateError::of(self.name, error))
    }

    /// Returns the contents of a JSON file.
    pub(crate) fn json<T: for<'de> Deserialize<'de>>(&self) -> Result<T, ValidateError> {
        serde_json::from_str(&self.text)
            .map_err(|error| ValidateError::of(self.name, CaseError::Syntax(error)))
    }

    /// Returns the name.
    pub(crate) fn name(&self) -> &'static str {
        self.name
    }

    /// Returns the case of a file.
    pub(crate) fn case(&self) -> Result<Case, ValidateError> {
        Case::from_json(self.text.as_bytes()).map_err(|error| ValidateError::of(self.name, error))
    }
}

macro_rules! tables {
    ($($(#[$doc:meta])* $name:ident: $file:literal;)*) => {
        /// Cases and tables that the checks read.
        #[derive(Debug, Clone)]
        pub struct PublishedData {
            $($(#[$doc])* pub(crate) $name: File,)*
        }

        impl Default for PublishedData {
            /// Returns the data that are compiled in.
            fn default() -> Self {
                Self {
                    $($name: File {
                        name: $file,
                        text: Cow::Borrowed(include_str!(concat!(
                            "../../../validation/published/", $file
                        ))),
                    },)*
                }
            }
        }

        impl PublishedData {
            /// Paths of all files in the folder.
            pub const FILES: &[&str] = &[$($file),*];

            /// Reads the data of a folder with the layout of `validation/published`.
            ///
            /// # Errors
            ///
            /// [`ValidateError::File`] for a file that cannot be read.
            pub fn read(folder: &Path) -> Result<Self, ValidateError> {
                let read = |file: &str| {
                    let path = folder.join(file);
                    fs::read_to_string(&path).map_err(|error| ValidateError::File { path, error })
                };
                Ok(Self { $($name: File { name: $file, text: Cow::Owned(read($file)?) },)* })
            }
        }
    };
}

tables! {
    /// Checks given as rows.
    checks: "checks.csv";
    /// Lin's own case.
    lin_case: "lin1994/case.json";
    /// Statements of Lin, Velinsky and Ravani (1994) as numbers.
    lin_claims: "lin1994/claims.csv";
    /// The equations of Lin, Velinsky and Ravani (1994), solved with 40 digits.
    lin_reference: "lin1994/reference.csv";
    /// Independent solutions of elastic and traction.
    elastic_reference: "elastic-contacts/reference.csv";
    /// Lists of the design tables.
    parkon: "ratings/parkon.json";
    /// Rows of the design tables.
    rating_tables: "ratings/sobolewski.csv";
    /// Catalog rows with known balls, and independent estimates of their grooves.
    groove: "groove/public.json";
    /// Displacements of a ball bearing.
    nut_bearings: "nut/bearings.csv";
    /// Stiffness of nuts and pairs of a catalog.
    nut_stiffness: "nut/stiffness.csv";
    /// A feed axis in its warm steady state.
    feed_axis: "nut/feed_axis.json";
    /// The case of Xu and Tang (2015).
    xu_case: "xu2015/case.json";
    /// The trends of Xu and Tang (2015), with the number of curves on which they hold.
    xu_trends: "xu2015/trends.csv";
    /// The case of Dong et al. (2020).
    dong_case: "dong2020/case.json";
    /// The trends of Dong et al. (2020), with the number of curves on which they hold.
    dong_trends: "dong2020/trends.csv";
    /// A screw for the axes in examples of manufacturers.
    manufacturers_case: "manufacturers/case.json";
    /// A feed axis with the data of its catalog.
    machining_center: "manufacturers/machining_center.json";
    /// The same axis with load factors and oil.
    machining_center_oil: "manufacturers/machining_center_oil.json";
    /// A vertical axis with the data of its catalog.
    upright_axis: "manufacturers/upright_axis.json";
    /// Independent solutions of lubricated cases.
    lubrication: "lubrication/public.json";
}
