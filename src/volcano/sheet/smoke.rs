//! How a sheet's smoke behaves, on maps of kilometres.

use super::params::LavaSheetParams;
use crate::{
    grid::{Field, linear},
    noise::Key,
    process::ProcessError,
    volcano::{
        outlet::outlets,
        schedule::{HOUR_S, Schedule},
        smoke::Smoke,
    },
    world::{Plume, World},
};

impl LavaSheetParams {
    /// Smoke over the vents of an eruption that begins now. Gas over fissures of this size rises a kilometre or two.
    pub(super) fn plumes(
        &self,
        world: &World,
        mask: Option<&Field<f32>>,
        key: Key,
    ) -> Result<Vec<Plume>, ProcessError> {
        let smoke = Smoke {
            rise_m_per_s: self.smoke_m_per_s,
            wind_from_deg: self.wind_from_deg,
            wind_m_per_s: self.wind_m_per_s,
            wind_at_m: 1000.0,
            puffs_per_s: 0.5,
            most_per_s: 2.0,
            slows_s: 60.0,
            lasts_s: 600.0,
            swell: 0.2,
        };
        let spans = Schedule::of_sheet(&self.schedule).map_err(ProcessError::Unfit)?.spans(self.duration_h * HOUR_S);
        let vents = outlets(&self.vent, world, world.grid.cell_m).map_err(ProcessError::Unfit)?;
        // No smoke where a mask lets no lava out.
        let open = |at_m: [f64; 2]| mask.is_none_or(|mask| linear(mask, at_m) > 0.0);
        let vents: Vec<_> = vents.into_iter().filter(|vent| open(vent.from_m) || open(vent.to_m)).collect();
        Ok(smoke.plumes(vents.iter(), &spans, world, key))
    }
}
