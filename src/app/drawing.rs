//! Draws maps on a thread of its own, so that the window never waits. The last wish counts; drawings that nobody wants any
//! more are dropped.

use std::sync::mpsc::{Receiver, Sender, channel};

use image::RgbImage;

use super::state::Wanted;
use crate::relief::{self, Options};

/// A finished drawing, or why there is none.
pub struct Drawn {
    /// What was asked for.
    pub wanted: Wanted,
    /// The map alone.
    pub picture: Result<RgbImage, String>,
}

/// The thread that draws.
pub struct Drawing {
    ask: Sender<Wanted>,
    done: Receiver<Drawn>,
    asked: Option<Wanted>,
    pending: bool,
}

impl Drawing {
    /// Starts the thread; `wake` is called when a drawing is ready. No drawing is wider or higher than `most_px`.
    pub fn start(most_px: usize, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (ask, asked) = channel::<Wanted>();
        let (finish, done) = channel();
        std::thread::Builder::new().name("drawing".into()).spawn(move || {
            while let Ok(mut wanted) = asked.recv() {
                while let Ok(later) = asked.try_recv() {
                    wanted = later;
                }
                let options = Options { overlay: wanted.overlay, ..Options::bare(most_px) };
                let picture = relief::map(&wanted.world, &wanted.view, &options).map_err(|e| e.to_string());
                if finish.send(Drawn { wanted, picture }).is_err() {
                    return;
                }
                wake();
            }
        })?;
        Ok(Self { ask, done, asked: None, pending: false })
    }

    /// Asks for a drawing, unless it is the one that was asked for last.
    pub fn want(&mut self, wanted: Wanted) {
        if self.asked.as_ref().is_some_and(|asked| asked.same(&wanted)) {
            return;
        }
        // The thread ends only with this struct.
        let _ = self.ask.send(wanted.clone());
        self.asked = Some(wanted);
        self.pending = true;
    }

    /// The drawing that was asked for last, once, when it is ready.
    pub fn take(&mut self) -> Option<Drawn> {
        let asked = self.asked.as_ref()?;
        let drawn = self.done.try_iter().find(|drawn| drawn.wanted.same(asked))?;
        self.pending = false;
        Some(drawn)
    }

    /// Whether a drawing is on its way.
    pub fn pending(&self) -> bool {
        self.pending
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        app::state::State,
        grid::{Edges, Grid},
        relief::View,
        world::{Layer, World},
    };

    #[test]
    fn the_last_wish_is_drawn() {
        let mut world = World::new(Grid::new(40, 20, 4e4, Edges::Open), 0.0);
        world.layer_mut(Layer::Bedrock).data[7] = 500.0;
        let mut state = State::default();
        state.show("one".into(), world);
        let (tell, woken) = channel();
        let mut drawing = Drawing::start(32, move || tell.send(()).unwrap()).unwrap();
        assert!(drawing.take().is_none() && !drawing.pending());
        drawing.want(state.wanted().unwrap());
        state.view = View::Layer(Layer::PlateId);
        drawing.want(state.wanted().unwrap());
        let drawn = loop {
            woken.recv().unwrap();
            if let Some(drawn) = drawing.take() {
                break drawn;
            }
        };
        assert!(drawn.picture.unwrap_err().contains("no layer 'plate_id'"));
        assert!(!drawing.pending() && drawing.take().is_none());
        state.view = View::Relief;
        drawing.want(state.wanted().unwrap());
        woken.recv().unwrap();
        assert_eq!(drawing.take().unwrap().picture.unwrap().dimensions(), (20, 10));
    }
}
