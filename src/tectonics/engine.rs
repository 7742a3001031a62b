//! The plates as rigid bodies in rapier2d: mantle drag, beams, resistance, and what their contacts say.
//!
//! Engine time runs so that the recipe's plate speed is one unit a second, the scale rapier is tuned for. Contacts
//! between plates are read but not solved (`PassThrough`): solid plates would stop each other at the first touch and raise
//! nothing. What holds them is a force of ours that grows with their overlap; beams stay solid. The thesis's own style
//! keeps all contacts solid.
//!
//! Stability: drag is explicit, `drag_per_s · dt` is at most 0.13 < 0.5; speeds are bounded by the drives', and a drive of
//! its own may be ten times the plate speed at most.

use std::sync::Mutex;

use glam::DVec2;
use rapier2d::prelude::*;

use super::{
    contact::Contact,
    domain::{Domain, SIDE_UNITS},
    mantle::Mantle,
    partition::{self, Polygon},
};

/// Engine step, s.
const DT: f64 = 1.0 / 30.0;
/// Rate at which a plate takes up the mantle's velocity, 1/s of engine time.
const DRAG_PER_S: f64 = 4.0;
/// Plates are drawn in by this much, so that corners that meet do not count as contacts, units.
const INSET: f64 = 0.001;
/// Half thickness of a beam, units.
const BEAM_HALF: f64 = 1.0;
/// How far a beam swings to either side, units.
const BEAM_SWING: f64 = 0.3;
/// Period of a beam's swing, s of engine time.
const BEAM_PERIOD_S: f64 = 4.0;
/// Marks beams in `user_data`.
const BEAM: u128 = u128::MAX;

/// What moves one plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// The flow below it.
    Mantle,
    /// A velocity of its own, in units of the recipe's plate speed.
    Own(DVec2),
}

/// How plates and beams meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Plates override each other; resistance grows with overlap.
    Overriding,
    /// Solid plates in a box shaken in pairs of sides, as in the thesis.
    Shaken,
}

/// Settings of the engine, all in the recipe's units.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Plate speed that becomes one engine unit a second, mm/yr.
    pub speed_mm_per_yr: f64,
    /// Share of the drive that two continents take from each other per 100 km of overlap.
    pub resistance: f64,
    /// Pull of a sinking plate on itself, as a share of the drive.
    pub slab_pull: f64,
    /// How plates meet.
    pub style: Style,
}

/// Where a plate is: its body frame's origin and rotation, map metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position of the body's origin, m.
    pub at_m: DVec2,
    /// Cosine and sine of the rotation from body to map axes.
    pub turn: DVec2,
}

impl Pose {
    /// Body coordinates to map coordinates, m.
    pub fn to_map(self, body: DVec2) -> DVec2 {
        self.turn.rotate(body) + self.at_m
    }

    /// Map coordinates to body coordinates, m.
    pub fn to_body(self, at_m: DVec2) -> DVec2 {
        let inverse = DVec2::new(self.turn.x, -self.turn.y);
        inverse.rotate(at_m - self.at_m)
    }
}

/// Ownership of what lies between two plates at their contact: how the crusts there hold each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grip {
    /// Share of continent against continent along the contact, 0 to 1.
    pub continental: f64,
    /// Plate that sinks below the other, if one does.
    pub sinking: Option<usize>,
}

/// The moving plates.
pub struct Engine {
    world: PhysicsWorld,
    domain: Domain,
    settings: Settings,
    plates: Vec<RigidBodyHandle>,
    drives: Vec<Drive>,
    beams: Vec<(RigidBodyHandle, DVec2)>,
    mantle: Mantle,
    elapsed_s: f64,
    /// Engine time of one step, s.
    dt: f64,
    /// Overlap of each pair when the run began (painted plates start overlapped), m.
    start_overlap_m: Vec<(usize, usize, f64)>,
    /// Collisions that began since they were last asked for.
    begun: Vec<[DVec2; 2]>,
}

/// Gathers the pairs whose contact begins. rapier reports them before it solves the step.
#[derive(Default)]
struct Begins(Mutex<Vec<(ColliderHandle, ColliderHandle)>>);

impl EventHandler for Begins {
    fn handle_collision_event(
        &self,
        _: &RigidBodySet,
        _: &ColliderSet,
        event: CollisionEvent,
        _: Option<&ContactPair>,
    ) {
        if let (CollisionEvent::Started(a, b, _), Ok(mut pairs)) = (event, self.0.lock()) {
            pairs.push((a, b));
        }
    }

    fn handle_contact_force_event(&self, _: Real, _: &RigidBodySet, _: &ColliderSet, _: &ContactPair, _: Real) {}

    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}
}

