//! The `plates` stage: sets a run up from its parameters, steps it, and publishes what the world may see.

use glam::DVec2;

use crate::{
    grid::{Field, Grid},
    noise::Key,
    process::{Blend, Context, Ground, Placement, Process, ProcessError, State, Step},
    world::{Layer, Matter, Table, World},
};

use super::{
    arc::Arc,
    carved::Carved,
    domain::Domain,
    engine::{Drive, Engine, Settings, Style},
    initial::{self, Continents},
    mantle::Mantle,
    paint,
    params::{PlateStyle, PlatesParams},
    partition::{self, Polygon},
    plate::Plate,
    raise::Belt,
    simulation::{Rules, Simulation},
    surface::{Detail, Plains, Surface},
    tables::{self, Drift},
    thesis::Thesis,
    warp::Warp,
    window::Window,
};

/// What is written anew whenever the stage shows itself; bedrock joins what the stage found.
const SHOWN: [Layer; 6] =
    [Layer::Uplift, Layer::PlateId, Layer::CrustKind, Layer::CrustAge, Layer::CrustThickness, Layer::BoundaryKind];

/// What it may change: the ground and what it shows; where others carve, also what they lay on the ground and tell of it.
const WRITTEN: [Layer; 11] = [
    Layer::Bedrock,
    Layer::Uplift,
    Layer::PlateId,
    Layer::CrustKind,
    Layer::CrustAge,
    Layer::CrustThickness,
    Layer::BoundaryKind,
    Layer::Lava,
    Layer::Sediment,
    Layer::Wear,
    Layer::Deposit,
];

/// Share of the square that the thesis's block of plates fills.
const THESIS_BLOCK: f64 = 0.9;

impl PlatesParams {
    /// The stage as a process; `steps` asks for about that many instead of as many as the speed needs.
    /// Where it `leads`, others carve the map between its steps.
    pub fn process(self, placement: Placement, steps: Option<u64>, leads: bool) -> Box<dyn Process> {
        Box::new(Stage { params: self, placement, steps, leads, ground: None, run: None, resume: None })
    }
}

struct Stage {
    params: PlatesParams,
    placement: Placement,
    steps: Option<u64>,
    leads: bool,
    /// What the stage found.
    ground: Option<Ground>,
    run: Option<Run>,
    resume: Option<Resume>,
}

enum Run {
    Geologic(Box<Geologic>),
    Thesis(Box<Thesis>),
}

struct Geologic {
    simulation: Simulation,
    warp: Warp,
    /// What the map reads of the plates.
    window: Window,
    first: Vec<Drift>,
    /// Outlines in body coordinates, m.
    bodies: Vec<Vec<DVec2>>,
    /// The map that others carve, where there are any.
    carved: Option<(Carved, Plains)>,
    /// The sea level that its last step ended with, where a share of it is to be land, m.
    level_m: Option<f64>,
}

/// Where a saved run stood: steps taken, and the map it shares with others.
struct Resume {
    steps: u64,
    shared: Option<Shared>,
}

/// What is saved of a map that others carve: the height expected by the plates, and the wear before each step.
struct Shared {
    expected: Field<f32>,
    worn: Vec<Field<f32>>,
}

impl Process for Stage {
    fn up_to_date(&self) -> bool {
        self.leads
    }

