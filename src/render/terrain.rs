//! Which patches of ground a picture needs: a quadtree over the map, finer near the eye (continuous distance-dependent
//! levels, Strugar 2010). Every patch is the same lattice of vertices; a level's cells are twice the next finer's.
//!
//! A patch changes into the coarser one before its neighbour is coarser, so that edges always meet.

use glam::{DMat4, DVec3, DVec4};

use super::ground::Lie;
use crate::grid::Field;

/// Cells along a patch's side.
pub const PATCH: usize = 32;
/// Share of a level's range in which it does not change yet.
const STEADY: f64 = 0.7;

/// A patch to be drawn; what the vertex shader is told.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Patch {
    /// First cell, cells from one vertex to the next, level.
    pub patch: [f32; 4],
    /// Where it begins to change and is changed, m; vertices a side.
    pub range: [f32; 4],
}

/// Lowest and highest ground of every patch of every level.
pub struct Quadtree {
    /// Patches a side, and their heights, m; from the finest level.
    levels: Vec<([usize; 2], Vec<[f32; 2]>)>,
    lie: Lie,
    size: [usize; 2],
}

/// What is seen.
pub struct Seen {
    /// From the map's metres to the picture.
    pub matrix: DMat4,
    /// The eye, m.
    pub eye: DVec3,
    /// Pixels of a metre at a distance of one.
    pub pixels: f64,
    /// Cells may be so large on the picture, pixels.
    pub most_px: f64,
}

impl Quadtree {
    /// That of a map.
    pub fn new(height: &Field<f32>, lie: Lie) -> Self {
        let size = [height.grid.width, height.grid.height];
        let sides = size.map(|n| (n - 1).div_ceil(PATCH).max(1));
        let finest: Vec<[f32; 2]> = (0..sides[0] * sides[1])
            .map(|i| {
                let [x0, y0] = [i % sides[0] * PATCH, i / sides[0] * PATCH];
                let mut range = [f32::INFINITY, f32::NEG_INFINITY];
                for y in y0..(y0 + PATCH + 1).min(size[1]) {
                    for &h in &height.row(y)[x0.min(size[0] - 1)..(x0 + PATCH + 1).min(size[0])] {
                        range = [range[0].min(h), range[1].max(h)];
                    }
                }
                range
            })
            .collect();
        let mut levels = vec![(sides, finest)];
        while let Some(([w, h], below)) = levels.last()
            && w * h > 1
        {
            let (w, h) = (*w, *h);
            let up = [w.div_ceil(2), h.div_ceil(2)];
            let mut above = vec![[f32::INFINITY, f32::NEG_INFINITY]; up[0] * up[1]];
            for (i, range) in below.iter().enumerate() {
                let out = &mut above[(i / w / 2) * up[0] + i % w / 2];
                *out = [out[0].min(range[0]), out[1].max(range[1])];
            }
            levels.push((up, above));
        }
        Self { levels, lie, size }
    }

    /// Distance up to which a level is drawn, m. Cells at its near end, where the level below ends, are the largest on the
    /// picture; a patch must fit in the range, or its edges would not meet.
    fn range_m(&self, level: usize, seen: &Seen) -> f64 {
        let by_size = 2.0 * self.lie.cell_m * seen.pixels / seen.most_px;
        let by_patch = self.lie.cell_m * PATCH as f64 * 3.2;
        by_size.max(by_patch) * (1u64 << level) as f64
    }

    /// The patches of a picture, near ones first.
    pub fn select(&self, seen: &Seen) -> Vec<Patch> {
        let mut out = Vec::new();
        let planes = planes(seen.matrix);
        self.visit(self.levels.len() - 1, [0, 0], seen, &planes, &mut out);
        let near = |patch: &Patch| {
            let half = 0.5 * PATCH as f64 * f64::from(patch.patch[2]);
            let at = [0, 1].map(|axis: usize| {
                let cell = f64::from(patch.patch[axis]) + half;
                (cell / self.size[axis] as f64 - 0.5) * self.lie.extent_m[axis] * if axis == 0 { 1.0 } else { -1.0 }
            });
            libm::hypot(at[0] - seen.eye.x, at[1] - seen.eye.y)
        };
        out.sort_by(|a, b| near(a).total_cmp(&near(b)));
        out
    }

