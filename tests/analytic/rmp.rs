//! Voronoi and line partitions against the statistics of Poisson mosaics.

use upthrust::{
    noise::Key,
    rmp::{Arrangement, MEAN_WEIGHT, Order, Probe, density_for_half_width},
};

fn holds(outline: &[[f64; 2]], p: [f64; 2]) -> bool {
    let side = |i: usize| {
        let (a, b) = (outline[i], outline[(i + 1) % outline.len()]);
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0.0
    };
    (1..outline.len()).all(|i| side(i) == side(0))
}

fn area(outline: &[[f64; 2]]) -> f64 {
    let cross = |i: usize| {
        let (a, b) = (outline[i], outline[(i + 1) % outline.len()]);
        a[0] * b[1] - a[1] * b[0]
    };
    0.5 * (0..outline.len()).map(cross).sum::<f64>().abs()
}

#[test]
fn peak_profile_area_and_weight() {
    let table = [
        (0.1, 0.876),
        (0.2, 0.757),
        (0.3, 0.645),
        (0.5, 0.445),
        (0.7, 0.282),
        (1.0, 0.118),
        (1.4, 0.025),
        (2.0, 0.001),
    ];
    let (density, draws) = (4e-6, 20_000);
    let probe = Probe::new(&[[1234.0, 987.0]], density);
    let (mut hits, mut areas, mut weights) = ([0usize; 8], 0.0, 0.0);
    for draw in 0..draws {
        let cells = probe.cells(Key::new(11).with(draw));
        assert_eq!(cells.len(), 1);
        let outline = &cells[0].outline;
        assert!(holds(outline, [1234.0, 987.0]), "the peak itself is always raised");
        areas += area(outline) * density;
        weights += cells[0].weight;
        for (hit, (u, _)) in hits.iter_mut().zip(table) {
            let d = u / density.sqrt();
            let at = [[d, 0.0], [-d, 0.0], [0.0, d], [0.0, -d]];
            *hit += at.iter().filter(|o| holds(outline, [1234.0 + o[0], 987.0 + o[1]])).count();
        }
    }
    for (hit, (u, p)) in hits.iter().zip(table) {
        let measured = *hit as f64 / (4 * draws) as f64;
        // Four nearly independent samples a draw: standard error at most 0.5/√(2·draws) = 0.0025; four of them.
        assert!((measured - p).abs() < 0.01, "p({u}) = {measured}, not {p}");
    }
    let mean = |sum: f64| sum / draws as f64;
    // The size-biased cell has a standard deviation of about 0.64 of its site's share: standard error 0.0045.
    assert!((mean(areas) - 1.28).abs() < 0.02, "mean raised area {} sites' share", mean(areas));
    // A weight's standard deviation is 0.16: standard error 0.0011.
    assert!((mean(weights) - MEAN_WEIGHT).abs() < 0.005, "{}", mean(weights));
}

#[test]
fn cells_crossed_by_a_segment() {
    let (length, draws) = (30.0, 3000u64);
    let probe = Probe::new(&[[0.0, 0.0], [length * 0.6, length * 0.8]], 1.0);
    let crossed: usize = (0..draws).map(|draw| probe.cells(Key::new(5).with(draw)).len()).sum();
    let want = 1.0 + 4.0 / std::f64::consts::PI * length;
    let mean = crossed as f64 / draws as f64;
    // The count's variance is below its mean, 39: standard error below 0.115.
    assert!((mean - want).abs() < 0.5, "{mean} cells, not {want}");
}

#[test]
fn half_width_is_where_half_is_left() {
    let probe = Probe::new(&[[0.0, 0.0]], density_for_half_width(25e3));
    let draws = 10_000u64;
    let hit = |draw: u64| holds(&probe.cells(Key::new(3).with(draw))[0].outline, [0.0, 25e3]);
    let share = (0..draws).filter(|&draw| hit(draw)).count() as f64 / draws as f64;
    // Standard error 0.005.
    assert!((share - 0.5).abs() < 0.02, "{share}");
}

/// For a Poisson process of lines no line parts two points with a chance exponential in their distance; for `c` uniform
/// lines that meet a rectangle of perimeter P it is `(1 − 2d/P)^c`.
#[test]
fn lines_favour_no_place() {
    let (extent, lines, draws) = ([400.0, 300.0], 12, 6000u64);
    for place in [[200.0, 150.0], [60.0, 40.0], [350.0, 200.0]] {
        for d in [10.0, 30.0] {
            let together = (0..draws)
                .filter(|&draw| {
                    let cut = Arrangement::random(extent, lines, Key::new(9).with(draw));
                    cut.face_at(place) == cut.face_at([place[0] + d, place[1]])
                })
                .count();
            let want = (1.0 - 2.0 * d / 1400.0f64).powi(lines as i32);
            let share = together as f64 / draws as f64;
            // Standard error at most 0.0065; four of them.
            assert!((share - want).abs() < 0.026, "at {place:?}, {d}: {share}, not {want}");
        }
    }
}

#[test]
fn first_faces_grow_around_the_peak() {
    for seed in 0..50 {
        let cut = Arrangement::random([1000.0, 700.0], 10, Key::new(seed));
        assert_eq!(cut.faces.len(), 1 + 10 + cut.crossings);
        let start = cut.face_at([480.0, 333.0]).unwrap();
        for order in [Order::Breadth, Order::Depth] {
            let all = cut.first_faces(start, usize::MAX, order);
            assert_eq!(all.len(), cut.faces.len(), "every face is reached once");
            assert_eq!(cut.first_faces(start, 7, order), all[..7]);
        }
        // Breadth first takes all of the start's neighbours before any other face.
        let near = cut.faces[start].neighbours.len();
        let breadth = cut.first_faces(start, near + 1, Order::Breadth);
        assert!(cut.faces[start].neighbours.iter().all(|n| breadth.contains(n)));
    }
}
