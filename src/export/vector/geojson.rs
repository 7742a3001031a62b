//! GeoJSON (RFC 7946): one FeatureCollection.

use serde_json::{Map as Json, Value, json};

use super::{Map, Spot, shapes, shapes::Polygon};

/// Metres of a degree on the equator of WGS 84.
const METRES_PER_DEGREE: f64 = 111_319.490_793;
/// A map may reach so far to the north and south, deg.
const MOST_DEG: f64 = 85.0;

/// The local frame of degrees.
struct Degrees {
    middle_m: [f64; 2],
    per_degree_m: f64,
    /// Digits that keep a ten thousandth of a cell.
    round: f64,
}

impl Degrees {
    fn of(map: &Map) -> Self {
        let reach_m = (0.5 * map.extent_m[1]).max(0.25 * map.extent_m[0]);
        let per_degree_m = METRES_PER_DEGREE.max(reach_m / MOST_DEG);
        let digits = libm::ceil(-libm::log10(1e-4 * map.cell_m / per_degree_m)).clamp(5.0, 12.0);
        let middle_m = [0, 1].map(|c| map.corner_m[c] + 0.5 * map.extent_m[c]);
        Self { middle_m, per_degree_m, round: libm::pow(10.0, digits) }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let degrees = [(x - self.middle_m[0]) / self.per_degree_m, (self.middle_m[1] - y) / self.per_degree_m];
        // Minus zero would be written with its sign.
        degrees.map(|v| libm::round(v * self.round) / self.round + 0.0)
    }

    fn line(&self, line: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut points: Vec<[f64; 2]> = line.iter().map(|&p| self.at(p)).collect();
        points.dedup();
        points
    }

    /// Closed, and turning as the standard wants: outer rings counterclockwise as seen on the map, which here they are not.
    fn ring(&self, ring: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
        let mut points = self.line(ring);
        if points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        points.reverse();
        points.extend(points.first().copied());
        (points.len() > 3).then_some(points)
    }

    fn polygon(&self, polygon: &Polygon) -> Option<Value> {
        let outer = self.ring(&polygon.outer)?;
        let holes = polygon.holes.iter().filter_map(|hole| self.ring(hole));
        Some(json!(std::iter::once(outer).chain(holes).collect::<Vec<_>>()))
    }

    fn polygons(&self, polygons: &[Polygon]) -> Value {
        let all: Vec<Value> = polygons.iter().filter_map(|polygon| self.polygon(polygon)).collect();
        json!({ "type": "MultiPolygon", "coordinates": all })
    }

    fn line_string(&self, line: &[[f64; 2]]) -> Option<Value> {
        let points = self.line(line);
        (points.len() > 1).then(|| json!({ "type": "LineString", "coordinates": points }))
    }

    fn point(&self, at_m: [f64; 2]) -> Value {
        json!({ "type": "Point", "coordinates": self.at(at_m) })
    }
}

fn feature(layer: &str, geometry: Value, properties: Value) -> Value {
    let mut all = Json::from_iter([("layer".to_owned(), json!(layer))]);
    if let Value::Object(own) = properties {
        all.extend(own);
    }
    json!({ "type": "Feature", "properties": all, "geometry": geometry })
}

/// To the third digit behind the point.
fn rounded(v: f64) -> f64 {
    libm::round(v * 1e3) / 1e3
}

/// The file.
pub fn text(map: &Map) -> String {
    let frame = Degrees::of(map);
    let mut features = Vec::new();
    for polygon in &map.land {
        if let Some(coordinates) = frame.polygon(polygon) {
            let km2 =
                (shapes::area(&polygon.outer) + polygon.holes.iter().map(|h| shapes::area(h)).sum::<f64>()) * 1e-6;
            let geometry = json!({ "type": "Polygon", "coordinates": coordinates });
            features.push(feature("land", geometry, json!({ "area_km2": rounded(km2) })));
        }
    }
    for (height_m, line) in &map.contours {
        let geometry = frame.line_string(line);
        features.extend(geometry.map(|g| feature("contour", g, json!({ "height_m": rounded(*height_m) }))));
    }
    for lake in &map.lakes {
        let about = json!({
            "lake": lake.id, "level_m": rounded(lake.level_m), "depth_m": rounded(lake.depth_m),
            "area_km2": rounded(lake.area_km2),
        });
        features.push(feature("lake", frame.polygons(&lake.shape), about));
    }
    for reach in &map.rivers {
        let about = json!({
            "river": reach.river, "reach": reach.part, "discharge_m3_s": rounded(reach.discharge_m3_s),
            "width_m": rounded(reach.width_m), "order": reach.order, "into": reach.into, "into_id": reach.into_id,
            "length_km": rounded(shapes::length(&reach.line) * 1e-3),
        });
        features.extend(frame.line_string(&reach.line).map(|geometry| feature("river", geometry, about)));
    }
    for (plate, polygon) in &map.plates {
        if let Some(coordinates) = frame.polygon(polygon) {
            let geometry = json!({ "type": "Polygon", "coordinates": coordinates });
            features.push(feature("plate", geometry, json!({ "plate": plate })));
        }
    }
    for (kind, line) in &map.borders {
        features.extend(frame.line_string(line).map(|geometry| feature("border", geometry, json!({ "kind": kind }))));
    }
    for motion in &map.motions {
        let about = json!({
            "plate": motion.plate, "speed_mm_per_yr": rounded(motion.speed_mm_per_yr),
            "heading_deg": rounded(motion.heading_deg),
        });
        features.push(feature("motion", frame.point(motion.at_m), about));
    }
    let mut spots = |layer: &str, spots: &[Spot]| {
        let point = |spot: &Spot| feature(layer, frame.point(spot.at_m), json!({ "height_m": rounded(spot.height_m) }));
        features.extend(spots.iter().map(point));
    };
    spots("peak", &map.peaks);
    spots("volcano", &map.volcanoes);
    collection(map, &frame, &features)
}

/// One feature a line, so that the file can be read and compared.
fn collection(map: &Map, frame: &Degrees, features: &[Value]) -> String {
    let [x_km, y_km] = map.corner_m.map(|m| m * 1e-3);
    let about = json!({
        "frame": "a made-up land has no longitude: the middle of the map lies at 0, 0, and a degree is as long to the \
                  north as to the east",
        "metres_per_degree": frame.per_degree_m,
        "north_west_km": [x_km, y_km],
        "extent_km": map.extent_m.map(|m| m * 1e-3),
        "contours_m": map.interval_m,
    });
    let lines: Vec<String> = features.iter().map(Value::to_string).collect();
    format!(
        "{{\"type\":\"FeatureCollection\",\"name\":{},\"upthrust\":{about},\"features\":[\n{}\n]}}\n",
        json!(map.title),
        lines.join(",\n")
    )
}