    fn visit(&self, level: usize, [x, y]: [usize; 2], seen: &Seen, planes: &[DVec4; 5], out: &mut Vec<Patch>) {
        let (sides, ranges) = &self.levels[level];
        if x >= sides[0] || y >= sides[1] {
            return;
        }
        let step = 1usize << level;
        let cells = (PATCH * step) as f64;
        let range = ranges[y * sides[0] + x];
        let east = |cell: f64| ((cell + 0.5) / self.size[0] as f64 - 0.5) * self.lie.extent_m[0];
        let north = |cell: f64| (0.5 - (cell + 0.5) / self.size[1] as f64) * self.lie.extent_m[1];
        let [low, high] = range.map(|h| f64::from(h) * self.lie.exaggeration);
        let least = DVec3::new(east(x as f64 * cells), north((y + 1) as f64 * cells), low);
        let most = DVec3::new(east((x + 1) as f64 * cells), north(y as f64 * cells), high);
        if planes.iter().any(|plane| outside(*plane, least, most)) {
            return;
        }
        let away = (seen.eye.clamp(least, most) - seen.eye).length();
        if level > 0 && away < self.range_m(level - 1, seen) {
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                self.visit(level - 1, [2 * x + dx, 2 * y + dy], seen, planes, out);
            }
            return;
        }
        let end = self.range_m(level, seen);
        let begin = if level == 0 { 0.0 } else { self.range_m(level - 1, seen) };
        // The coarsest level has nothing to change into.
        let last = level + 1 == self.levels.len();
        let [from, to] = if last { [1e29, 1e30] } else { [begin + (end - begin) * STEADY, end] };
        out.push(Patch {
            patch: [(x * PATCH * step) as f32, (y * PATCH * step) as f32, step as f32, level as f32],
            range: [from as f32, to as f32, (PATCH + 1) as f32, 0.0],
        });
    }
}

/// The planes that bound what is seen: left, right, lower, upper, near. Inside is positive.
fn planes(matrix: DMat4) -> [DVec4; 5] {
    let rows = matrix.transpose();
    let [x, y, z, w] = [rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis];
    [w + x, w - x, w + y, w - y, w - z]
}

fn outside(plane: DVec4, least: DVec3, most: DVec3) -> bool {
    let pick = |k: f64, least: f64, most: f64| if k > 0.0 { most } else { least };
    let best =
        DVec3::new(pick(plane.x, least.x, most.x), pick(plane.y, least.y, most.y), pick(plane.z, least.z, most.z));
    plane.truncate().dot(best) + plane.w < 0.0
}

