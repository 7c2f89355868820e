//! The answers that are being calculated, and which of them are obsolete.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::Value;

use crate::Refusal;

/// An answer, or the reason for none.
type AnswerResult = Result<Value, Refusal>;

/// What a page calls a request: its own name, and a number that grows with every change on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Turn {
    page: String,
    number: u64,
}

impl Turn {
    /// Reads `name/number`.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let (page, number) = text.split_once('/')?;
        Some(Self { page: page.to_owned(), number: number.parse().ok()? })
    }

    /// Whether it is an earlier one of the same page.
    fn is_before(&self, other: &Self) -> bool {
        self.page == other.page && self.number < other.number
    }
}

/// One that has begun.
struct Entry {
    turn: Option<Turn>,
    stop: Arc<AtomicBool>,
    give: Sender<AnswerResult>,
}

type Entries = Arc<Mutex<Vec<Entry>>>;

/// The answers that are being worked out, until they end.
pub(crate) struct Running {
    entries: Entries,
    most: usize,
}

/// An answer that is being worked out; dropped, it has ended.
pub(crate) struct RunningAnswer {
    entries: Entries,
    stop: Arc<AtomicBool>,
}

fn lock(entries: &Entries) -> MutexGuard<'_, Vec<Entry>> {
    // Nothing is left half done under the lock.
    entries.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Running {
    /// Limit of answers at a time.
    pub(crate) fn most(most: usize) -> Self {
        Self { entries: Entries::default(), most }
    }

    /// Begins an answer; answers to earlier turns of the same page are stopped, and their requests answered at once.
    ///
    /// Returns it with the place where the answer comes.
    pub(crate) fn begin(
        &self,
        turn: Option<Turn>,
    ) -> Result<(RunningAnswer, Receiver<AnswerResult>), Refusal> {
        let mut entries = lock(&self.entries);
        if let Some(turn) = &turn {
            let others = || entries.iter().filter_map(|entry| Some((entry, entry.turn.as_ref()?)));
            if others().any(|(_, other)| turn.is_before(other)) {
                return Err(Refusal::Overtaken);
            }
            for (entry, _) in others().filter(|(_, other)| other.is_before(turn)) {
                entry.stop.store(true, Ordering::Relaxed);
                // Who has given up does not listen.
                let _ = entry.give.send(Err(Refusal::Overtaken));
            }
        }
        if entries.len() >= self.most {
            return Err(Refusal::Busy);
        }
        let (give, answers) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        entries.push(Entry { turn, stop: Arc::clone(&stop), give });
        Ok((RunningAnswer { entries: Arc::clone(&self.entries), stop }, answers))
    }
}

impl RunningAnswer {
    /// True once the answer is of no use.
    pub(crate) fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Hands over the answer.
    pub(crate) fn end(self, found: AnswerResult) {
        if let Some(entry) = self.taken() {
            // Who has given up does not listen.
            let _ = entry.give.send(found);
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

    fn turn(page: &str, number: u64) -> Turn {
        let turn = Turn::parse(&format!("{page}/{number}")).expect("a turn");
        assert_eq!(turn, Turn { page: page.to_owned(), number });
        turn
    }

    /// A page that has moved on stops its own earlier requests only; a waiting request is answered before the work
    /// has ended.
    #[test]
    fn a_newer_turn_stops_those_of_its_page() {
        let running = Running::most(4);
        let (old, old_answer) = running.begin(Some(turn("a", 1))).expect("room");
        let (other, other_answer) = running.begin(Some(turn("b", 1))).expect("room");
        let (unnamed, _) = running.begin(None).expect("room");
        let (new, new_answer) = running.begin(Some(turn("a", 2))).expect("room");
        let stopped =
            [&old, &other, &unnamed, &new].map(|begun| begun.stop().load(Ordering::Relaxed));
        assert_eq!(stopped, [true, false, false, false]);
        assert!(matches!(old_answer.try_recv(), Ok(Err(Refusal::Overtaken))));
        assert!(matches!(other_answer.try_recv(), Err(TryRecvError::Empty)));
        // What comes late is refused without work.
        assert!(matches!(running.begin(Some(turn("a", 1))), Err(Refusal::Overtaken)));
        // What was stopped still has its place until it ends.
        assert!(matches!(running.begin(None), Err(Refusal::Busy)));
        drop(old);
        assert!(running.begin(Some(turn("a", 2))).is_ok());
        new.end(Ok(Value::Null));
        assert!(matches!(new_answer.try_recv(), Ok(Ok(Value::Null))));
        // One that ends without an answer is noticed.
        drop(other);
        assert!(matches!(other_answer.try_recv(), Err(TryRecvError::Disconnected)));
    }
}
