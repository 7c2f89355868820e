//! Progress bars and spinners that are shown on a terminal.

use std::io::{self, IsTerminal};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{HumanCount, ProgressBar, ProgressState, ProgressStyle};

/// Returns a progress bar, which is hidden if standard error is not a terminal.
pub(crate) fn progress(total: Option<u64>, what: &str, quiet: bool) -> ProgressBar {
    if quiet || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let (bar, template) = match total {
        Some(total) => (
            ProgressBar::new(total),
            format!("{{wide_bar}} {{human_pos}}/{{human_len}} {what}, {{rate}}, {{eta}} left"),
        ),
        None => (ProgressBar::new_spinner(), format!("{{spinner}} {{human_pos}} {what}, {{rate}}")),
    };
    let style = ProgressStyle::with_template(&template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("rate", |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            // Errors while drawing the bar are ignored.
            let _ = text.write_str(&rate(state.per_sec()));
        });
    bar.with_style(style)
}

/// Time after which a running calculation shows a spinner.
const SPINNER_DELAY: Duration = Duration::from_secs(1);

/// Handle of the spinner of a running calculation. Dropping the handle removes the spinner.
pub(crate) struct Spinner {
    end: Option<Sender<()>>,
    shown: Option<JoinHandle<()>>,
}

/// Shows a spinner with the elapsed time on a terminal if a calculation takes longer than a second.
///
/// * `what`: description of the calculation, which is shown next to the spinner.
pub(crate) fn show_spinner(what: &'static str) -> Spinner {
    if !io::stderr().is_terminal() {
        return Spinner { end: None, shown: None };
    }
    let (end, ended) = channel();
    let show = move || {
        if ended.recv_timeout(SPINNER_DELAY) == Err(RecvTimeoutError::Timeout) {
            let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed}");
            let style = style.unwrap_or_else(|_| ProgressStyle::default_spinner());
            let bar = ProgressBar::new_spinner().with_style(style).with_message(what);
            let bar = bar.with_elapsed(SPINNER_DELAY);
            bar.enable_steady_tick(Duration::from_millis(100));
            // `recv` returns an error when the calculation ends and its sender is dropped.
            let _ = ended.recv();
            bar.finish_and_clear();
        }
    };
    // If no thread can be started, the calculation runs without showing a spinner.
    Spinner { end: Some(end), shown: thread::Builder::new().spawn(show).ok() }
}

impl Drop for Spinner {
    fn drop(&mut self) {
        self.end.take();
        if let Some(shown) = self.shown.take() {
            // The thread removes the spinner from the terminal before it ends.
            let _ = shown.join();
        }
    }
}

/// Formats a rate in rows per second, rounded to a whole number.
fn rate(per_second: f64) -> String {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the rate is only displayed"
    )]
    let whole = per_second.round() as u64;
    let mut text = HumanCount(whole).to_string();
    text.push_str("/s");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Regression test: the rate was once displayed as `20,083.5883/s`.
    #[test]
    fn progress_rate_is_a_whole_number() {
        assert_eq!(rate(20_083.588_3), "20,084/s");
        assert_eq!(rate(0.2), "0/s");
    }
}
