//! The books: what each stage brought into the world and took out of it, and whether that explains what is there.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// What is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Matter {
    /// The column of rock over the map: bedrock, lava and sediment.
    Rock,
    /// Whole crust on the plates, also outside the map.
    Crust,
    /// Loose sediment.
    Sediment,
    /// Water on land.
    Water,
    /// Molten lava.
    Lava,
}

/// One stage's account of one kind of matter, m³.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// Stock when the stage began.
    pub start_m3: f64,
    /// Came in while it ran.
    pub came_in_m3: f64,
    /// Left while it ran.
    pub left_m3: f64,
    /// Stock when it ended.
    pub end_m3: f64,
}

impl Account {
    /// What the books cannot explain, m³.
    pub fn residual_m3(&self) -> f64 {
        self.end_m3 - self.start_m3 - self.came_in_m3 + self.left_m3
    }

    /// The residual as a share of what moved (0 where nothing moved and nothing is missing).
    pub fn residual_share(&self) -> f64 {
        let moved = self.came_in_m3.abs() + self.left_m3.abs();
        let residual = self.residual_m3().abs();
        if residual == 0.0 { 0.0 } else { residual / moved }
    }
}

/// The two clocks of a stage in which water runs in its own time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clocks {
    /// How long its water runs, s.
    pub water_s: f64,
    /// The bed's time over the water's.
    pub morphological_factor: f64,
}

/// The accounts of all stages, and the clocks of those that have two.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ledger {
    accounts: BTreeMap<(String, Matter), Account>,
    clocks: BTreeMap<String, Clocks>,
}

impl Ledger {
    /// Notes how the clocks of `stage` go.
    pub fn set_clocks(&mut self, stage: &str, clocks: Clocks) {
        self.clocks.insert(stage.to_owned(), clocks);
    }

    /// How the clocks of `stage` go, if it has two.
    pub fn clocks(&self, stage: &str) -> Option<Clocks> {
        self.clocks.get(stage).copied()
    }

    /// All stages with two clocks.
    pub fn all_clocks(&self) -> impl Iterator<Item = (&str, Clocks)> {
        self.clocks.iter().map(|(stage, clocks)| (stage.as_str(), *clocks))
    }

    /// Adds to what came in during `stage`.
    pub fn book_in(&mut self, stage: &str, matter: Matter, m3: f64) {
        self.account_mut(stage, matter).came_in_m3 += m3;
    }

    /// Adds to what left during `stage`.
    pub fn book_out(&mut self, stage: &str, matter: Matter, m3: f64) {
        self.account_mut(stage, matter).left_m3 += m3;
    }

    /// Notes what came in and what left since the start of `stage`, in place of what was noted before.
    pub fn set(&mut self, stage: &str, matter: Matter, came_in_m3: f64, left_m3: f64) {
        let account = self.account_mut(stage, matter);
        (account.came_in_m3, account.left_m3) = (came_in_m3, left_m3);
    }

    /// Notes the stock at the start of a stage.
    pub fn open(&mut self, stage: &str, matter: Matter, m3: f64) {
        let account = self.account_mut(stage, matter);
        account.start_m3 = m3;
        account.end_m3 = m3;
    }

    /// Notes the stock at the end of a stage.
    pub fn close(&mut self, stage: &str, matter: Matter, m3: f64) {
        self.account_mut(stage, matter).end_m3 = m3;
    }

    /// Adds what the stock changed by in one turn of a stage that takes turns with others.
    pub fn turn(&mut self, stage: &str, matter: Matter, gained_m3: f64) {
        self.account_mut(stage, matter).end_m3 += gained_m3;
    }

    /// All accounts, by stage and matter.
    pub fn accounts(&self) -> impl Iterator<Item = (&str, Matter, &Account)> {
        self.accounts.iter().map(|((stage, matter), account)| (stage.as_str(), *matter, account))
    }

    /// One account.
    pub fn account(&self, stage: &str, matter: Matter) -> Option<&Account> {
        self.accounts.get(&(stage.to_owned(), matter))
    }

    fn account_mut(&mut self, stage: &str, matter: Matter) -> &mut Account {
        self.accounts.entry((stage.to_owned(), matter)).or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_booking_shows() {
        let mut ledger = Ledger::default();
        ledger.open("hills", Matter::Rock, 10.0);
        ledger.book_in("hills", Matter::Rock, 5.0);
        ledger.book_out("hills", Matter::Rock, 2.0);
        ledger.close("hills", Matter::Rock, 13.0);
        assert_eq!(ledger.account("hills", Matter::Rock).unwrap().residual_m3(), 0.0);
        ledger.close("hills", Matter::Rock, 14.0);
        assert!((ledger.account("hills", Matter::Rock).unwrap().residual_share() - 1.0 / 7.0).abs() < 1e-15);
    }
}