    fn writes(&self) -> &'static [Layer] {
        if self.leads { &WRITTEN } else { &WRITTEN[..7] }
    }

    fn fit(&self, grid: &Grid) -> Result<(), ProcessError> {
        let domain = Domain::around(grid, self.params.margin, self.params.cells as usize);
        check(&self.params, &domain)?;
        if self.leads {
            self.check_leading()?;
        }
        self.params.continents.as_deref().map(paint::open_continents).transpose()?;
        self.params.map.as_deref().map(paint::open_plates).transpose()?;
        Ok(())
    }

    fn step(&mut self, world: &mut World, context: &Context) -> Result<Step, ProcessError> {
        if self.run.is_none() {
            self.begin(world, context)?;
        }
        let Some(run) = &mut self.run else { return Ok(Step::WHOLE) };
        let before = run.time_yr(&self.params);
        match run {
            Run::Geologic(geologic) if geologic.carved.is_some() => {
                geologic.advance_carved(&self.params, world, context);
            }
            _ => run.advance(),
        }
        let (steps, done) = run.progress();
        if !run.finite() {
            return Err(ProcessError::Failed(format!(
                "a plate left the numbers at step {done}; lower speed_mm_per_yr"
            )));
        }
        Ok(Step { done: done as f64 / steps as f64, elapsed_yr: run.time_yr(&self.params) - before })
    }

    fn publish(&mut self, world: &mut World, context: &Context) -> Result<(), ProcessError> {
        let (Some(run), Some(ground)) = (&mut self.run, &self.ground) else { return Ok(()) };
        match run {
            Run::Geologic(run) if run.carved.is_some() => run.publish_crust(world, context),
            Run::Geologic(run) => run.publish(&self.params, ground, world, context)?,
            Run::Thesis(run) => {
                ground.put(&run.height, world, context);
                let grid = world.grid;
                let ids = run.owners.iter().map(|&o| o as f32).collect();
                world.set_layer(Layer::PlateId, Field { grid, data: ids });
                world.set_table(thesis_table(run));
            }
        }
        if let Some(share) = self.params.land_share {
            world.sea_level_m = world.height().level_above(share);
        }
        Ok(())
    }

    fn save(&self) -> State {
        let steps = match &self.run {
            Some(run) => run.progress().1,
            None => self.resume.as_ref().map_or(0, |resume| resume.steps),
        };
        let mut fields = self.ground.as_ref().map(Ground::save).unwrap_or_default();
        if let Some((expected, worn)) = self.shared() {
            fields.push((EXPECTED.to_owned(), expected.clone()));
            fields.extend(worn.iter().map(|worn| (WORN.to_owned(), worn.clone())));
        }
        State { fields, blob: steps.to_le_bytes().to_vec() }
    }

    fn restore(&mut self, state: State, _context: &Context) -> Result<(), ProcessError> {
        let broken = || ProcessError::Failed("the saved state of the plates is broken".to_owned());
        let steps = state.blob[..].try_into().map(u64::from_le_bytes).map_err(|_| broken())?;
        self.ground = Ground::restore(self.placement.blend, &state.fields);
        let named = |wanted: &'static str| state.fields.iter().filter(move |(name, _)| name == wanted);
        let worn: Vec<Field<f32>> = named(WORN).map(|(_, field)| field.clone()).collect();
        if worn.len() as u64 != if self.leads { steps } else { 0 } {
            return Err(broken());
        }
        let shared = named(EXPECTED).next().map(|(_, field)| Shared { expected: field.clone(), worn });
        // A run that was saved before its first step begins like any other.
        self.resume = self.ground.is_some().then_some(Resume { steps, shared });
        Ok(())
    }
}

/// Names of saved fields: the height that the plates expect, and the wear before each step.
const EXPECTED: &str = "expected";
const WORN: &str = "worn";

impl Stage {
    /// What has to be saved of a map that others carve.
    fn shared(&self) -> Option<(&Field<f32>, &[Field<f32>])> {
        match (&self.run, &self.resume) {
            (Some(Run::Geologic(run)), _) => run.carved.as_ref().map(|(carved, _)| (carved.expected(), carved.worn())),
            (_, Some(resume)) => resume.shared.as_ref().map(|shared| (&shared.expected, &shared.worn[..])),
            _ => None,
        }
    }

    /// Plates that others carve own the whole ground.
    fn check_leading(&self) -> Result<(), ProcessError> {
        let whole = self.placement.blend == Blend::Replace && self.placement.mask.is_none();
        if whole && self.params.style == PlateStyle::Geologic {
            return Ok(());
        }
        Err(ProcessError::Unfit(
            "a stage is coupled to these plates, so they take no blend, no mask and not the style 'thesis'; set its coupled = false".to_owned(),
        ))
    }

