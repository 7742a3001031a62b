//! Renews the tables of `docs/realism.md`: the metrics, how they spread over 20 seeds of `collision` at 512 x 512, and over the
//! windows of 64 km at cells of 62.5 m that `continent-to-valley` carves on as many seeds.
//!
//! `cargo run --release --example realism` does that. With a preset, and then the cells a side and the number of seeds if
//! they are to be others, it prints the table of that preset and writes nothing.

use std::{error::Error, path::Path, sync::atomic::AtomicBool};

use upthrust::{
    measure::{self, Reading, report},
    recipe::{Overrides, Plan, Source},
    timeline::Timeline,
};

const PRESET: &str = "collision";
const SIDE: &str = "512";
const SEEDS: u64 = 20;
/// A preset with a window, the stage that ends it, and the cells a side of it.
const WINDOW: (&str, &str, &str) = ("continent-to-valley", "waters", "range.size=1024");

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given = |at: usize, default: &str| arguments.get(at).map_or(default.to_owned(), String::clone);
    let (preset, side) = (given(0, PRESET), given(1, SIDE));
    let seeds: u64 = given(2, &SEEDS.to_string()).parse()?;
    let worlds = (1..=seeds).map(|seed| grown(&preset, &side, seed, None)).collect::<Outcome<Vec<_>>>()?;
    let table = report::spreads_table(&measure::spreads(&worlds));
    if !arguments.is_empty() {
        print!("{table}");
        return Ok(());
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/realism.md");
    let page = std::fs::read_to_string(&path)?;
    let page = renewed(&page, "metrics", &report::metrics_table())?;
    let page = renewed(&page, "results", &table)?;
    let (preset, until, size) = WINDOW;
    let window = |seed| grown(preset, SIDE, seed, Some((until, size)));
    let windows = (1..=SEEDS).map(window).collect::<Outcome<Vec<_>>>()?;
    let table = report::spreads_table(&measure::spreads(&windows));
    std::fs::write(&path, renewed(&page, "windows", &table)?)?;
    Ok(())
}

/// Grows one seed, to the end or until a stage with something set, and reads its metrics.
fn grown(preset: &str, side: &str, seed: u64, until: Option<(&str, &str)>) -> Outcome<Vec<Reading>> {
    let set = until.iter().map(|(_, set)| (*set).to_owned()).collect();
    let overrides = Overrides { seed: Some(seed), size: Some(side.to_owned()), set };
    let plan = Plan::new(&Source::find(preset)?, &overrides)?;
    let last = until.and_then(|(stage, _)| plan.stages.iter().position(|s| s.label == stage));
    let stay = AtomicBool::new(false);
    let world = Timeline::new(&plan, &stay).until(last).run(&mut [], &mut |_| ())?;
    eprintln!("seed {seed}");
    Ok(measure::survey(&world).readings())
}

/// The page with another table between the marks of that name.
fn renewed(page: &str, name: &str, table: &str) -> Outcome<String> {
    let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->"));
    let (before, rest) = page.split_once(&begin).ok_or("the page has lost its marks")?;
    let (_, after) = rest.split_once(&end).ok_or("the page has lost its marks")?;
    Ok(format!("{before}{begin}{table}{end}{after}"))
}
