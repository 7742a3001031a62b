//! Reports of worlds that are there already: measured, and written where asked.

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use serde::Serialize;

use crate::{
    export::{ExportError, Staged},
    measure::{
        self, Inspection, Reading, Spread,
        report::{self, Subject},
    },
};

use super::{JobError, STORE, open_world, picture::check_place};

/// Worlds, measured.
pub struct Measured {
    subjects: Vec<Subject>,
    inspections: Vec<Inspection>,
}

/// One world in JSON.
#[derive(Serialize)]
struct OneWorld<'a> {
    #[serde(flatten)]
    inspection: &'a Inspection,
    metrics: Vec<Reading>,
}

/// Several worlds in JSON.
#[derive(Serialize)]
struct ManyWorlds<'a> {
    metrics: Vec<Spread>,
    worlds: Vec<Named<'a>>,
}

#[derive(Serialize)]
struct Named<'a> {
    world: &'a str,
    #[serde(flatten)]
    numbers: OneWorld<'a>,
}

impl Measured {
    /// Measures the worlds in these folders, one after the other; before that, refuses a report that could not be written.
    pub fn of(worlds: &[PathBuf], report: Option<&Path>) -> Result<Self, JobError> {
        report.map_or(Ok(()), check_place)?;
        let mut measured = Self { subjects: Vec::new(), inspections: Vec::new() };
        for path in worlds {
            let (world, provenance) = open_world(path)?;
            let folder = if path.ends_with(STORE) { path.parent().unwrap_or(path) } else { path };
            let name = folder.file_name().map_or(provenance.name, |name| name.to_string_lossy().into_owned());
            measured.inspections.push(measure::inspect(&world));
            measured.subjects.push(Subject { name, survey: measure::survey(&world) });
        }
        Ok(measured)
    }

    /// What is printed.
    pub fn text(&self) -> String {
        let text = match (&self.inspections[..], &self.subjects[..]) {
            ([inspection], [subject]) => format!("{inspection}{}", measure::readings_text(&subject.survey.readings())),
            _ => measure::spreads_text(&self.spreads()),
        };
        text.trim_end().to_owned()
    }

    /// The same for programs.
    pub fn json(&self) -> String {
        let one = |i: usize| OneWorld { inspection: &self.inspections[i], metrics: self.subjects[i].survey.readings() };
        let text = match self.subjects.len() {
            1 => serde_json::to_string_pretty(&one(0)),
            n => {
                let named = |i: usize| Named { world: &self.subjects[i].name, numbers: one(i) };
                let worlds = (0..n).map(named).collect();
                serde_json::to_string_pretty(&ManyWorlds { metrics: self.spreads(), worlds })
            }
        };
        // Plain strings and finite numbers: there is nothing in it that JSON cannot say.
        text.unwrap_or_default()
    }

    fn spreads(&self) -> Vec<Spread> {
        measure::spreads(&self.subjects.iter().map(|s| s.survey.readings()).collect::<Vec<_>>())
    }

    /// Writes a report; the ending says what kind: `.html` a page with plots, `.md` with the plots beside it in
    /// `NAME_plots/`, `.json` as [`Measured::json`], anything else as [`Measured::text`].
    pub fn write(&self, file: &Path) -> Result<(), JobError> {
        let end = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let mut staged = Staged::default();
        let text = match end.as_str() {
            "html" | "htm" => report::html(&self.subjects),
            "md" => {
                let name = format!("{}_plots", file.file_stem().unwrap_or_default().to_string_lossy());
                let folder = file.with_file_name(&name);
                let (text, plots) = report::markdown(&self.subjects, &name);
                fs::create_dir_all(&folder).map_err(|cause| JobError::Disk { path: folder.clone(), cause })?;
                for (name, svg) in plots {
                    write(&mut staged, &folder.join(name), &svg)?;
                }
                text
            }
            "json" => self.json() + "\n",
            _ => self.text() + "\n",
        };
        write(&mut staged, file, &text)?;
        staged.finish()?;
        Ok(())
    }
}

fn write(staged: &mut Staged, path: &Path, text: &str) -> Result<(), JobError> {
    Ok(staged.write(path, |out| out.write_all(text.as_bytes()).map_err(ExportError::from))?)
}