    /// Sets the run up; a resumed one is replayed to where it stood, which gives the same bits.
    fn begin(&mut self, world: &mut World, context: &Context) -> Result<(), ProcessError> {
        if self.ground.is_none() {
            self.ground = Some(self.placement.over(world)?);
        }
        let mut run = match self.params.style {
            PlateStyle::Geologic => {
                Run::Geologic(Box::new(Geologic::new(&self.params, self.steps, world.grid, context.key)?))
            }
            PlateStyle::Thesis => Run::Thesis(Box::new(thesis(&self.params, world.grid, context.key)?)),
        };
        if let (true, Run::Geologic(run)) = (self.leads, &mut run) {
            run.share(&self.params, world, context, self.resume.is_none());
        }
        match (&self.resume, &mut run) {
            (Some(resume), run) => run.replay(resume, &self.params, context)?,
            (None, Run::Geologic(run)) => {
                world.ledger.open(context.stage, Matter::Crust, run.simulation.crust_m3());
            }
            (None, Run::Thesis(_)) => {}
        }
        self.resume = None;
        self.run = Some(run);
        Ok(())
    }
}

impl Run {
    fn advance(&mut self) {
        match self {
            Run::Geologic(run) => run.simulation.advance(),
            Run::Thesis(run) => run.advance(),
        }
    }

    /// Takes the steps of a saved run again.
    fn replay(&mut self, resume: &Resume, params: &PlatesParams, context: &Context) -> Result<(), ProcessError> {
        let worn = resume.shared.as_ref().map_or(&[][..], |shared| &shared.worn);
        for step in 0..resume.steps as usize {
            context.check()?;
            if let (Run::Geologic(run), Some(worn)) = (&mut *self, worn.get(step)) {
                run.simulation.wear(worn);
            }
            self.advance();
        }
        if let Run::Geologic(run) = self
            && let (Some((carved, _)), Some(Shared { expected, worn })) = (&mut run.carved, &resume.shared)
        {
            carved.restore(&run.simulation, params, expected.clone(), worn.clone());
            run.find_level(params);
        }
        Ok(())
    }

    fn progress(&self) -> (u64, u64) {
        match self {
            Run::Geologic(run) => (run.simulation.steps(), run.simulation.steps_done()),
            Run::Thesis(run) => run.progress(),
        }
    }

    /// Years since the stage began; the last step of the engine may be shorter than the others.
    fn time_yr(&self, params: &PlatesParams) -> f64 {
        match self {
            Run::Geologic(run) => run.simulation.time_myr * 1e6,
            Run::Thesis(run) => {
                let (steps, done) = run.progress();
                params.duration_myr * 1e6 * (done as f64 / steps as f64)
            }
        }
    }

    fn finite(&self) -> bool {
        match self {
            Run::Geologic(run) => run.simulation.engine.finite(),
            Run::Thesis(run) => run.engine.finite(),
        }
    }
}

fn settings(params: &PlatesParams, style: Style) -> Settings {
    Settings {
        speed_mm_per_yr: params.speed_mm_per_yr,
        resistance: params.resistance,
        slab_pull: params.slab_pull,
        style,
    }
}

