//! Heights and falls between the cells, for all lanes at a time.

use super::{
    ground::Ground,
    lanes::{Lane, Lanes, whole},
};

/// Where heights and falls are asked for.
#[derive(Default)]
pub struct Places {
    /// The first of the four cells around.
    index: Lane<i32>,
    /// How far between the cells, to the east and to the south.
    within: [Lane; 2],
    /// Heights of the four cells, m.
    corners: [Lane; 4],
}

impl Places {
    /// Places in the windows of lanes.
    #[inline(always)]
    pub fn of(at: &[Lane; 2], lanes: &Lanes) -> Self {
        let mut places = Self::default();
        for (l, (&x, &y)) in at[0].iter().zip(&at[1]).enumerate() {
            // A droplet that ends does not look where it goes.
            let (left, column) = whole(x.max(0.0).min(lanes.most[0][l]));
            let (top, row) = whole(y.max(0.0).min(lanes.most[1][l]));
            places.within[0][l] = x - left;
            places.within[1][l] = y - top;
            places.index[l] = row * lanes.stride[l] + column + lanes.frame[l];
        }
        places
    }

    /// Looks up the cells around a lane's place.
    #[inline(always)]
    pub fn look(&mut self, l: usize, ground: &Ground) {
        let i = self.index[l] as usize;
        let ([a, b], [c, d]) = (ground.heights(i), ground.heights(i + ground.stride));
        for (corner, height) in self.corners.iter_mut().zip([a, b, c, d]) {
            corner[l] = height;
        }
    }

    /// Heights of the four cells, m. Written out: a closure handed to `map` is not always drawn into the loop.
    #[inline(always)]
    fn around(&self, l: usize) -> [f32; 4] {
        [self.corners[0][l], self.corners[1][l], self.corners[2][l], self.corners[3][l]]
    }

    /// Height, m.
    #[inline(always)]
    pub fn height(&self, l: usize) -> f32 {
        let [a, b, c, d] = self.around(l);
        let [across, down] = [self.within[0][l], self.within[1][l]];
        let [north, south] = [a + (b - a) * across, c + (d - c) * across];
        north + (south - north) * down
    }

    /// Fall to the east and to the south, m a cell.
    #[inline(always)]
    pub fn fall(&self, l: usize) -> [f32; 2] {
        let [a, b, c, d] = self.around(l);
        let [across, down] = [self.within[0][l], self.within[1][l]];
        [(b - a) + ((d - c) - (b - a)) * down, (c - a) + ((d - b) - (c - a)) * across]
    }
}