/// Clears the solver's contacts between plates; beams stay solid.
struct PassThrough;

impl PhysicsHooks for PassThrough {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let beam = |handle: ColliderHandle| context.colliders.get(handle).is_some_and(|c| c.user_data == BEAM);
        if !beam(context.collider1)
            && !beam(context.collider2)
            && let Some(manifold) = context.rigid_mut()
        {
            manifold.solver_contacts.clear();
        }
    }
}

fn vector(v: DVec2) -> Vector {
    Vector::new(v.x as f32, v.y as f32)
}

fn double(v: Vector) -> DVec2 {
    DVec2::new(v.x as f64, v.y as f64)
}

impl Engine {
    /// Plates with these outlines (engine units, counter-clockwise), at rest in their places, each moved by its drive.
    pub fn new(
        domain: Domain,
        outlines: &[Polygon],
        drives: Vec<Drive>,
        mantle: Mantle,
        settings: Settings,
    ) -> Option<Self> {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = DT as f32;
        world.integration_parameters.contact_recycling = false;
        let mut plates = Vec::with_capacity(outlines.len());
        for (index, outline) in outlines.iter().enumerate() {
            plates.push(insert_plate(&mut world, outline, index, settings.style)?);
        }
        let beams = insert_beams(&mut world, settings.style);
        let mut engine = Self {
            world,
            domain,
            settings,
            plates,
            drives,
            beams,
            mantle,
            elapsed_s: 0.0,
            dt: DT,
            start_overlap_m: Vec::new(),
            begun: Vec::new(),
        };
        if settings.style == Style::Overriding {
            for plate in 0..engine.plates.len() {
                let velocity = vector(engine.target_velocity(plate));
                engine.world.bodies[engine.plates[plate]].set_linvel(velocity, true);
            }
        }
        Some(engine)
    }

    /// Makes a whole number of steps last exactly `duration_yr`, none longer than the engine's own; returns that number.
    pub fn fit(&mut self, duration_yr: f64) -> u64 {
        let total_s = duration_yr / self.yr_per_s();
        let steps = (total_s / DT).ceil().max(1.0);
        self.dt = total_s / steps;
        self.world.integration_parameters.dt = self.dt as f32;
        steps as u64
    }

    /// Years in one engine step.
    pub fn step_yr(&self) -> f64 {
        self.dt * self.yr_per_s()
    }

    fn yr_per_s(&self) -> f64 {
        // One unit a second is the plate speed.
        self.domain.unit_m() / (self.settings.speed_mm_per_yr * 1e-3)
    }

    /// Engine velocity to m/yr.
    fn m_per_yr(&self, v: DVec2) -> DVec2 {
        v * (self.settings.speed_mm_per_yr * 1e-3)
    }

    /// Number of plates.
    pub fn plates(&self) -> usize {
        self.plates.len()
    }

    /// Runs one engine step. `grip` tells how two plates hold each other.
    pub fn step(&mut self, grip: impl Fn(usize, usize) -> Grip) {
        self.move_beams();
        self.drag();
        if self.settings.style == Style::Overriding {
            self.resist(grip);
            self.world.step_with_events(&PassThrough, &());
        } else {
            let begins = Begins::default();
            self.world.step_with_events(&(), &begins);
            let pairs = begins.0.into_inner().unwrap_or_default();
            let contacts =
                pairs.into_iter().filter_map(|(a, b)| self.world.contact_pair(a, b).and_then(|p| self.read_contact(p)));
            let mut begun: Vec<[DVec2; 2]> = contacts.flatten().map(|c| c.ends_m).collect();
            begun.sort_by(|a, b| a[0].x.total_cmp(&b[0].x).then(a[0].y.total_cmp(&b[0].y)));
            self.begun.extend(begun);
        }
        self.elapsed_s += self.dt;
        if self.start_overlap_m.is_empty() {
            self.start_overlap_m = self.contacts().iter().map(|c| (c.plates[0], c.plates[1], c.overlap_m)).collect();
        }
    }

    /// Segments of the collisions that began since the last call (solid plates only), map metres.
    pub fn take_begun(&mut self) -> Vec<[DVec2; 2]> {
        std::mem::take(&mut self.begun)
    }

    /// Where a plate is.
    pub fn pose(&self, plate: usize) -> Pose {
        let pose = self.world.bodies[self.plates[plate]].position();
        let turn = DVec2::new(pose.rotation.re as f64, pose.rotation.im as f64);
        Pose { at_m: self.domain.to_map(double(pose.translation)), turn: turn.normalize() }
    }

