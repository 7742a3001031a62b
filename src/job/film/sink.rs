//! A film as a sink of a timeline. What goes wrong with it does not stop the world.

use std::path::PathBuf;

use super::{Film, JobError};
use crate::{
    timeline::{Checkpoint, Interest, Moment, Sink},
    world::World,
};

/// A film, or why it ended early.
pub(crate) struct FilmSink(Result<Film, JobError>);

impl FilmSink {
    /// Looks on with this film.
    pub fn new(film: Film) -> Self {
        Self(Ok(film))
    }

    /// Leaves out what a stopped run did before this checkpoint.
    pub fn begin_at(&mut self, checkpoint: &Checkpoint) {
        if let Ok(film) = &mut self.0 {
            film.begin_at(checkpoint);
        }
    }

    /// Ends the film.
    pub fn finish(self) -> Result<PathBuf, JobError> {
        self.0.and_then(Film::finish)
    }
}

impl Sink for FilmSink {
    fn wants(&mut self, moment: &Moment) -> Interest {
        self.0.as_ref().map_or(Interest::None, |film| film.wants(moment))
    }

    fn take(&mut self, world: &World, moment: &Moment) -> Result<(), String> {
        if let Ok(film) = &mut self.0
            && let Err(error) = film.frame(world, moment)
        {
            // Dropping the film ends its process and clears its files away.
            self.0 = Err(error);
        }
        Ok(())
    }
}
