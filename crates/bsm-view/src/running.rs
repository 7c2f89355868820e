//! List of the calculations that are running on the server. A newer request from a page cancels the
//! earlier requests from the same page.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::Value;

use crate::Refusal;

/// The answer to a request, or the reason why there is none.
type AnswerResult = Result<Value, Refusal>;

/// Identifies a request: the id of the page, and a number that increases with every change on the
/// page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct RequestId {
    page: String,
    number: u64,
}

impl RequestId {
    /// Parses the text `page/number`, which contains the page id and the request number.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let (page, number) = text.split_once('/')?;
        Some(Self { page: page.to_owned(), number: number.parse().ok()? })
    }

    /// Returns true if this request precedes another request from the same page.
    fn is_before(&self, other: &Self) -> bool {
        self.page == other.page && self.number < other.number
    }
}

/// A calculation that has been started and has not ended yet.
struct Entry {
    id: Option<RequestId>,
    stop: Arc<AtomicBool>,
    sender: Sender<AnswerResult>,
}

type Entries = Arc<Mutex<Vec<Entry>>>;

/// All calculations that have not ended yet, including stopped calculations.
pub(crate) struct Running {
    entries: Entries,
    limit: usize,
}

/// A running calculation. Dropping this value removes it from the list.
pub(crate) struct RunningAnswer {
    entries: Entries,
    stop: Arc<AtomicBool>,
}

fn lock(entries: &Entries) -> MutexGuard<'_, Vec<Entry>> {
    // The lock can be used after a panic, because the list is never inconsistent while the lock is
    // held.
    entries.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Running {
    /// Creates an empty list that allows at most `limit` simultaneous calculations.
    pub(crate) fn with_limit(limit: usize) -> Self {
        Self { entries: Entries::default(), limit }
    }

    /// Registers a new calculation. Calculations for earlier requests from the same page are
    /// stopped, and these requests are answered immediately.
    ///
    /// Returns the registered calculation and a receiver for its answer.
    pub(crate) fn begin(
        &self,
        id: Option<RequestId>,
    ) -> Result<(RunningAnswer, Receiver<AnswerResult>), Refusal> {
        let mut entries = lock(&self.entries);
        if let Some(id) = &id {
            let others = || entries.iter().filter_map(|entry| Some((entry, entry.id.as_ref()?)));
            if others().any(|(_, other)| id.is_before(other)) {
                return Err(Refusal::Superseded);
            }
            for (entry, _) in others().filter(|(_, other)| other.is_before(id)) {
                entry.stop.store(true, Ordering::Relaxed);
                // Sending fails if the client has already disconnected.
                let _ = entry.sender.send(Err(Refusal::Superseded));
            }
        }
        if entries.len() >= self.limit {
            return Err(Refusal::Busy);
        }
        let (sender, answers) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        entries.push(Entry { id, stop: Arc::clone(&stop), sender });
        Ok((RunningAnswer { entries: Arc::clone(&self.entries), stop }, answers))
    }
}

impl RunningAnswer {
    /// Returns a flag that becomes true when the answer is no longer needed.
    pub(crate) fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Ends the calculation and delivers its answer.
    pub(crate) fn end(self, found: AnswerResult) {
        if let Some(entry) = self.taken() {
            // Sending fails if the client has already disconnected.
            let _ = entry.sender.send(found);
        }
    }

    fn taken(&self) -> Option<Entry> {
        let mut entries = lock(&self.entries);
        let place = entries.iter().position(|entry| Arc::ptr_eq(&entry.stop, &self.stop))?;
        Some(entries.swap_remove(place))
    }
}

impl Drop for RunningAnswer {
    fn drop(&mut self) {
        self.taken();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::TryRecvError;

    use super::*;

    fn request_id(page: &str, number: u64) -> RequestId {
        let id = RequestId::parse(&format!("{page}/{number}")).expect("a request id");
        assert_eq!(id, RequestId { page: page.to_owned(), number });
        id
    }

    /// A newer request must stop only the earlier requests from the same page. A stopped request
    /// must be answered before its calculation has ended.
    #[test]
    fn a_newer_request_stops_earlier_requests_of_its_page() {
        let running = Running::with_limit(4);
        let (old, old_answer) = running.begin(Some(request_id("a", 1))).expect("room");
        let (other, other_answer) = running.begin(Some(request_id("b", 1))).expect("room");
        let (unnamed, _) = running.begin(None).expect("room");
        let (new, new_answer) = running.begin(Some(request_id("a", 2))).expect("room");
        let stopped =
            [&old, &other, &unnamed, &new].map(|begun| begun.stop().load(Ordering::Relaxed));
        assert_eq!(stopped, [true, false, false, false]);
        assert!(matches!(old_answer.try_recv(), Ok(Err(Refusal::Superseded))));
        assert!(matches!(other_answer.try_recv(), Err(TryRecvError::Empty)));
        // A request that arrives late must be rejected without a calculation.
        assert!(matches!(running.begin(Some(request_id("a", 1))), Err(Refusal::Superseded)));
        // A stopped calculation occupies its slot until it ends.
        assert!(matches!(running.begin(None), Err(Refusal::Busy)));
        drop(old);
        assert!(running.begin(Some(request_id("a", 2))).is_ok());
        new.end(Ok(Value::Null));
        assert!(matches!(new_answer.try_recv(), Ok(Ok(Value::Null))));
        // A calculation that ends without an answer must be detected.
        drop(other);
        assert!(matches!(other_answer.try_recv(), Err(TryRecvError::Disconnected)));
    }
}
