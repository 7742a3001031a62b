//! What a person sees while a job works: a bar, or plain lines where no terminal listens.

use std::{io::IsTerminal, time::Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::job::Event;

use super::{command::Voice, output::say};

/// Ticks of a whole bar.
const TICKS: u64 = 1000;

/// What a person should know who meant to go on.
const ANEW: &str = "note: there is no stopped run to go on with; a new one begins";

fn resumed(time_yr: f64, filmed: bool) -> String {
    let film =
        if filmed { "; the film begins there (--keep-timeline keeps the whole run for 'upthrust film')" } else { "" };
    format!("goes on at {:.3} million years{film}", time_yr * 1e-6)
}

/// Follows a job.
pub(crate) enum Progress {
    Bar(ProgressBar),
    Lines { since: Instant },
    Silent,
}

impl Progress {
    /// The kind that suits the voice and the terminal.
    pub fn new(voice: Voice) -> Self {
        if voice != Voice::Normal {
            return Progress::Silent;
        }
        if !std::io::stderr().is_terminal() {
            return Progress::Lines { since: Instant::now() };
        }
        let bar = ProgressBar::new(TICKS);
        if let Ok(style) = ProgressStyle::with_template("{bar:32} {percent:>3} %  {elapsed}  {msg}") {
            bar.set_style(style);
        }
        Progress::Bar(bar)
    }

    /// Takes what the job tells.
    pub fn hear(&mut self, event: &Event) {
        match self {
            Progress::Silent => {}
            Progress::Bar(bar) => match event {
                Event::Step(moment) => {
                    bar.set_position((moment.overall() * TICKS as f64) as u64);
                    bar.set_message(format!("{} ({} of {})", moment.label, moment.stage + 1, moment.stages));
                }
                Event::World { done, of } => {
                    bar.set_position(*done as u64 * TICKS / (*of).max(1) as u64);
                    bar.set_message(format!("{done} of {of} worlds"));
                }
                Event::Anew => bar.println(ANEW),
                Event::Resumed { time_yr, filmed } => bar.println(resumed(*time_yr, *filmed)),
                Event::Writing(file) => bar.set_message(format!("writing {file}")),
            },
            Progress::Lines { since } => match event {
                Event::Step(moment) if moment.stage_over() => {
                    let seconds = since.elapsed().as_secs_f64();
                    *since = Instant::now();
                    let steps = if moment.step == 1 { "step" } else { "steps" };
                    let (stage, of) = (moment.stage + 1, moment.stages);
                    say(&format!("{stage}/{of} {}: {} {steps}, {seconds:.1} s", moment.label, moment.step));
                }
                Event::Anew => say(ANEW),
                Event::Resumed { time_yr, filmed } => say(&resumed(*time_yr, *filmed)),
                Event::World { done, of } if done == of => say(&format!("{of} worlds")),
                _ => {}
            },
        }
    }

    /// Clears the bar, so that what follows stands alone.
    pub fn end(&mut self) {
        if let Progress::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