impl Geologic {
    fn new(params: &PlatesParams, steps: Option<u64>, map: Grid, key: Key) -> Result<Self, ProcessError> {
        let domain = Domain::around(&map, params.margin, params.cells as usize);
        let warp = Warp::new(domain.map_m, params.bend, key.named("warp"));
        let (owners, outlines) = match &params.map {
            Some(path) => {
                let (owners, count) = paint::plates(&domain, &warp, path)?;
                let outlines = paint::hulls(&domain, &owners, count);
                (owners, outlines)
            }
            None => {
                let outlines = partition::cut(domain.square_engine(), params.count as usize, key.named("cuts"));
                (initial::owners_of(&domain, &outlines), outlines)
            }
        };
        let painted = params.continents.as_deref().map(|path| paint::light(&domain, &warp, path)).transpose()?;
        let mut continents = initial::continents(&domain, params, painted.as_ref(), key);
        let drives = drives(params, &domain, &warp, &owners, outlines.len(), &mut continents)?;
        let rocks = initial::rocks(&domain, params, &continents, key);
        let mantle = Mantle::new(params.closing, key.named("mantle"));
        let engine = Engine::new(domain, &outlines, drives, mantle, settings(params, Style::Overriding))
            .ok_or_else(|| ProcessError::Unfit("a plate is too thin to move; draw it broader".to_owned()))?;
        // Room for what a plate may win or move in the run.
        let reach_m = 1.5 * fastest(params) * 1e3 * params.duration_myr;
        let n = domain.cells;
        let plates: Vec<Plate> = (0..outlines.len())
            .map(|p| {
                Plate::new(
                    &domain,
                    engine.pose(p),
                    reach_m,
                    |x, y| owners[y * n + x] as usize == p,
                    |x, y| rocks[y * n + x],
                )
            })
            .collect();
        let bodies = outlines
            .iter()
            .enumerate()
            .map(|(p, o)| o.iter().map(|&v| engine.pose(p).to_body(domain.to_map(v))).collect());
        let bodies = bodies.collect();
        let simulation = Simulation::new(domain, plates, engine, rules(params, steps), key);
        let first = (0..simulation.plates.len())
            .map(|p| Drift::of(simulation.engine.velocity_at(p, tables::middle(&simulation, p).0)))
            .collect();
        let window = Surface::window(&domain, params, &warp);
        Ok(Self { simulation, warp, window, first, bodies, carved: None, level_m: None })
    }

    fn publish(
        &mut self,
        params: &PlatesParams,
        ground: &Ground,
        world: &mut World,
        context: &Context,
    ) -> Result<(), ProcessError> {
        let run = &self.simulation;
        let surface = Surface::of(run, params, self.window);
        let map_m = run.domain.map_m;
        let sea_m =
            params.land_share.map_or(world.sea_level_m, |share| surface.sea_level_for(map_m, &self.warp, share));
        // What an earlier frame left makes room first; nothing from here on can fail.
        for layer in SHOWN {
            world.remove_layer(layer);
        }
        let detail = Detail::new(world.grid, params, sea_m, context.key.named("detail"));
        for (layer, field) in surface.read(&self.warp, &detail) {
            match layer {
                Layer::Bedrock => ground.put(&field, world, context),
                other => world.set_layer(other, field),
            }
        }
        // Steps in time belong to the rates that stood there before.
        world.set_uplift_steps(&[]);
        self.show_tables(world);
        self.book(world, context);
        Ok(())
    }

    /// Lays the ground out for others to carve; one that goes on finds it there already.
    fn share(&mut self, params: &PlatesParams, world: &mut World, context: &Context, fresh: bool) {
        let run = &self.simulation;
        let sea_m = params.land_share.map_or(world.sea_level_m, |share| {
            Surface::of(run, params, self.window).sea_level_for(run.domain.map_m, &self.warp, share)
        });
        let plains = Plains::new(world.grid, params, sea_m, context.key.named("detail"));
        let carved = Carved::begin(run, (&self.warp, self.window), params, world.grid, &plains);
        if fresh {
            let before = world.rock_m3();
            for layer in [Layer::Lava, Layer::Sediment, Layer::Wear, Layer::Deposit] {
                world.remove_layer(layer);
            }
            world.set_layer(Layer::Bedrock, carved.expected().clone());
            world.set_uplift_steps(&[]);
            book_rock(world, context, before);
        }
        self.carved = Some((carved, plains));
    }

    /// Finds the sea level on the ground as the plates left it, where a share of the map is to be land.
    fn find_level(&mut self, params: &PlatesParams) {
        let found = self.carved.as_ref().zip(params.land_share);
        self.level_m = found.map(|((carved, _), share)| carved.expected().level_above(share));
    }

    /// A step between two turns of those who carve.
    fn advance_carved(&mut self, params: &PlatesParams, world: &mut World, context: &Context) {
        let Some((carved, plains)) = &mut self.carved else { return };
        let run = &mut self.simulation;
        // One who looked at the world between two steps found the level on the carved ground.
        world.sea_level_m = self.level_m.unwrap_or(world.sea_level_m);
        let wear = carved.read_wear(world, &run.domain);
        run.wear(wear);
        let began_myr = run.time_myr;
        run.advance();
        let span_yr = (run.time_myr - began_myr) * 1e6;
        let before = world.rock_m3();
        carved.carry(run, params, plains, span_yr, world);
        book_rock(world, context, before);
        self.find_level(params);
        world.sea_level_m = self.level_m.unwrap_or(world.sea_level_m);
    }

