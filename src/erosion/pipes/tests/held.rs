//! What may not change does not.

use super::*;

/// A shore of a plane that falls to the west, with its sea at 0.
fn shore(edges: Edges) -> Bed {
    let mut shore = bed(48, 32, 6.0, edges, |x, y| 0.25 * rough(x, y) - 18.0 + 0.4 * x as f32);
    shore.sea_m = 0.0;
    shore.locked = true;
    shore
}

#[test]
fn a_locked_coast_keeps_a_margin() {
    // Much sediment, for which the sea has no room: what is stuck there grows, and its rounding with it.
    let params =
        PipesParams { duration_h: 1.0, rain_mm_per_h: 300.0, morphological_factor: 400.0, ..Default::default() };
    for rated in [false, true] {
        let mut bed = shore(Edges::Closed);
        if rated {
            bed.rate = (0..bed.start.len()).map(|i| 0.5 + 0.25 * (i % 3) as f32).collect();
        }
        let mut pipes = Pipes::new(params.clone(), &bed, None);
        pipes.load.fill(20.0);
        let loaded = sum_f64(&pipes.load) * 400.0;
        let margin = 1e-4f32;
        let clear = |bed: &Bed| {
            (0..bed.start.len()).all(|i| {
                let (was, is) = (bed.start[i], bed.height(i));
                (was < 0.0) == (is < 0.0) && is.abs() >= 0.9 * margin.min(was.abs())
            })
        };
        for step in 0..4 {
            pipes.advance(&mut bed, Part { step, steps: 4 });
            assert!(clear(&bed), "step {step}");
        }
        pipes.settle(&mut bed);
        assert!(clear(&bed));
        let off = sum_f64(&bed.change) - loaded;
        assert!(off.abs() < 1e-5 * loaded, "{off} of {loaded}");
    }
}

#[test]
fn nothing_is_laid_where_the_mask_is_none() {
    let mut bed = bed(48, 40, 6.0, Edges::Closed, rough);
    bed.rate = (0..bed.start.len()).map(|i| if i % 48 < 24 { 1.0 } else { 0.0 }).collect();
    let mut pipes = Pipes::new(PipesParams { duration_h: 0.3, ..Default::default() }, &bed, None);
    pipes.advance(&mut bed, WHOLE);
    let (area, was) = (36.0, sum_f64(&bed.change));
    let carried = pipes.carried_m3() / area;
    assert!((0..bed.start.len()).any(|i| bed.rate[i] == 0.0 && pipes.load[i] > 0.0));
    pipes.settle(&mut bed);
    assert!((0..bed.start.len()).all(|i| bed.rate[i] > 0.0 || bed.change[i] == 0.0));
    assert!((sum_f64(&bed.change) - was - carried).abs() < 1e-4 && pipes.carried_m3() == 0.0);
}

#[test]
fn rates_of_one_change_nothing() {
    let storm = |rate: Vec<f32>| {
        let mut bed = bed(48, 40, 6.0, Edges::Open, rough);
        bed.rate = rate;
        Pipes::new(PipesParams { duration_h: 0.2, ..Default::default() }, &bed, None).advance(&mut bed, WHOLE);
        bed.change
    };
    assert!(storm(Vec::new()) == storm(vec![1.0; 48 * 40]));
}