/// Triangles of a patch's lattice.
pub fn indices() -> Vec<u16> {
    let side = (PATCH + 1) as u16;
    let mut out = Vec::with_capacity(PATCH * PATCH * 6);
    for y in 0..PATCH as u16 {
        for x in 0..PATCH as u16 {
            let [a, b, c, d] = [y * side + x, y * side + x + 1, (y + 1) * side + x, (y + 1) * side + x + 1];
            // Diagonals alternate: no direction is favoured.
            out.extend(if (x + y) % 2 == 0 { [a, c, b, b, c, d] } else { [a, c, d, a, d, b] });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::{Edges, Grid},
        render::camera::Camera,
    };

    fn tree(width: usize, height: usize) -> Quadtree {
        let grid = Grid::new(width, height, width as f64 * 10.0, Edges::Open);
        let field = Field::from_fn(grid, |x, y| ((x * 7 + y * 3) % 50) as f32);
        let lie = Lie {
            extent_m: grid.extent_m(),
            cell_m: 10.0,
            sea_m: 0.0,
            range_m: [0.0, 50.0],
            exaggeration: 1.0,
            rim_at_sea: false,
        };
        Quadtree::new(&field, lie)
    }

    fn seen(camera: &Camera) -> Seen {
        Seen {
            matrix: camera.view_projection(1.5),
            eye: camera.eye(),
            pixels: camera.pixels_per_radian(600.0),
            most_px: 4.0,
        }
    }

    /// Every cell in view is covered once, and neighbours differ by one level at most.
    #[test]
    fn patches_cover_the_map_once() {
        for (width, height) in [(1024, 1024), (700, 300), (33, 65), (17, 16)] {
            let tree = tree(width, height);
            let middle = DVec3::ZERO;
            for (distance_m, down_deg) in [(60.0, 20.0), (900.0, 35.0), (30_000.0, 80.0)] {
                let camera = Camera { target: middle, from_deg: 200.0, down_deg, distance_m, view_deg: 100.0 };
                // Everything is in view: only distance decides.
                let all = Seen { matrix: DMat4::ZERO, ..seen(&camera) };
                let patches = tree.select(&all);
                let (w, h) = (width.div_ceil(PATCH), height.div_ceil(PATCH));
                let mut level = vec![None; w * h];
                for patch in &patches {
                    let [x, y, step, own] = patch.patch.map(|v| v as usize);
                    for dy in 0..step {
                        for dx in 0..step {
                            let (x, y) = (x / PATCH + dx, y / PATCH + dy);
                            if x < w && y < h {
                                assert!(level[y * w + x].replace(own).is_none(), "{width} {distance_m}: twice");
                            }
                        }
                    }
                }
                for y in 0..(height - 1).div_ceil(PATCH) {
                    for x in 0..(width - 1).div_ceil(PATCH) {
                        let here = level[y * w + x].expect("covered");
                        let right = (x + 1 < (width - 1).div_ceil(PATCH)).then(|| level[y * w + x + 1].unwrap());
                        assert!(right.is_none_or(|right| here.abs_diff(right) <= 1), "{width} {distance_m}");
                    }
                }
            }
        }
    }

    /// An edge between two levels has wholly changed on its fine side.
    #[test]
    fn edges_meet() {
        let tree = tree(1024, 1024);
        let camera = Camera {
            target: DVec3::new(500.0, -300.0, 20.0),
            from_deg: 30.0,
            down_deg: 25.0,
            distance_m: 700.0,
            view_deg: 50.0,
        };
        let all = Seen { matrix: DMat4::ZERO, most_px: 40.0, ..seen(&camera) };
        let patches = tree.select(&all);
        assert!(patches.iter().any(|p| p.patch[3] == 0.0) && patches.iter().any(|p| p.patch[3] >= 2.0));
        for coarse in &patches {
            for fine in patches.iter().filter(|fine| fine.patch[3] + 1.0 == coarse.patch[3]) {
                let ends = |p: &Patch| [0, 1].map(|a: usize| [p.patch[a], p.patch[a] + p.patch[2] * PATCH as f32]);
                let ([cx, cy], [fx, fy]) = (ends(coarse), ends(fine));
                let touch = |a: [f32; 2], b: [f32; 2]| a[0] <= b[1] && b[0] <= a[1];
                if !(touch(cx, fx) && touch(cy, fy)) {
                    continue;
                }
                // The nearest point both share is farther than where the fine one has changed.
                let axis = |a: [f32; 2], b: [f32; 2], eye: f64, to_m: &dyn Fn(f64) -> f64| {
                    let (low, high) = (to_m(f64::from(a[0].max(b[0]))), to_m(f64::from(a[1].min(b[1]))));
                    eye.clamp(low.min(high), low.max(high)) - eye
                };
                let dx = axis(cx, fx, all.eye.x, &|c| (c + 0.5 - 512.0) * 10.0);
                let dy = axis(cy, fy, all.eye.y, &|c| -(c + 0.5 - 512.0) * 10.0);
                let dz = all.eye.z.clamp(0.0, 50.0) - all.eye.z;
                let away = (dx * dx + dy * dy + dz * dz).sqrt();
                assert!(away >= f64::from(fine.range[1]) - 1.0, "{away} {fine:?}");
            }
        }
    }

    #[test]
    fn what_is_behind_the_eye_is_left_out() {
        let tree = tree(1024, 1024);
        let camera = Camera { target: DVec3::ZERO, from_deg: 180.0, down_deg: 5.0, distance_m: 100.0, view_deg: 40.0 };
        let (some, all) = (tree.select(&seen(&camera)), tree.select(&Seen { matrix: DMat4::ZERO, ..seen(&camera) }));
        assert!(some.len() * 2 < all.len() && !some.is_empty());
    }
}