    /// Shows what the plates know besides the ground, which is up to date after every step.
    fn publish_crust(&mut self, world: &mut World, context: &Context) {
        if let Some((carved, plains)) = &self.carved {
            for (layer, field) in carved.read_crust(plains.border_m) {
                world.set_layer(layer, field);
            }
        }
        self.show_tables(world);
        self.book(world, context);
    }

    fn show_tables(&self, world: &mut World) {
        world.set_table(tables::plates(&self.simulation, &self.warp, &self.first));
        world.set_table(tables::outlines(&self.simulation, &self.warp, &self.bodies));
        world.set_table(tables::convergence(&self.simulation));
        world.set_table(tables::arcs(&self.simulation, &self.warp));
        world.set_vents(&tables::vents(&self.simulation, &self.warp));
    }

    fn book(&self, world: &mut World, context: &Context) {
        let books = self.simulation.books;
        let (came_in_m3, left_m3) = (books.made_m3 + (-books.worn_m3).max(0.0), books.sunk_m3 + books.worn_m3.max(0.0));
        world.ledger.set(context.stage, Matter::Crust, came_in_m3, left_m3);
        world.ledger.close(context.stage, Matter::Crust, self.simulation.crust_m3());
    }
}

/// Books what the column of rock changed by.
fn book_rock(world: &mut World, context: &Context, before_m3: f64) {
    let gained = world.rock_m3() - before_m3;
    if gained >= 0.0 {
        world.ledger.book_in(context.stage, Matter::Rock, gained);
    } else {
        world.ledger.book_out(context.stage, Matter::Rock, -gained);
    }
}

/// The fastest plate's own speed, mm/yr.
fn fastest(params: &PlatesParams) -> f64 {
    params.plate.iter().map(|entry| entry.speed_mm_per_yr).fold(params.speed_mm_per_yr, f64::max)
}

/// Parameters that are sound one by one may not go together, or not with this map.
fn check(params: &PlatesParams, domain: &Domain) -> Result<(), ProcessError> {
    let unfit = |text: String| Err(ProcessError::Unfit(text));
    let (side_km, cell_km) = (domain.side_m / 1e3, domain.cell_m() / 1e3);
    let drift_km = fastest(params) * params.duration_myr;
    if drift_km > side_km {
        return unfit(format!(
            "plates would drift {drift_km:.0} km, across the whole square of {side_km:.0} km; lower duration_myr or the speed"
        ));
    }
    if let Some(index) = params.plate.iter().position(|p| p.speed_mm_per_yr > 10.0 * params.speed_mm_per_yr) {
        return unfit(format!(
            "plate {}: faster than ten times the stage's speed_mm_per_yr; raise that too",
            index + 1
        ));
    }
    if params.style == PlateStyle::Thesis {
        return Ok(());
    }
    if let Some(index) = params.plate.iter().position(|p| !domain.on_map(DVec2::from(p.at_km) * 1e3)) {
        let ([x, y], [w, h]) = (params.plate[index].at_km, (domain.map_m / 1e3).into());
        return unfit(format!("plate {}: at_km = [{x}, {y}] lies outside the map (0 to {w}, 0 to {h})", index + 1));
    }
    // Finer than the tectonic cells nothing can be raised; wider than a sixth of the square all is one range.
    let least = 1.5 * cell_km;
    let bounds =
        [("belt_km", params.belt_km, side_km / 6.0), ("volcano_spacing_km", params.volcano_spacing_km, f64::MAX)];
    match bounds.into_iter().find(|(_, km, most)| !(least..=*most).contains(km)) {
        Some((name, km, most)) if km > most => {
            unfit(format!("{name} = {km} is too wide for this map; at most {most:.1} (lower it or raise extent_km)"))
        }
        Some((name, km, _)) => unfit(format!(
            "{name} = {km} is finer than the tectonic cells resolve; at least {least:.2} (raise it or cells)"
        )),
        None => Ok(()),
    }
}

