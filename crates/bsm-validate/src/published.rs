//! Published data, which are compiled into the program or read from a folder.

use std::borrow::Cow;
use std::fs;
use std::path::Path;

use bsm_case::{Case, CaseError, Catalog};
use serde::Deserialize;

use crate::ValidateError;

/// A file with published data.
#[derive(Debug, Clone)]
pub(crate) struct File {
    name: &'static str,
    text: Cow<'static, str>,
}

impl File {
    /// Returns all rows of a CSV table. A table without rows is an error.
    pub(crate) fn rows<T: for<'de> Deserialize<'de>>(&self) -> Result<Vec<T>, ValidateError> {
        let reader = csv::Reader::from_reader(self.text.as_bytes());
        let rows: Result<Vec<T>, _> = reader.into_deserialize().collect();
        let rows = rows.map_err(|error| ValidateError::of(self.name, error))?;
        if rows.is_empty() {
            let why = "the table contains no rows, so nothing would be checked";
            return Err(ValidateError::of(self.name, why));
        }
        Ok(rows)
    }

    /// Parses the file as a catalog, which consists of lists of sizes.
    pub(crate) fn catalog(&self) -> Result<Catalog, ValidateError> {
        Catalog::from_json(self.text.as_bytes())
            .map_err(|error| ValidateError::of(self.name, error))
    }

    /// Parses the file as JSON.
    pub(crate) fn json<T: for<'de> Deserialize<'de>>(&self) -> Result<T, ValidateError> {
        serde_json::from_str(&self.text)
            .map_err(|error| ValidateError::of(self.name, CaseError::Syntax(error)))
    }

    /// Returns the name of the file.
    pub(crate) fn name(&self) -> &'static str {
        self.name
    }

    /// Parses the file as a case.
    pub(crate) fn case(&self) -> Result<Case, ValidateError> {
        Case::from_json(self.text.as_bytes()).map_err(|error| ValidateError::of(self.name, error))
    }
}

macro_rules! tables {
    ($($(#[$doc:meta])* $name:ident: $file:literal;)*) => {
        /// Published cases and tables with which the checks compare calculated results.
        #[derive(Debug, Clone)]
        pub struct PublishedData {
            $($(#[$doc])* pub(crate) $name: File,)*
        }

        impl Default for PublishedData {
            /// Returns the data that are compiled into the program.
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
            /// Paths of all files, relative to the folder with the published data.
            pub const FILES: &[&str] = &[$($file),*];

            /// Reads the published data from a folder that has the same layout as
            /// `validation/published`.
            ///
            /// # Errors
            ///
            /// Returns [`ValidateError::File`] if a file cannot be read.
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
    /// Checks that are defined by the rows of a table.
    checks: "checks.csv";
    /// The example case of Lin, Velinsky and Ravani (1994).
    lin_case: "lin1994/case.json";
    /// Numbers that Lin, Velinsky and Ravani (1994) state in their paper.
    lin_claims: "lin1994/claims.csv";
    /// Solutions of the equations of Lin, Velinsky and Ravani (1994), which were calculated with 40
    /// digits.
    lin_reference: "lin1994/reference.csv";
    /// Solutions of the models `elastic` and `traction` from an independent program.
    elastic_reference: "elastic-contacts/reference.csv";
    /// Lists of standard sizes, which the tables of Sobolewski (2002) use.
    parkon: "ratings/parkon.json";
    /// Rows of the tables in Sobolewski (2002).
    rating_tables: "ratings/sobolewski.csv";
    /// Catalog rows with known ball diameters, and estimates of their grooves from an independent
    /// program.
    groove: "groove/public.json";
    /// Displacements of a ball bearing, calculated by a commercial program.
    nut_bearings: "nut/bearings.csv";
    /// Stiffness values of nuts and nut pairs from a catalog.
    nut_stiffness: "nut/stiffness.csv";
    /// Case of a feed axis in its warm steady state.
    feed_axis: "nut/feed_axis.json";
    /// Case in the paper of Xu and Tang (2015).
    xu_case: "xu2015/case.json";
    /// Trends in the paper of Xu and Tang (2015), with the number of curves that follow each trend.
    xu_trends: "xu2015/trends.csv";
    /// Case in the paper of Dong et al. (2020).
    dong_case: "dong2020/case.json";
    /// Trends in the paper of Dong et al. (2020), with the number of curves that follow each trend.
    dong_trends: "dong2020/trends.csv";
    /// Case of a screw that manufacturers use in examples of axes.
    manufacturers_case: "manufacturers/case.json";
    /// Case of a feed axis, with data from a catalog.
    machining_center: "manufacturers/machining_center.json";
    /// Case of a lubricated feed axis, with data and load factors from a catalog.
    machining_center_oil: "manufacturers/machining_center_oil.json";
    /// Case of a vertical axis, with data from a catalog.
    upright_axis: "manufacturers/upright_axis.json";
    /// Lubricated cases, and their solutions from an independent program.
    lubrication: "lubrication/public.json";
}
