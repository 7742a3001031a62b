//! Renews the tables of `docs/realism.md`: the metrics, and how they spread over 20 seeds of `collision` at 512 x 512.
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

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given = |at: usize, default: &str| arguments.get(at).map_or(default.to_owned(), String::clone);
    let (preset, side) = (given(0, PRESET), given(1, SIDE));
    let seeds: u64 = given(2, &SEEDS.to_string()).parse()?;
    let worlds = (1..=seeds).map(|seed| grown(&preset, &side, seed)).collect::<Outcome<Vec<_>>>()?;
    let table = report::spreads_table(&measure::spreads(&worlds));
    if !arguments.is_empty() {
        print!("{table}");
        return Ok(());
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/realism.md");
    let page = std::fs::read_to_string(&path)?;
    let page = renewed(&page, "metrics", &report::metrics_table())?;
    std::fs::write(&path, renewed(&page, "results", &table)?)?;
    Ok(())
}

/// Grows one seed and reads its metrics.
fn grown(preset: &str, side: &str, seed: u64) -> Outcome<Vec<Reading>> {
    let overrides = Overrides { seed: Some(seed), size: Some(side.to_owned()), ..Overrides::default() };
    let plan = Plan::new(&Source::find(preset)?, &overrides)?;
    let stay = AtomicBool::new(false);
    let world = Timeline::new(&plan, &stay).run(&mut [], &mut |_| ())?;
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
