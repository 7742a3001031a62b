//! `upthrust presets` and `upthrust params`: what there is.

use crate::recipe::{self, Parameter};

use super::{CliError, command::Params, output::Output};

/// Lists the presets, or prints one.
pub(crate) fn presets(name: Option<&str>, output: &mut Output) -> Result<(), CliError> {
    if let Some(name) = name {
        let Some(preset) = recipe::find_preset(name) else {
            let known = recipe::presets().iter().map(|preset| preset.name);
            let hint = match recipe::nearest(name, known) {
                Some(near) => format!("did you mean '{near}'?"),
                None => "`upthrust presets` lists them".to_owned(),
            };
            return Err(CliError::Request(format!("no preset '{name}' ({hint})")));
        };
        return output.line(preset.text.trim_end());
    }
    let width = recipe::presets().iter().map(|preset| preset.name.len()).max().unwrap_or(0);
    for preset in recipe::presets() {
        let (_, description) = preset.summary();
        output.line(&format!("{:width$}  {description}", preset.name))?;
    }
    Ok(())
}

/// Prints parameters.
pub(crate) fn params(what: &Params, output: &mut Output) -> Result<(), CliError> {
    match what {
        Params::Schema => output.line(&serde_json::to_string_pretty(&recipe::json_schema()).unwrap_or_default()),
        Params::Markdown => output.line(recipe::markdown().trim_end()),
        Params::World => table("[world]: the map", &recipe::world_parameters(), output),
        Params::Scene => table("[scene]: how the world is drawn in space", &recipe::scene_parameters(), output),
        Params::Stage(kind) => match recipe::find_stage(kind) {
            Some(stage) => {
                let title = format!("{}: {}", stage.kind, stage.about);
                table(&title, &recipe::parameters(stage), output)?;
                let blend = if stage.blends { " blend" } else { "" };
                output.line(&format!(
                    "\nEvery stage also knows: id enabled mask steps film_seconds film_yr_per_s film_s_per_s{blend}"
                ))
            }
            None => Ok(()),
        },
        Params::All => {
            let width = recipe::stage_kinds().iter().map(|stage| stage.kind.len()).max().unwrap_or(0).max(5);
            output.line(&format!("{:width$}  The map: seed, size, extent, sea level.", "world"))?;
            output.line(&format!("{:width$}  Camera, light, air, water: how the world is drawn in space.", "scene"))?;
            for stage in recipe::stage_kinds() {
                output.line(&format!("{:width$}  {}", stage.kind, stage.about))?;
            }
            output.line("\n`upthrust params STAGE` lists its parameters; `--schema` is for editors")
        }
    }
}

/// Columns as wide as what is in them; what it is and what raising it does on a line of their own.
fn table(title: &str, rows: &[Parameter], output: &mut Output) -> Result<(), CliError> {
    output.line(&format!("{title}\n"))?;
    if rows.is_empty() {
        return output.line("It has no parameters of its own.");
    }
    let head = ["parameter", "unit", "allowed", "default"];
    let cells = |row: &Parameter| [row.name.clone(), row.unit.clone(), row.range.clone(), row.default.clone()];
    let mut widths = head.map(str::len);
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(cells(row)) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let line = |cells: [String; 4]| -> String {
        let padded: Vec<_> = cells.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}")).collect();
        padded.join("  ").trim_end().to_owned()
    };
    output.line(&line(head.map(str::to_owned)))?;
    for row in rows {
        output.line(&line(cells(row)))?;
        let effect = match (row.effect.as_str(), row.number) {
            ("", _) => String::new(),
            (effect, true) => format!(" Higher: {effect}."),
            (effect, false) => format!(" Effect: {effect}."),
        };
        output.line(&format!("    {}{effect}", row.about))?;
    }
    Ok(())
}
