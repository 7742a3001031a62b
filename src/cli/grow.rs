//! `upthrust grow`.

use std::sync::atomic::AtomicBool;

use crate::{
    job::{self, Estimate, Grown, Request, SheetRequest},
    recipe::Plan,
};

use super::{
    CliError,
    command::{Aim, Folder, Grow, Voice},
    output::{Output, say},
    progress::Progress,
};

/// Grows a world, or a sheet of them, on a pool of the asked size.
pub(crate) fn run(grow: Grow, cancel: &AtomicBool, output: &mut Output) -> Result<(), CliError> {
    let mut builder = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = grow.threads {
        builder = builder.num_threads(threads);
    }
    let pool = builder.build().map_err(|e| CliError::System(format!("cannot start the threads: {e}")))?;
    let voice = grow.voice;
    match grow.aim {
        Aim::Folder(folder) => {
            let Folder { out, existing, checkpoint_every, until, film, frames, bake_per_s, keep } = *folder;
            let plan = Plan::new(&grow.source, &grow.overrides)?;
            let request = Request { plan, out, existing, checkpoint_every, until, film, frames, bake_per_s, keep };
            let mut grown = pool.install(|| grown(&request, voice, cancel))?;
            let failures = std::mem::take(&mut grown.failures);
            report(&request, &grown, voice, output)?;
            // The world is there; what was asked for besides is not.
            match failures.into_iter().next() {
                Some(failure) => Err(failure.into()),
                None => Ok(()),
            }
        }
        Aim::Sheet { seeds, file } => {
            let request = SheetRequest { source: grow.source, overrides: grow.overrides, seeds, file };
            let mut progress = Progress::new(voice);
            let drawn = pool.install(|| job::sheet(&request, cancel, &mut |event| progress.hear(&event)));
            progress.end();
            output.line(&drawn?.display().to_string())
        }
    }
}

fn grown(request: &Request, voice: Voice, cancel: &AtomicBool) -> Result<Grown, CliError> {
    if voice == Voice::Normal {
        request.plan.notes.iter().for_each(|note| say(&format!("note: {note}")));
    }
    if voice == Voice::Normal
        && let Some(estimate) = job::estimate(&request.plan, cancel)?
    {
        say(&announce(&request.plan, &estimate));
    }
    let mut progress = Progress::new(voice);
    let grown = job::grow(request, cancel, &mut |event| progress.hear(&event));
    progress.end();
    let grown = grown?;
    if voice == Voice::Normal {
        grown.notes.iter().for_each(|note| say(&format!("note: {note}")));
    }
    Ok(grown)
}

fn announce(plan: &Plan, estimate: &Estimate) -> String {
    let largest = plan.largest_grid();
    let (width, height) = (largest.width, largest.height);
    let minutes = estimate.seconds / 60.0;
    let time = if minutes < 1.5 { format!("{:.0} s", estimate.seconds) } else { format!("{minutes:.0} min") };
    let gib = estimate.bytes / (1u64 << 30) as f64;
    format!("{width} x {height} cells: about {time} and {gib:.1} GiB of memory")
}

fn report(request: &Request, grown: &Grown, voice: Voice, output: &mut Output) -> Result<(), CliError> {
    let folder = grown.folder.display().to_string();
    match voice {
        Voice::Json => output.line(grown.manifest.trim_end()),
        Voice::Quiet => output.line(&folder),
        Voice::Normal => {
            output.line(&folder)?;
            for film in &grown.films {
                output.line(&film.display().to_string())?;
            }
            let quoted = if folder.contains(' ') { format!("'{folder}'") } else { folder };
            let next = request.plan.world.seed.wrapping_add(1);
            output.line(&format!("  upthrust inspect {quoted}"))?;
            output.line(&format!("  upthrust render {quoted} slope.png --view slope"))?;
            output.line(&format!("  upthrust grow {} --seed {next}", request.plan.asked))
        }
    }
}
