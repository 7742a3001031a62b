//! Stages that step in turn: a leader, which says how long a step is, and those coupled to it, which follow for as many
//! years. A stage alone is a group of one. They still meet only through the world.

use std::{sync::atomic::AtomicBool, time::Instant};

use crate::{
    bake::Tape,
    process::{Context, Process, ProcessError, State, Step},
    recipe::Stage,
    world::{Layer, Ledger, Matter, World},
};

use super::StageRecord;

/// A turn that was begun by the leader is taken by all, so that the group has stepped whole or not at all.
static NEVER: AtomicBool = AtomicBool::new(false);

/// A stage of the plan that runs, with those coupled to it.
pub struct Group<'a> {
    members: Vec<Member<'a>>,
    seed: u64,
    cancel: &'a AtomicBool,
    tape: Option<&'a dyn Tape>,
}

struct Member<'a> {
    stage: &'a Stage,
    process: Box<dyn Process>,
    seconds: f64,
}

/// Which stage could not go on, and why.
pub struct Failure<'a> {
    /// The stage.
    pub stage: &'a Stage,
    /// In its own words.
    pub why: ProcessError,
}

impl<'a> Group<'a> {
    /// Fresh processes for a stage and those coupled to it.
    pub fn new(stage: &'a Stage, seed: u64, cancel: &'a AtomicBool) -> Result<Self, Failure<'a>> {
        let member = |stage: &'a Stage| {
            let process = stage.build().map_err(|why| Failure { stage, why })?;
            Ok(Member { stage, process, seconds: 0.0 })
        };
        let members = std::iter::once(stage).chain(&stage.coupled).map(member).collect::<Result<_, _>>()?;
        Ok(Self { members, seed, cancel, tape: None })
    }

    /// The same with the leader's particles recorded.
    pub fn recording(self, tape: Option<&'a dyn Tape>) -> Self {
        Self { tape, ..self }
    }

    /// One step of all.
    pub fn step(&mut self, world: &mut World) -> Result<Step, Failure<'a>> {
        let mut taken = Step::WHOLE;
        for at in 0..self.members.len() {
            let started = Instant::now();
            let context = self.context(at);
            let process = &mut self.members[at].process;
            let stepped = if at == 0 {
                context.check().and_then(|()| process.step(world, &context)).map(|step| taken = step)
            } else {
                process.follow(world, &context, taken.elapsed_yr)
            };
            stepped.map_err(|why| self.failure(at, why))?;
            self.take_turn(at, world);
            self.members[at].seconds += started.elapsed().as_secs_f64();
        }
        Ok(taken)
    }

    /// Brings the world up to date with all of them.
    pub fn publish(&mut self, world: &mut World) -> Result<(), Failure<'a>> {
        for at in 0..self.members.len() {
            let context = self.context(at);
            self.members[at].process.publish(world, &context).map_err(|why| self.failure(at, why))?;
            self.take_turn(at, world);
        }
        Ok(())
    }

    /// Opens the books of each.
    pub fn open(&self, world: &mut World) {
        let stock = world.rock_m3();
        for member in &self.members {
            world.ledger.open(&member.stage.key, Matter::Rock, stock);
        }
    }

    /// Closes the books of a stage alone; those that take turns have theirs up to date.
    pub fn close(&self, world: &mut World) {
        if let [alone] = &self.members[..] {
            world.ledger.close(&alone.stage.key, Matter::Rock, world.rock_m3());
        }
    }

    /// Whether the ground is up to date with all of them after a step.
    pub fn up_to_date(&self) -> bool {
        self.members.iter().all(|member| member.process.up_to_date())
    }

    /// Layers that any of them may change.
    pub fn writes(&self) -> impl Iterator<Item = Layer> + '_ {
        self.members.iter().flat_map(|member| member.process.writes().iter().copied())
    }

    /// What all of them need to go on later.
    pub fn save(&self) -> State {
        let mut all = State::default();
        for (at, state) in self.members.iter().map(|member| member.process.save()).enumerate() {
            all.blob.extend((state.blob.len() as u64).to_le_bytes());
            all.blob.extend(state.blob);
            all.fields.extend(state.fields.into_iter().map(|(name, field)| (format!("{at}:{name}"), field)));
        }
        all
    }

    /// Puts a saved state back.
    pub fn restore(&mut self, mut state: State) -> Result<(), Failure<'a>> {
        for at in 0..self.members.len() {
            let context = self.context(at);
            let restored = part(&mut state, at).and_then(|mine| self.members[at].process.restore(mine, &context));
            restored.map_err(|why| self.failure(at, why))?;
        }
        Ok(())
    }

    /// What they cost: `seconds` in all, of which each that follows knows its own; `ledger` knows their clocks.
    pub fn records(&self, steps: u64, seconds: f64, elapsed_yr: f64, ledger: &Ledger) -> Vec<StageRecord> {
        let following: f64 = self.members[1..].iter().map(|member| member.seconds).sum();
        let record = |(at, member): (usize, &Member)| StageRecord {
            stage: member.stage.key.clone(),
            kind: member.stage.kind.kind.to_owned(),
            steps,
            seconds: if at == 0 { (seconds - following).max(0.0) } else { member.seconds },
            elapsed_yr,
            clocks: ledger.clocks(&member.stage.key),
            findings: member.process.findings(),
        };
        self.members.iter().enumerate().map(record).collect()
    }

    fn context(&self, at: usize) -> Context<'a> {
        let (cancel, tape) = if at == 0 { (self.cancel, self.tape) } else { (&NEVER, None) };
        Context::new(self.seed, &self.members[at].stage.key, cancel).recording(tape)
    }

    fn failure(&self, at: usize, why: ProcessError) -> Failure<'a> {
        Failure { stage: self.members[at].stage, why }
    }

    /// Books what the stock of rock changed by in a turn: what all accounts of the group know ends where the world does.
    fn take_turn(&self, at: usize, world: &mut World) {
        if self.members.len() == 1 {
            return;
        }
        let ends = |member: &Member| world.ledger.account(&member.stage.key, Matter::Rock).copied().unwrap_or_default();
        let known = ends(&self.members[0]).start_m3
            + self.members.iter().map(ends).map(|account| account.end_m3 - account.start_m3).sum::<f64>();
        let stock = world.rock_m3();
        let gained = stock - known;
        // What the sums themselves leave open is nobody's turn.
        if gained.abs() <= 1e-12 * stock.abs().max(known.abs()) {
            return;
        }
        world.ledger.turn(&self.members[at].stage.key, Matter::Rock, gained);
    }
}

/// The part of a saved state that belongs to one member; they are taken in order.
fn part(state: &mut State, at: usize) -> Result<State, ProcessError> {
    let broken = || ProcessError::Failed("the saved state of the stage is broken".to_owned());
    let (length, rest) = state.blob.split_first_chunk::<8>().ok_or_else(broken)?;
    let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| broken())?;
    let (blob, rest) = rest.split_at_checked(length).ok_or_else(broken)?;
    let (blob, rest) = (blob.to_vec(), rest.to_vec());
    state.blob = rest;
    let prefix = format!("{at}:");
    let named = |(name, field): &(String, _)| Some((name.strip_prefix(&prefix)?.to_owned(), Clone::clone(field)));
    Ok(State { fields: state.fields.iter().filter_map(named).collect(), blob })
}