    /// Velocity of a plate at a point of the map, m/yr.
    pub fn velocity_at(&self, plate: usize, at_m: DVec2) -> DVec2 {
        let body = &self.world.bodies[self.plates[plate]];
        self.m_per_yr(double(body.velocity_at_point(vector(self.domain.to_engine(at_m)))))
    }

    /// Whether every body is where a number can say.
    pub fn finite(&self) -> bool {
        self.plates.iter().all(|&h| double(self.world.bodies[h].translation()).is_finite())
    }

    /// Every two-point manifold between two plates, in a fixed order.
    pub fn contacts(&self) -> Vec<Contact> {
        let mut contacts: Vec<Contact> =
            self.world.contact_pairs().filter_map(|pair| self.read_contact(pair)).flatten().collect();
        contacts.sort_by(|a, b| {
            let key = |c: &Contact| (c.plates[0], c.plates[1]);
            key(a).cmp(&key(b)).then(a.ends_m[0].x.total_cmp(&b.ends_m[0].x))
        });
        contacts
    }

    fn read_contact(&self, pair: &ContactPair) -> Option<Vec<Contact>> {
        let colliders = [self.world.colliders.get(pair.collider1)?, self.world.colliders.get(pair.collider2)?];
        if colliders.iter().any(|c| c.user_data == BEAM) {
            return None;
        }
        let ids = colliders.map(|c| c.user_data as usize);
        let contacts = pair.manifolds().iter().filter(|m| m.points.len() == 2).map(|manifold| {
            let world = |side: usize, point: Vector| self.domain.to_map(double(colliders[side].position() * point));
            let surface =
                [0, 1].map(|k| [world(0, manifold.points[k].local_p1), world(1, manifold.points[k].local_p2)]);
            let dist = manifold.points[0].dist.min(manifold.points[1].dist) as f64;
            let normal = double(colliders[0].position().rotation * manifold.local_n1).normalize();
            let ends_m = surface.map(|[a, b]| (a + b) / 2.0);
            let middle = (ends_m[0] + ends_m[1]) / 2.0;
            let relative = self.velocity_at(ids[0], middle) - self.velocity_at(ids[1], middle);
            let contact = Contact {
                plates: ids,
                ends_m,
                surface_m: [[surface[0][0], surface[1][0]], [surface[0][1], surface[1][1]]],
                normal,
                relative_m_per_yr: relative,
                overlap_m: -dist * self.domain.unit_m(),
            };
            if ids[0] < ids[1] { contact } else { contact.swapped() }
        });
        Some(contacts.collect())
    }

    fn target_velocity(&self, plate: usize) -> DVec2 {
        match self.drives[plate] {
            Drive::Own(velocity) => velocity,
            Drive::Mantle => {
                let center = double(self.world.bodies[self.plates[plate]].center_of_mass());
                self.mantle.velocity(center / SIDE_UNITS)
            }
        }
    }

    /// Mantle drag: a force and a torque that draw each plate to the velocity and the spin of the flow below it.
    fn drag(&mut self) {
        for plate in 0..self.plates.len() {
            let target = self.target_velocity(plate);
            let spin = self.target_spin(plate);
            let shaken = self.settings.style == Style::Shaken;
            let body = &mut self.world.bodies[self.plates[plate]];
            body.reset_forces(true);
            body.reset_torques(true);
            if shaken {
                continue;
            }
            let mass = body.mass() as f64;
            let force = (target - double(body.linvel())) * (mass * DRAG_PER_S);
            let inertia = body.mass_properties().local_mprops.principal_inertia() as f64;
            let torque = (spin - body.angvel() as f64) * (inertia * DRAG_PER_S);
            body.add_force(vector(force), true);
            body.add_torque(torque as f32, true);
        }
    }

    /// Half the curl of the flow at a plate's centre, by central differences over a plate's width; rad/s.
    fn target_spin(&self, plate: usize) -> f64 {
        if let Drive::Own(_) = self.drives[plate] {
            return 0.0;
        }
        let at = double(self.world.bodies[self.plates[plate]].center_of_mass()) / SIDE_UNITS;
        let reach = 0.1;
        let flow = |d: DVec2| self.mantle.velocity(at + d * reach);
        let curl = flow(DVec2::X).y - flow(-DVec2::X).y - flow(DVec2::Y).x + flow(-DVec2::Y).x;
        0.5 * curl / (2.0 * reach * SIDE_UNITS)
    }

