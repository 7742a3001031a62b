//! Horton's ratios: how number, mean length and mean area of streams go from one Strahler order to the next (Horton 1945;
//! Strahler 1957).
//!
//! A stream is a run of channel cells of one order; its area is that at its lower end. Log-linear fits over the orders
//! with at least three streams, all basins of the map together: the last one or two trunks are no sample.

use serde::Serialize;

use super::Network;
use crate::measure::{fit::Line, metric::Missing};

const LEAST_STREAMS: usize = 3;
const LEAST_ORDERS: usize = 3;

/// Streams of one order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OrderRow {
    /// Strahler's order.
    pub order: u8,
    /// How many streams.
    pub streams: usize,
    /// Their mean length, km.
    pub length_km: f64,
    /// Their mean catchment, km².
    pub area_km2: f64,
}

/// Streams by order.
#[derive(Clone, Debug)]
pub struct Horton {
    /// Bifurcation ratio R_B.
    pub bifurcation: f64,
    /// Length ratio R_L.
    pub length: f64,
    /// Area ratio R_A.
    pub area: f64,
    /// Every order there is.
    pub orders: Vec<OrderRow>,
}

/// Strahler's order of every channel cell; 0 elsewhere.
fn strahler(network: &Network) -> Vec<u8> {
    let n = network.receiver.len();
    // The highest order that flows in, and from how many streams.
    let (mut top, mut count, mut order) = (vec![0u8; n], vec![0u8; n], vec![0u8; n]);
    for &i in network.order.iter().rev() {
        let i = i as usize;
        if !network.is_channel(i) {
            continue;
        }
        order[i] = if count[i] >= 2 { top[i].saturating_add(1) } else { top[i].max(1) };
        if let Some(r) = network.below(i) {
            match order[i].cmp(&top[r]) {
                std::cmp::Ordering::Greater => (top[r], count[r]) = (order[i], 1),
                std::cmp::Ordering::Equal => count[r] = count[r].saturating_add(1),
                std::cmp::Ordering::Less => {}
            }
        }
    }
    order
}

/// The ratios of a network.
pub fn horton(network: &Network) -> Result<Horton, Missing> {
    let order = strahler(network);
    let mut length_m = network.step_m.clone();
    let mut sums: Vec<(usize, f64, f64)> = Vec::new();
    for &i in network.order.iter().rev() {
        let i = i as usize;
        if order[i] == 0 {
            continue;
        }
        match network.below(i).filter(|&r| order[r] == order[i]) {
            Some(r) => length_m[r] += length_m[i],
            None => {
                let row = order[i] as usize;
                if sums.len() < row {
                    sums.resize(row, (0, 0.0, 0.0));
                }
                let (streams, length, area) = &mut sums[row - 1];
                (*streams, *length, *area) = (*streams + 1, *length + length_m[i], *area + network.area_m2[i]);
            }
        }
    }
    let row = |(at, &(streams, length_m, area_m2)): (usize, &(usize, f64, f64))| {
        let n = streams.max(1) as f64;
        OrderRow { order: at as u8 + 1, streams, length_km: length_m * 1e-3 / n, area_km2: area_m2 * 1e-6 / n }
    };
    let orders: Vec<OrderRow> = sums.iter().enumerate().map(row).collect();
    let fitted: Vec<OrderRow> = orders.iter().copied().filter(|o| o.streams >= LEAST_STREAMS).collect();
    let few = Missing::TooFew { what: "stream orders with 3 streams", found: fitted.len(), needed: LEAST_ORDERS };
    if fitted.len() < LEAST_ORDERS {
        return Err(few);
    }
    let ratio = |of: fn(&OrderRow) -> f64| {
        let points: Vec<[f64; 2]> = fitted.iter().map(|o| [o.order as f64, libm::log(of(o))]).collect();
        Line::through(&points).map(|line| libm::exp(line.slope)).ok_or(few.clone())
    };
    let bifurcation = 1.0 / ratio(|o| o.streams as f64)?;
    let (length, area) = (ratio(|o| o.length_km)?, ratio(|o| o.area_km2)?);
    Ok(Horton { bifurcation, length, area, orders })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::streams::shapes::{binary, peano};

    #[test]
    fn a_binary_tree_halves() {
        let found = horton(&binary(14)).unwrap();
        assert_eq!(found.orders.len(), 14);
        assert!((found.bifurcation - 2.0).abs() < 1e-12, "{}", found.bifurcation);
        // All links are equally long.
        assert!((found.length - 1.0).abs() < 1e-12);
    }

    #[test]
    fn peanos_basin_has_four_two_four() {
        let found = horton(&peano(10)).unwrap();
        let counts: Vec<usize> = found.orders.iter().rev().map(|o| o.streams).collect();
        assert_eq!(counts[..5], [1, 3, 11, 43, 171]);
        for pair in found.orders.windows(2) {
            // The first order ends at the grain and is as long as the second.
            let wanted = if pair[0].order == 1 { 1.0 } else { 2.0 };
            assert!((pair[1].length_km / pair[0].length_km - wanted).abs() < 1e-12, "{pair:?}");
            assert!((pair[1].area_km2 / pair[0].area_km2 - 4.0).abs() < 1e-12);
        }
        // The counts reach 4 from below: 3, 3.67, 3.91, ...; the lengths' first step is no step.
        assert!((found.bifurcation - 4.0).abs() < 0.05, "{}", found.bifurcation);
        assert!((found.length - 2.0).abs() < 0.12, "{}", found.length);
        assert!((found.area - 4.0).abs() < 1e-9, "{}", found.area);
    }
}
