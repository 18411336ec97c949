//! Errors that are only logged, as by the Vulkan validation layers, fail the tests.

use std::sync::{Mutex, Once};

use log::{Level, LevelFilter, Log, Metadata, Record};

struct Errors(Mutex<Vec<String>>);

static ERRORS: Errors = Errors(Mutex::new(Vec::new()));

impl Log for Errors {
    fn enabled(&self, metadata: &Metadata) -> bool {
        metadata.level() <= Level::Error
    }

    fn log(&self, record: &Record) {
        if self.enabled(record.metadata()) {
            self.0.lock().expect("no test panics here").push(format!("{}: {}", record.target(), record.args()));
        }
    }

    fn flush(&self) {}
}

/// From here on, errors are kept.
pub fn install() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        log::set_logger(&ERRORS).expect("the first logger");
        log::set_max_level(LevelFilter::Error);
    });
}

/// Takes what was logged.
pub fn take() -> Vec<String> {
    std::mem::take(&mut *ERRORS.0.lock().expect("no test panics here"))
}

/// Panics if an error was logged since the last look.
pub fn assert_quiet() {
    let errors = take();
    assert!(errors.is_empty(), "logged:\n{}", errors.join("\n"));
}
