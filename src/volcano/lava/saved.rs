//! An eruption as bytes, and back.

use super::{eruption::Eruption, land::Land, law::Law, params::LavaParams, vents::Source};
use crate::{
    grid::{Field, Grid},
    noise::Key,
    process::State,
    volcano::outlet::Outlet,
};

/// Names the layout.
const MARK: u64 = 0x4C41_0002;
/// Words before the lists.
const HEAD: usize = 16;

/// Bytes that are read one word after the other.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn word(&mut self) -> Option<u64> {
        let (word, rest) = self.bytes.split_first_chunk::<8>()?;
        self.bytes = rest;
        Some(u64::from_le_bytes(*word))
    }

    fn number(&mut self) -> Option<f64> {
        self.word().map(f64::from_bits)
    }

    /// As many words as are announced, if they can be there.
    fn words(&mut self, count: u64) -> Option<Vec<u64>> {
        let count = usize::try_from(count).ok().filter(|&count| count <= self.bytes.len() / 8)?;
        (0..count).map(|_| self.word()).collect()
    }

    fn floats(&mut self, count: usize) -> Option<Vec<f32>> {
        let bytes = self.bytes.split_off(..count.checked_mul(4)?)?;
        Some(bytes.as_chunks().0.iter().map(|word| f32::from_le_bytes(*word)).collect())
    }
}

impl Eruption {
    /// All that [`Self::restored`] needs besides the parameters; `done` steps have been taken.
    pub(super) fn save(&self, done: u64) -> State {
        let (flow, land) = (&self.flow, &self.land);
        let risen: Vec<usize> =
            (0..land.raised.len()).filter(|&i| land.raised[i] != 0.0 || land.slivers[i] != 0.0).collect();
        let mut words = vec![
            done,
            MARK,
            flow.swarm.len() as u64,
            self.sources.len() as u64,
            risen.len() as u64,
            self.drawn,
            self.froze,
            self.left,
            self.over_rim,
            u64::from(land.datum_m.to_bits()),
            u64::from(flow.sea.to_bits()),
            flow.sound.to_bits(),
            flow.lost.ground.to_bits(),
            flow.lost.air.to_bits(),
            flow.lost.sky.to_bits(),
            flow.lost.sea.to_bits(),
        ];
        debug_assert!(words.len() == HEAD);
        for source in &self.sources {
            let vent = &source.vent;
            let [[a, b], [c, d]] = [vent.from_m, vent.to_m];
            words.extend([a, b, c, d, vent.radius_m, vent.share, source.owed].map(f64::to_bits));
        }
        for i in risen {
            words.extend([i as u64, land.raised[i].to_bits(), land.slivers[i].to_bits()]);
        }
        words.extend(&flow.swarm.born);
        words.extend(flow.swarm.load.iter().map(|heat| heat.to_bits()));
        let mut blob: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        for values in flow.swarm.cloud.arrays().into_iter().chain([&flow.swarm.clock_s]) {
            blob.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        }
        let lay = |name: &str, data: &[f32]| (name.to_owned(), Field { grid: *land.mesh.grid(), data: data.to_vec() });
        State { fields: vec![lay("start", &land.start), lay("lava", &land.old)], blob }
    }

    /// An eruption from its saved state; `None` where that is broken.
    pub(super) fn restored(params: &LavaParams, state: &State, grid: Grid, key: Key) -> Option<Self> {
        let field = |wanted: &str| {
            let found = state.fields.iter().find(|(name, _)| name == wanted);
            found.map(|(_, field)| field.data.clone()).filter(|data| data.len() == grid.cells())
        };
        let mut bytes = Reader { bytes: &state.blob };
        let head = bytes.words(HEAD as u64)?;
        let &[_, mark, n, vents, risen, drawn, froze, left, over, datum, sea, sound, ground, air, sky, in_sea] =
            &head[..]
        else {
            return None;
        };
        let law = Law::new(params, &grid);
        if mark != MARK || law.check(&grid).is_err() {
            return None;
        }
        let mut sources = Vec::new();
        for _ in 0..vents {
            let words = bytes.words(7)?;
            let &[a, b, c, d, radius_m, share, owed] =
                &words.iter().map(|&word| f64::from_bits(word)).collect::<Vec<_>>()[..]
            else {
                return None;
            };
            let vent = Outlet { from_m: [a, b], to_m: [c, d], radius_m, share };
            sources.push(Source { owed, ..Source::new(vent, &law) });
        }
        let (mut raised, mut slivers) = (vec![0.0; grid.cells()], vec![0.0; grid.cells()]);
        for _ in 0..risen {
            let i = usize::try_from(bytes.word()?).ok().filter(|&i| i < grid.cells())?;
            (raised[i], slivers[i]) = (bytes.number()?, bytes.number()?);
        }
        let born = bytes.words(n)?;
        let heat: Vec<f64> = bytes.words(n)?.into_iter().map(f64::from_bits).collect();
        let mut cloud = crate::sph::Cloud::default();
        for values in cloud.arrays_mut() {
            *values = bytes.floats(born.len())?;
        }
        let age_s = bytes.floats(born.len())?;
        let finite = cloud.arrays().into_iter().chain([&age_s]).flatten().all(|value| value.is_finite());
        if !bytes.bytes.is_empty() || !finite || heat.iter().any(|heat| !heat.is_finite()) {
            return None;
        }
        let land =
            Land::restored(grid, f32::from_bits(datum as u32), [field("start")?, field("lava")?], [raised, slivers]);
        let mut own = Self::at(law, params.schedule().ok()?, (land, 0.0), Vec::new(), key);
        own.sources = sources;
        (own.drawn, own.froze, own.left, own.over_rim) = (drawn, froze, left, over);
        let flow = &mut own.flow;
        (flow.sea, flow.sound) = (f32::from_bits(sea as u32), f64::from_bits(sound));
        let lost = [ground, air, sky, in_sea].map(f64::from_bits);
        (flow.lost.ground, flow.lost.air, flow.lost.sky, flow.lost.sea) = (lost[0], lost[1], lost[2], lost[3]);
        (flow.swarm.cloud, flow.swarm.load, flow.swarm.clock_s, flow.swarm.born) = (cloud, heat, age_s, born);
        Some(own)
    }
}