    /// What two plates do to each other: continents push back as they overlap, a sinking slab pulls its plate on.
    fn resist(&mut self, grip: impl Fn(usize, usize) -> Grip) {
        for contact in self.contacts() {
            let [a, b] = contact.plates;
            let hold = grip(a, b);
            let start = self.start_overlap_m.iter().find(|s| (s.0, s.1) == (a, b)).map_or(0.0, |s| s.2.max(0.0));
            let overlap_m = (contact.overlap_m - start).max(0.0);
            let [ma, mb] = [a, b].map(|plate| self.world.bodies[self.plates[plate]].mass() as f64);
            // The lighter plate sets the scale: the force would take all of its drive at resistance · overlap = 1.
            let full = ma.min(mb) * DRAG_PER_S;
            let push = full * self.settings.resistance * hold.continental * overlap_m / 100e3;
            let middle = vector(self.domain.to_engine(contact.middle_m()));
            let mut force = |plate: usize, f: DVec2| {
                self.world.bodies[self.plates[plate]].add_force_at_point(vector(f), middle, true);
            };
            force(a, -contact.normal * push);
            force(b, contact.normal * push);
            if let Some(sinking) = hold.sinking
                && contact.closing_m_per_yr() > 0.0
            {
                let toward = if sinking == a { contact.normal } else { -contact.normal };
                force(sinking, toward * (full * self.settings.slab_pull));
            }
        }
    }

    fn move_beams(&mut self) {
        for (index, &(handle, inward)) in self.beams.iter().enumerate() {
            let velocity = match self.settings.style {
                Style::Overriding => {
                    // Each side a quarter period behind the one before, so that they stir.
                    let phase = std::f64::consts::TAU * (self.elapsed_s / BEAM_PERIOD_S + 0.25 * index as f64);
                    inward * (std::f64::consts::TAU / BEAM_PERIOD_S * BEAM_SWING * libm::sin(phase))
                }
                Style::Shaken => shake(index, self.elapsed_s),
            };
            self.world.bodies[handle].set_linvel(vector(velocity), true);
        }
    }
}

/// The thesis's shaking: opposite beams move together at one unit a second; bottom and top between -1.5 and 0.5, left and
/// right between -0.5 and 1.5.
fn shake(beam: usize, elapsed_s: f64) -> DVec2 {
    // A triangle wave over a span of two units: 4 s a cycle, starting at offset 0.
    let vertical = beam < 2;
    let start = if vertical { 1.5 } else { 0.5 };
    let rising = (elapsed_s + start) % 4.0 < 2.0;
    let speed = if rising { 1.0 } else { -1.0 };
    if vertical { DVec2::Y * speed } else { DVec2::X * speed }
}

fn insert_plate(world: &mut PhysicsWorld, outline: &[DVec2], index: usize, style: Style) -> Option<RigidBodyHandle> {
    if outline.len() < 3 {
        return None;
    }
    let center = partition::centroid(outline);
    let points = outline.iter().map(|&v| {
        let arm = v - center;
        vector(arm * (1.0 - INSET / arm.length().max(1.0)))
    });
    let collider = ColliderBuilder::convex_polyline(points.collect())?
        .density(1.0)
        .friction(style.friction())
        .restitution(style.restitution())
        .active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS)
        .active_events(ActiveEvents::COLLISION_EVENTS)
        .user_data(index as u128);
    let body = RigidBodyBuilder::dynamic().translation(vector(center)).can_sleep(false);
    Some(world.insert(body, collider).0)
}

/// Beams along the four sides (north, south, west, east): just outside the square, or on its rim to shake what is inside.
fn insert_beams(world: &mut PhysicsWorld, style: Style) -> Vec<(RigidBodyHandle, DVec2)> {
    let out = SIDE_UNITS / 2.0 + if style == Style::Shaken { 0.0 } else { BEAM_HALF };
    let sides = [-DVec2::Y, DVec2::Y, -DVec2::X, DVec2::X];
    sides
        .into_iter()
        .map(|side| {
            let half = side.perp().abs() * (out + BEAM_HALF) + side.abs() * BEAM_HALF;
            let collider = ColliderBuilder::cuboid(half.x as f32, half.y as f32)
                .friction(style.friction())
                .restitution(style.restitution())
                .user_data(BEAM);
            let body = RigidBodyBuilder::kinematic_velocity_based().translation(vector(side * out));
            (world.insert(body, collider).0, -side)
        })
        .collect()
}

impl Style {
    /// Friction of plates and beams: none where ours is the resistance, Box2D-like in the thesis's box.
    fn friction(self) -> f32 {
        if self == Style::Shaken { 0.5 } else { 0.0 }
    }

    /// Restitution of plates and beams; the thesis's is one half.
    fn restitution(self) -> f32 {
        if self == Style::Shaken { 0.5 } else { 0.2 }
    }
}

#[cfg(test)]
#[path = "tests/bodies.rs"]
mod bodies;
