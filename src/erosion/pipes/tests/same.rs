//! The same bits, however they are come by.

use super::*;
use crate::erosion::bed::Saved;

fn storm(flux: Flux, sediment: Sediment) -> PipesParams {
    PipesParams { duration_h: 0.1, flux, sediment, ..PipesParams::default() }
}

#[test]
fn threads_do_not_matter() {
    for (flux, sediment, momentum) in [
        (Flux::Signed, Sediment::Flux, false),
        (Flux::Mei, Sediment::Flux, false),
        (Flux::Signed, Sediment::Maccormack, true),
    ] {
        let ends: Vec<_> = [1, 2, 8]
            .map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let mut bed = bed(150, 131, 6.0, Edges::Open, rough);
                    let mut pipes = Pipes::new(PipesParams { momentum, ..storm(flux, sediment) }, &bed, None);
                    let moved = pipes.advance(&mut bed, WHOLE);
                    (bed.change, pipes.save(), moved)
                })
            })
            .into_iter()
            .collect();
        assert!(ends[0].0.iter().any(|&v| v != 0.0) && ends.iter().all(|end| *end == ends[0]));
    }
}

#[test]
fn a_saved_state_goes_on_as_if_nothing_had_been() {
    for (flux, momentum) in [(Flux::Signed, false), (Flux::Mei, false), (Flux::Signed, true)] {
        let params = PipesParams { momentum, ..storm(flux, Sediment::Flux) };
        let parts = |from: u64| (from..4).map(|step| Part { step, steps: 4 });
        let mut whole = bed(40, 33, 6.0, Edges::Wrap, rough);
        let mut pipes = Pipes::new(params.clone(), &whole, None);
        for part in parts(0) {
            pipes.advance(&mut whole, part);
        }
        let mut cut = bed(40, 33, 6.0, Edges::Wrap, rough);
        let mut first = Pipes::new(params.clone(), &cut, None);
        for part in parts(0).take(2) {
            first.advance(&mut cut, part);
        }
        let Saved { fields, blob } = first.save();
        let field = |name: &str| fields.iter().find(|(of, _)| *of == name).map(|(_, values)| values.clone());
        let mut second = Pipes::new(params, &cut, None);
        assert!(second.restore(&field, &blob[1..]).is_none() && second.restore(&|_| None, &blob).is_none());
        second.restore(&field, &blob).unwrap();
        for part in parts(2) {
            second.advance(&mut cut, part);
        }
        assert!(cut.change == whole.change && second.save() == pipes.save());
    }
}

#[test]
fn a_bowl_stays_as_symmetric_as_it_was() {
    let n = 33usize;
    let mut bowl = bed(n, n, 6.0, Edges::Closed, |x, y| {
        let (x, y) = (x as f32 - 16.0, y as f32 - 16.0);
        0.15 * (x * x + y * y)
    });
    let mut pipes = Pipes::new(PipesParams { duration_h: 0.2, ..Default::default() }, &bowl, None);
    pipes.advance(&mut bowl, WHOLE);
    let at = |x: usize, y: usize| bowl.change[y * n + x];
    let (mut most, mut off) = (0.0f32, 0.0f32);
    for y in 0..n {
        for x in 0..n {
            most = most.max(at(x, y).abs());
            for other in [at(n - 1 - x, y), at(x, n - 1 - y), at(y, x)] {
                off = off.max((at(x, y) - other).abs());
            }
        }
    }
    assert!(most > 0.1 && off <= 1e-5 * most, "{most} {off}");
}
