//! Which statistics are asked for, in words.

use std::fmt::{self, Display, Formatter};

use bsm_case::InputKey;

/// Most bins for each doubling of a value, and most rows at each end.
const MOST_BINS: u32 = 4096;
const MOST_ROWS: u32 = 10_000;

/// What is told of an output in place of its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statistic {
    /// The least value.
    Min,
    /// The greatest value.
    Max,
    /// The mean.
    Mean,
    /// How many values lie in each bin. The edges do not depend on the values: so many bins of equal width
    /// from each power of two to the next.
    Histogram {
        /// Bins for each doubling, a power of two.
        bins: u32,
    },
    /// The rows with the least and with the greatest values.
    Worst {
        /// How many at each end.
        rows: u32,
    },
}

impl Statistic {
    /// Parses `min`, `max`, `mean`, `histogram:BINS` or `worst:ROWS`.
    fn parse(text: &str) -> Option<Self> {
        let (word, number) = match text.split_once(':') {
            Some((word, number)) => (word, number.trim().parse::<u32>().ok()?),
            None => (text, 0),
        };
        match (word.trim(), number) {
            ("min", 0) => Some(Self::Min),
            ("max", 0) => Some(Self::Max),
            ("mean", 0) => Some(Self::Mean),
            ("histogram", bins @ 1..=MOST_BINS) if bins.is_power_of_two() => {
                Some(Self::Histogram { bins })
            }
            ("worst", rows @ 1..=MOST_ROWS) => Some(Self::Worst { rows }),
            _ => None,
        }
    }
}

/// The form that is read.
impl Display for Statistic {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Min => f.write_str("min"),
            Self::Max => f.write_str("max"),
            Self::Mean => f.write_str("mean"),
            Self::Histogram { bins } => write!(f, "histogram:{bins}"),
            Self::Worst { rows } => write!(f, "worst:{rows}"),
        }
    }
}

/// Which statistics, for which groups of rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reduction {
    /// What is told of each output that is a number.
    pub statistics: Vec<Statistic>,
    /// Inputs whose values make groups; none for one group of all rows.
    pub by: Vec<InputKey>,
}

impl Reduction {
    /// From the words of statistics and the names of inputs.
    ///
    /// # Errors
    ///
    /// What is wrong with a word, in words.
    pub fn parse(statistics: &[String], by: &[String]) -> Result<Self, String> {
        let mut this = Self { statistics: Vec::new(), by: Vec::new() };
        for text in statistics {
            let statistic = Statistic::parse(text.trim()).ok_or_else(|| {
                format!(
                    "`{text}` is none of min, max, mean, histogram:BINS (a power of two up to {MOST_BINS}: bins for \
                     each doubling of the value), worst:ROWS (1 to {MOST_ROWS})"
                )
            })?;
            let same = |other: &Statistic| {
                std::mem::discriminant(other) == std::mem::discriminant(&statistic)
            };
            if this.statistics.iter().any(same) {
                return Err(format!("`{text}` stands twice"));
            }
            this.statistics.push(statistic);
        }
        for name in by {
            let key = InputKey::named(name.trim()).map_err(|e| e.to_string())?;
            if this.by.contains(&key) {
                return Err(format!("`{name}` stands twice"));
            }
            this.by.push(key);
        }
        Ok(this)
    }

    /// Rows of the table of a group at most, of which each bin that has a value is one.
    pub(in crate::dataset) fn rows_of_a_group(&self, outputs: usize) -> f64 {
        /// Doublings that the values of an output span, nominally.
        const DOUBLINGS: f64 = 8.0;
        let rows = |statistic: &Statistic| match *statistic {
            Statistic::Min | Statistic::Max => 1.0,
            Statistic::Mean => 2.0,
            Statistic::Histogram { bins } => DOUBLINGS * f64::from(bins),
            Statistic::Worst { rows } => 2.0 * f64::from(rows),
        };
        #[expect(clippy::cast_precision_loss, reason = "there are some fifty")]
        let outputs = outputs as f64;
        2.0 + outputs * (1.0 + self.statistics.iter().map(rows).sum::<f64>())
    }

    pub(super) fn bits(&self) -> Option<u32> {
        self.statistics.iter().find_map(|statistic| match statistic {
            Statistic::Histogram { bins } => Some(bins.trailing_zeros()),
            _ => None,
        })
    }

    pub(super) fn outermost(&self) -> usize {
        let rows = self.statistics.iter().find_map(|statistic| match statistic {
            Statistic::Worst { rows } => usize::try_from(*rows).ok(),
            _ => None,
        });
        rows.unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_as_they_are_written() {
        let texts = ["min", "max", "mean", "histogram:64", "worst:10"].map(str::to_owned);
        let by = ["lead_mm".to_owned()];
        let read = Reduction::parse(&texts, &by).expect("a reduction");
        assert_eq!(read.statistics.iter().map(ToString::to_string).collect::<Vec<_>>(), texts);
        assert_eq!(read.by, [InputKey::lead_mm]);
        for (texts, by, part) in [
            ("median", "lead_mm", "`median` is none of min, max"),
            ("histogram:3", "lead_mm", "a power of two"),
            ("histogram", "lead_mm", "a power of two"),
            ("worst:0", "lead_mm", "1 to 10000"),
            ("min:2", "lead_mm", "none of"),
            ("min,min", "lead_mm", "`min` stands twice"),
            ("min", "leed_mm", "lead_mm"),
            ("min", "lead_mm,lead_mm", "`lead_mm` stands twice"),
        ] {
            let split = |text: &str| text.split(',').map(str::to_owned).collect::<Vec<_>>();
            let said = Reduction::parse(&split(texts), &split(by)).expect_err(texts);
            assert!(said.contains(part), "{said}");
        }
    }
}
