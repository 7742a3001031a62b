//! Stretches of border: contacts cut where the crust on either side changes, each with what happens along it.

use glam::DVec2;

use super::{
    contact::{Contact, Motion},
    engine::Grip,
    exchange::Polarity,
    plate::{Plate, Rock},
};

/// What a stretch of border does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meeting {
    /// Continent against continent.
    Collision,
    /// One plate sinks below the other.
    Subduction,
    /// Plates part.
    Spreading,
    /// Plates slide past each other.
    Transform,
}

/// A piece of a contact along which one thing happens.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// The plate on top.
    pub over: usize,
    /// The plate below.
    pub under: usize,
    /// Ends on the edge of the plate on top, map metres.
    pub ends_m: [DVec2; 2],
    /// Unit vector into the plate on top.
    pub inland: DVec2,
    /// What happens.
    pub meeting: Meeting,
    /// Closing speed, m/yr.
    pub closing_m_per_yr: f64,
}

impl Stretch {
    /// Length, m.
    pub fn length_m(&self) -> f64 {
        self.ends_m[0].distance(self.ends_m[1])
    }
}

/// What two rocks do as their plates close: who is on top, and whether they collide or one sinks.
pub fn meeting(a: (usize, &Rock), b: (usize, &Rock), polarity: &Polarity) -> (usize, usize, Meeting) {
    let (over, under) = if polarity.wins(a.0, a.1, b.0, b.1) { (a.0, b.0) } else { (b.0, a.0) };
    let both = a.1.kind > 0.5 && b.1.kind > 0.5;
    (over, under, if both { Meeting::Collision } else { Meeting::Subduction })
}

/// The closing stretches of a contact, cut every `piece_m` and joined where nothing changes.
pub fn closing_stretches(contact: &Contact, plates: &[Plate], polarity: &Polarity, piece_m: f64) -> Vec<Stretch> {
    if contact.motion() != Motion::Convergent {
        return Vec::new();
    }
    let pieces = (contact.length_m() / piece_m).ceil().max(1.0) as usize;
    let mut stretches: Vec<Stretch> = Vec::new();
    for piece in 0..pieces {
        let (from, to) = (piece as f64 / pieces as f64, (piece + 1) as f64 / pieces as f64);
        let Some([a, b]) = rocks_beside(contact, plates, (from + to) / 2.0, piece_m) else { continue };
        let (over, under, meeting) = meeting((contact.plates[0], &a), (contact.plates[1], &b), polarity);
        let side = usize::from(over == contact.plates[1]);
        let surface = contact.surface_m[side];
        let at = |t: f64| surface[0].lerp(surface[1], t);
        match stretches.last_mut() {
            Some(last) if last.over == over && last.meeting == meeting && last.ends_m[1].distance(at(from)) < 1.0 => {
                last.ends_m[1] = at(to);
            }
            _ => stretches.push(Stretch {
                over,
                under,
                ends_m: [at(from), at(to)],
                inland: if side == 0 { -contact.normal } else { contact.normal },
                meeting,
                closing_m_per_yr: contact.closing_m_per_yr(),
            }),
        }
    }
    stretches
}

/// The rock of both plates beside a point of the contact: the first owned cell from the border inwards.
fn rocks_beside(contact: &Contact, plates: &[Plate], along: f64, piece_m: f64) -> Option<[Rock; 2]> {
    let mut rocks = [None, None];
    for (side, inward) in [(0, -contact.normal), (1, contact.normal)] {
        let from = contact.surface_m[side][0].lerp(contact.surface_m[side][1], along);
        let plate = &plates[contact.plates[side]];
        let reach = contact.overlap_m.max(0.0) + 2.0 * piece_m;
        let step = plate.frame.cell_m;
        let steps = (reach / step) as usize + 2;
        // Half a piece in: the rim cells themselves are the first to be worn and refilled.
        rocks[side] = (0..steps)
            .map(|s| from + inward * (step * s as f64 + 0.25 * piece_m))
            .find_map(|at| plate.owned_under(at))
            .map(|cell| plate.rock[cell]);
    }
    Some([rocks[0]?, rocks[1]?])
}

/// How two plates hold each other along their contact, from its closing stretches.
pub fn grip(stretches: &[Stretch]) -> Grip {
    let (mut whole, mut continental, mut sinking) = (0.0, 0.0, None);
    for stretch in stretches {
        whole += stretch.length_m();
        match stretch.meeting {
            Meeting::Collision => continental += stretch.length_m(),
            _ => sinking = Some(stretch.under),
        }
    }
    let continental = if whole > 0.0 { continental / whole } else { 0.0 };
    Grip { continental, sinking: sinking.filter(|_| continental < 0.5) }
}
