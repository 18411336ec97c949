//! Pictures are drawn in a thread of their own, so that whoever waits for one can stop waiting at any moment: drivers cannot be interrupted,
//! and the software ones work inside of a submission.

use std::ops::{ControlFlow, Deref, DerefMut};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

use crate::{Error, Progress};

/// How often the one who waits is asked whether to go on.
const ASK: Duration = Duration::from_millis(20);

/// Something that one thread has at a time.
pub(crate) struct Turns<T> {
    free: Mutex<Option<T>>,
    given_back: Condvar,
}

impl<T> Turns<T> {
    pub fn new(value: T) -> Self {
        Self { free: Mutex::new(Some(value)), given_back: Condvar::new() }
    }

    /// No code runs while it is locked that could leave it half changed.
    fn lock(&self) -> MutexGuard<'_, Option<T>> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until nobody has it, and takes it; [`Error::Cancelled`] once `wanted` says no.
    pub fn take(self: &Arc<Self>, wanted: &mut dyn FnMut() -> ControlFlow<()>) -> Result<Turn<T>, Error> {
        let mut free = self.lock();
        loop {
            if let Some(value) = free.take() {
                return Ok(Turn { value: Some(value), turns: Arc::clone(self) });
            }
            free = self.given_back.wait_timeout(free, ASK).unwrap_or_else(PoisonError::into_inner).0;
            if free.is_none() {
                drop(free);
                if wanted().is_break() {
                    return Err(Error::Cancelled);
                }
                free = self.lock();
            }
        }
    }
}

/// It, until this is dropped.
pub(crate) struct Turn<T> {
    value: Option<T>,
    turns: Arc<Turns<T>>,
}

impl<T> Turn<T> {
    /// Does not give it back: whoever waits for it waits for ever.
    pub fn keep(mut self) -> T {
        self.value.take().expect(THERE)
    }
}

const THERE: &str = "there until it is dropped or kept";

impl<T> Deref for Turn<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.value.as_ref().expect(THERE)
    }
}

impl<T> DerefMut for Turn<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.value.as_mut().expect(THERE)
    }
}

impl<T> Drop for Turn<T> {
    fn drop(&mut self) {
        if let Some(value) = self.value.take() {
            *self.turns.lock() = Some(value);
            self.turns.given_back.notify_one();
        }
    }
}

/// What work tells the one who waits for it.
enum News<T> {
    Progress(Progress),
    Done(T),
}

/// The work's way to the one who waits for it.
pub(crate) struct Listener<T> {
    news: SyncSender<News<T>>,
    left: Arc<AtomicBool>,
}

impl<T> Listener<T> {
    /// Says how far the work is. [`Error::Cancelled`] once nobody waits for it.
    pub fn report(&self, progress: Progress) -> Result<(), Error> {
        self.news.send(News::Progress(progress)).map_err(|_| Error::Cancelled)?;
        self.check()
    }

    /// [`Error::Cancelled`] once nobody waits for the work.
    pub fn check(&self) -> Result<(), Error> {
        if self.left.load(Ordering::Acquire) { Err(Error::Cancelled) } else { Ok(()) }
    }
}

/// Work that is being done elsewhere.
pub(crate) struct Waiting<T> {
    news: Receiver<News<T>>,
    left: Arc<AtomicBool>,
    worker: JoinHandle<()>,
}

impl<T: Send + 'static> Waiting<T> {
    /// Begins work in a thread of its own.
    ///
    /// # Errors
    /// Those of the system, where it has no thread to give.
    pub fn begin(work: impl FnOnce(&Listener<T>) -> T + Send + 'static) -> std::io::Result<Self> {
        // Not more than one step ahead of the one who waits.
        let (sender, news) = sync_channel(1);
        let left = Arc::new(AtomicBool::new(false));
        let listener = Listener { news: sender, left: Arc::clone(&left) };
        let worker = Builder::new().name("lisle picture".to_owned()).spawn(move || {
            let done = work(&listener);
            // Nobody needs to be there.
            let _ = listener.news.send(News::Done(done));
        })?;
        Ok(Self { news, left, worker })
    }

    /// The work's result. `progress` hears how far it is, and again every few hundredths of a second; [`Error::Cancelled`] once it says no: then
    /// the work ends by itself at its next look at [`Listener::check`]. A panic in the work goes on here.
    pub fn outcome(self, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<T, Error> {
        let mut last = Progress::Preparing;
        loop {
            match self.news.recv_timeout(ASK) {
                Ok(News::Done(done)) => return Ok(done),
                Ok(News::Progress(now)) => last = now,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => match self.worker.join() {
                    Err(panic) => resume_unwind(panic),
                    Ok(()) => return Err(Error::Cancelled),
                },
            }
            if progress(last).is_break() {
                self.left.store(true, Ordering::Release);
                return Err(Error::Cancelled);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::time::Instant;

    use super::*;

    const STEP: Progress = Progress::Samples { done: 1, total: 2 };

    #[test]
    fn results_and_progress_arrive_in_order() {
        let waiting = Waiting::begin(|listener| {
            listener.report(STEP).expect("wanted");
            7
        });
        let mut heard = Vec::new();
        let done = waiting.expect("a thread").outcome(&mut |progress| {
            heard.push(progress);
            ControlFlow::Continue(())
        });
        assert_eq!(done.expect("done"), 7);
        assert_eq!(heard, [STEP]);
    }

    #[test]
    fn one_who_leaves_is_gone_at_once_and_the_work_hears_of_it() {
        let (go_on, wait) = channel();
        let (tell, told) = channel();
        let waiting = Waiting::begin(move |listener| {
            // A driver that does not come back.
            wait.recv().expect("the test's word");
            tell.send(listener.check().is_err()).expect("the test listens");
        });
        let mut asked = 0;
        let outcome = waiting.expect("a thread").outcome(&mut |_| {
            asked += 1;
            if asked < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        assert!(matches!(outcome, Err(Error::Cancelled)));
        assert_eq!(asked, 3);
        go_on.send(()).expect("the work still waits");
        assert!(told.recv().expect("the work's word"), "it does not know that nobody waits");
    }

    #[test]
    #[should_panic(expected = "in the work")]
    fn panics_come_through() {
        let waiting = Waiting::<()>::begin(|_| panic!("in the work")).expect("a thread");
        let _ = waiting.outcome(&mut |_| ControlFlow::Continue(()));
    }

    #[test]
    fn one_has_it_at_a_time() {
        let turns = Arc::new(Turns::new(1));
        let go_on = &mut || ControlFlow::Continue(());
        let mut first = turns.take(go_on).expect("free");
        assert!(matches!(turns.take(&mut || ControlFlow::Break(())), Err(Error::Cancelled)));
        let start = Instant::now();
        let other = {
            let turns = Arc::clone(&turns);
            std::thread::spawn(move || *turns.take(&mut || ControlFlow::Continue(())).expect("free some day"))
        };
        std::thread::sleep(2 * ASK);
        *first = 2;
        drop(first);
        assert_eq!(other.join().expect("no panic"), 2);
        assert!(start.elapsed() >= 2 * ASK);
        assert_eq!(*turns.take(go_on).expect("given back"), 2);
    }
}
