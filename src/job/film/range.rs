//! The heights that a film's colours span, which have to be known before its first picture.

use std::sync::atomic::AtomicBool;

use crate::{
    job::JobError,
    recipe::Plan,
    timeline::{Interest, Moment, Sink, Timeline, TimelineError},
    world::World,
};

/// Longer side of the trial run that finds how high a world will be.
const TRIAL_SIDE: usize = 128;
/// Room above and below what is found, as a share of its range.
const MARGIN: f64 = 0.25;
/// Where plates move, heights are those of the Earth, m over the sea.
pub(super) const EARTH_M: [f64; 2] = [-11_000.0, 9_000.0];

/// Heights to be expected, m over the sea: Earth's where plates move, else those of a small trial and some more. The trial
/// leaves out water's hours, which cost the most and move the ground by little.
pub(super) fn range_over_sea(plan: &Plan, until: Option<usize>, cancel: &AtomicBool) -> Result<[f64; 2], JobError> {
    let running = || plan.running().filter(|(i, _)| until.is_none_or(|end| *i <= end));
    if running().any(|(_, stage)| stage.kind.leads) {
        return Ok(EARTH_M);
    }
    let mut span = Span(None);
    if let Some(last) = run(plan, until, cancel, &mut [&mut span])? {
        span.add(&last);
    }
    Ok(span.0.unwrap_or(EARTH_M))
}

/// The world that a small trial ends with.
pub(super) fn trial(plan: &Plan, until: Option<usize>, cancel: &AtomicBool) -> Result<Option<World>, JobError> {
    run(plan, until, cancel, &mut [])
}

fn run(
    plan: &Plan,
    until: Option<usize>,
    cancel: &AtomicBool,
    sinks: &mut [&mut dyn Sink],
) -> Result<Option<World>, JobError> {
    let small = plan.shrunk(TRIAL_SIDE).without_hours();
    match Timeline::new(&small, cancel).until(until).run(sinks, &mut |_| ()) {
        Ok(last) => Ok(Some(last)),
        Err(TimelineError::Cancelled) => Err(TimelineError::Cancelled.into()),
        // What is wrong on the small map may be right on the whole one; if not, the run itself will say so.
        Err(_) => Ok(None),
    }
}

/// The heights of a world and some more, m over its sea.
pub(super) fn range_of(world: &World) -> [f64; 2] {
    let mut span = Span(None);
    span.add(world);
    span.0.unwrap_or(EARTH_M)
}

/// The heights of the worlds seen so far and some more, m over their seas.
struct Span(Option<[f64; 2]>);

impl Span {
    fn add(&mut self, world: &World) {
        let Some((low, high)) = world.height().range() else { return };
        let [low, high] = [low, high].map(|height_m| f64::from(height_m) - world.sea_level_m);
        let margin = MARGIN * (high - low).max(1.0);
        let [least, most] = self.0.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
        self.0 = Some([least.min(low - margin), most.max(high + margin)]);
    }
}

impl Sink for Span {
    fn wants(&mut self, moment: &Moment) -> Interest {
        Interest::Ground.when(moment.stage_over())
    }

    fn take(&mut self, world: &World, _: &Moment) -> Result<(), String> {
        self.add(world);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Grid},
        recipe::{Overrides, find_preset},
        world::Layer,
    };

    fn expected(preset: &str) -> [f64; 2] {
        let plan = Plan::new(&find_preset(preset).unwrap().source(), &Overrides::default()).unwrap();
        range_over_sea(&plan, None, &AtomicBool::new(false)).unwrap()
    }

    #[test]
    fn colours_span_the_earth_only_where_plates_move() {
        assert_eq!(expected("collision"), EARTH_M);
        // Its land lies 1,600 to 2,400 m over its sea.
        let [low, high] = expected("canyon");
        assert!(low > 1_000.0 && high < 3_000.0, "{low} {high}");
    }

    #[test]
    fn the_span_holds_what_was_before_and_what_comes_after() {
        let world = |heights: [f32; 2]| {
            let mut made = World::new(Grid::new(2, 1, 20.0, Edges::Open), 0.0);
            made.layer_mut(Layer::Bedrock).data.copy_from_slice(&heights);
            made
        };
        let mut both = Span(None);
        both.add(&world([0.0, 100.0]));
        both.add(&world([-40.0, 60.0]));
        assert_eq!(both.0, Some([-65.0, 125.0]));
    }
}
