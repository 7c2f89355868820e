//! Drawing functions of a program that was built without the feature `plot`. Each function returns
//! an error.

use crate::{Figure, Map, ReportError};

impl Figure {
    /// Returns [`ReportError::NotBuilt`].
    ///
    /// # Errors
    ///
    /// Always returns [`ReportError::NotBuilt`].
    pub fn svg(&self) -> Result<String, ReportError> {
        Err(ReportError::NotBuilt)
    }

    /// Returns [`ReportError::NotBuilt`].
    ///
    /// # Errors
    ///
    /// Always returns [`ReportError::NotBuilt`].
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        Err(ReportError::NotBuilt)
    }

    /// Returns [`ReportError::NotBuilt`].
    ///
    /// # Errors
    ///
    /// Always returns [`ReportError::NotBuilt`].
    pub fn inline_svg(&self) -> Result<String, ReportError> {
        Err(ReportError::NotBuilt)
    }
}

impl Map {
    /// Returns [`ReportError::NotBuilt`].
    ///
    /// # Errors
    ///
    /// Always returns [`ReportError::NotBuilt`].
    pub fn svg(&self) -> Result<String, ReportError> {
        Err(ReportError::NotBuilt)
    }

    /// Returns [`ReportError::NotBuilt`].
    ///
    /// # Errors
    ///
    /// Always returns [`ReportError::NotBuilt`].
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        Err(ReportError::NotBuilt)
    }
}
