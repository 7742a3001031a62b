//! Many seeds of one recipe, small, on one picture.

use std::{
    ops::RangeInclusive,
    path::PathBuf,
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
};

use rayon::prelude::*;

use crate::{
    recipe::{Overrides, Plan, Source},
    relief,
};

use super::{
    Event, JobError,
    grow::run,
    picture::{check_picture, write_picture},
};

/// Cells a side of a thumbnail's world, if nothing else is asked for.
const SIDE: &str = "128";
/// Longest side of a thumbnail, pixels.
const THUMB_PX: usize = 256;
/// Most worlds on one sheet.
pub const MOST: u64 = 400;

/// A sheet to be drawn.
#[derive(Clone, Debug)]
pub struct SheetRequest {
    /// The recipe.
    pub source: Source,
    /// What flags change in it, except the seed.
    pub overrides: Overrides,
    /// The seeds, both ends included.
    pub seeds: RangeInclusive<u64>,
    /// The picture.
    pub file: PathBuf,
}

/// Grows every seed and draws the sheet. Worlds grow side by side, which changes no bit of any.
pub fn sheet(
    request: &SheetRequest,
    cancel: &AtomicBool,
    tell: &mut (dyn FnMut(Event) + Send),
) -> Result<PathBuf, JobError> {
    check_picture(&request.file)?;
    let plans = request.seeds.clone().map(|seed| plan(request, seed)).collect::<Result<Vec<_>, _>>()?;
    let (done, of, tell) = (AtomicUsize::new(0), plans.len(), Mutex::new(tell));
    let pictures = plans
        .par_iter()
        .map(|plan| {
            let (world, _) = run(plan, None, cancel, &mut |_| ())?;
            let picture = relief::map(&world, &relief::View::Relief, &relief::Options::bare(THUMB_PX))?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if let Ok(mut tell) = tell.lock() {
                (*tell)(Event::World { done, of });
            }
            Ok((plan.world.seed.to_string(), picture))
        })
        .collect::<Result<Vec<_>, JobError>>()?;
    // Half as wide again as high, rows filled alike.
    let widest = (pictures.len() as f64 * 1.5).sqrt().ceil() as usize;
    let rows = pictures.len().div_ceil(widest.max(1));
    let sheet = relief::contact_sheet(&pictures, pictures.len().div_ceil(rows.max(1)).max(1));
    write_picture(&sheet, &request.file)?;
    Ok(request.file.clone())
}

fn plan(request: &SheetRequest, seed: u64) -> Result<Plan, JobError> {
    let size = request.overrides.size.clone().or_else(|| Some(SIDE.to_owned()));
    let overrides = Overrides { seed: Some(seed), size, ..request.overrides.clone() };
    Ok(Plan::new(&request.source, &overrides)?)
}
