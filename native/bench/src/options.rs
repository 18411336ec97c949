//! The command line.

use lexopt::{Arg, Parser, ValueExt};

/// What the command line accepts.
pub const USAGE: &str = "Usage: cargo xtask bench [OPTIONS]

  --quick          one sample a figure, a garment of 100,000 points instead of 2 million, a coarse search for the worst view
  --filter TEXT    only models and benchmarks whose name contains TEXT
  --case TEXT      of each model, only pictures whose view and shading contain TEXT, such as \"full, physical\"
  --samples N      samples per figure (default 4)
  --adapter TEXT   the first adapter whose name contains TEXT
  --help           this text

Yarn files are read from the folder `yarns` in $LISLE_DATA (default: ../shared/data beside the repository).";

/// How to run.
#[derive(Debug, PartialEq)]
pub struct Options {
    pub quick: bool,
    pub filter: Option<String>,
    pub case: Option<String>,
    /// At least 1.
    pub samples: u32,
    pub adapter: Option<String>,
}

/// What was asked for.
#[derive(Debug, PartialEq)]
pub enum Request {
    Help,
    Run(Options),
}

impl Options {
    /// Whether the filter lets a name through.
    pub fn wants(&self, name: &str) -> bool {
        self.filter.as_ref().is_none_or(|text| name.contains(text.as_str()))
    }

    /// Whether a picture of a model is to be drawn.
    pub fn wants_case(&self, view: &str, shading: &str) -> bool {
        self.case.as_ref().is_none_or(|text| format!("{view}, {shading}").contains(text.as_str()))
    }
}

/// Reads the command line.
pub fn parse(mut parser: Parser) -> Result<Request, lexopt::Error> {
    let (mut quick, mut filter, mut case, mut samples, mut adapter) = (false, None, None, None, None);
    while let Some(argument) = parser.next()? {
        match argument {
            Arg::Long("quick") => quick = true,
            Arg::Long("filter") => filter = Some(parser.value()?.string()?),
            Arg::Long("case") => case = Some(parser.value()?.string()?),
            Arg::Long("samples") => samples = Some(parser.value()?.parse::<std::num::NonZeroU32>()?.get()),
            Arg::Long("adapter") => adapter = Some(parser.value()?.string()?),
            Arg::Long("help") | Arg::Short('h') => return Ok(Request::Help),
            other => return Err(other.unexpected()),
        }
    }
    let samples = samples.unwrap_or(if quick { 1 } else { 4 });
    Ok(Request::Run(Options { quick, filter, case, samples, adapter }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(arguments: &[&str]) -> Result<Request, lexopt::Error> {
        parse(Parser::from_args(arguments))
    }

    #[test]
    fn options_are_read_and_wrong_ones_refused() {
        let options = |quick, filter: Option<&str>, samples| {
            Request::Run(Options { quick, filter: filter.map(str::to_owned), case: None, samples, adapter: None })
        };
        assert_eq!(parsed(&[]).expect("no options"), options(false, None, 4));
        assert_eq!(parsed(&["--quick", "--filter=glove"]).expect("valid"), options(true, Some("glove"), 1));
        assert_eq!(parsed(&["--quick", "--samples", "9"]).expect("valid"), options(true, None, 9));
        assert_eq!(parsed(&["--samples=2", "--help"]).expect("valid"), Request::Help);
        for wrong in [&["--samples", "0"][..], &["--samples"], &["--fast"], &["glove"]] {
            assert!(parsed(wrong).is_err(), "{wrong:?}");
        }
    }
}