fn rules(params: &PlatesParams, steps: Option<u64>) -> Rules {
    Rules {
        belt: Belt {
            half_width_m: params.belt_km * 1e3,
            octaves: params.belt_octaves,
            gain: params.belt_gain,
            thickest_m: params.thickest_km * 1e3,
        },
        arc: Arc { offset_m: params.arc_km * 1e3, spacing_m: params.volcano_spacing_km * 1e3 },
        accretion_m: params.accretion_km * 1e3,
        volcano_m_per_myr: params.volcano_m_per_myr,
        speed_m_per_yr: params.speed_mm_per_yr * 1e-3,
        fastest_m_per_yr: fastest(params) * 1e-3,
        duration_myr: params.duration_myr,
        steps,
    }
}

/// What moves each plate; entries are found by the point of the map that shows them.
fn drives(
    params: &PlatesParams,
    domain: &Domain,
    warp: &Warp,
    owners: &[u8],
    count: usize,
    continents: &mut Continents,
) -> Result<Vec<Drive>, ProcessError> {
    let mut drives = vec![Drive::Mantle; count];
    for (index, entry) in params.plate.iter().enumerate() {
        let at_m = DVec2::from(entry.at_km) * 1e3;
        let [x, y] = entry.at_km;
        let cell = super::exchange::cell_index(domain, warp.read_at(at_m)).ok_or_else(|| {
            let what = format!("plate {}: at_km = [{x}, {y}] is bent out of the square; lower bend", index + 1);
            ProcessError::Unfit(what)
        })?;
        let plate = owners[cell];
        if drives[plate as usize] != Drive::Mantle {
            return Err(ProcessError::Unfit(format!(
                "plate {}: at_km = [{x}, {y}] lies on a plate that an earlier entry has",
                index + 1
            )));
        }
        let heading = entry.heading_deg.to_radians();
        let direction = DVec2::new(libm::sin(heading), -libm::cos(heading));
        drives[plate as usize] = Drive::Own(direction * (entry.speed_mm_per_yr / params.speed_mm_per_yr));
        initial::override_crust(continents, owners, plate, entry.crust);
    }
    Ok(drives)
}

fn thesis(params: &PlatesParams, map: Grid, key: Key) -> Result<Thesis, ProcessError> {
    let domain = Domain::around(&map, params.margin, params.cells as usize);
    let square: Polygon = domain.square_engine().into_iter().map(|v| v * THESIS_BLOCK).collect();
    // Chords cross: about (count - 1) / 3 of them make `count` plates.
    let chords = ((params.count as usize).saturating_sub(1)).div_ceil(3).max(1);
    let outlines = partition::cut_by_chords(square, chords, key.named("cuts"));
    let mantle = Mantle::new(0.0, key.named("mantle"));
    let drives = vec![Drive::Mantle; outlines.len()];
    let engine = Engine::new(domain, &outlines, drives, mantle, settings(params, Style::Shaken))
        .ok_or_else(|| ProcessError::Unfit("a plate is too thin to move; ask for fewer plates".to_owned()))?;
    let ids = Field::from_fn(map, |x, y| initial::owner_at(&outlines, domain.to_engine(map.center_m(x, y).into())));
    Ok(Thesis::new(engine, ids.data, map, params, key))
}

fn thesis_table(run: &Thesis) -> Table {
    let rows: Vec<(DVec2, Drift)> = (0..run.engine.plates())
        .map(|p| {
            let at_m = run.engine.pose(p).at_m;
            (at_m, Drift::of(run.engine.velocity_at(p, at_m)))
        })
        .collect();
    Table::new("plates")
        .number("id", "1", (0..rows.len()).map(|p| p as f64).collect())
        .number("x_km", "km", rows.iter().map(|r| r.0.x * 1e-3).collect())
        .number("y_km", "km", rows.iter().map(|r| r.0.y * 1e-3).collect())
        .number("speed_mm_per_yr", "mm/yr", rows.iter().map(|r| r.1.speed_mm_per_yr).collect())
        .number("heading_deg", "deg", rows.iter().map(|r| r.1.heading_deg).collect())
}
