//! Labels next to points, kept off each other, off markers and off lines.

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    pub(super) fn around([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Self {
        Self { left: x - width / 2.0, top: y - height / 2.0, right: x + width / 2.0, bottom: y + height / 2.0 }
    }

    fn size(&self) -> f64 {
        (self.right - self.left) * (self.bottom - self.top)
    }

    /// Square pixels that two areas share.
    fn shared(&self, other: &Self) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }

    /// Point of the area nearest to another point.
    pub(super) fn nearest(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x.clamp(self.left, self.right), y.clamp(self.top, self.bottom)]
    }
}

/// A label to be placed: its point and its width and height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) point: [f64; 2],
    pub(super) size: [f64; 2],
}

/// Pixels from a point to its label, nearest first.
const DISTANCES: [f64; 8] = [6.0, 10.0, 16.0, 24.0, 34.0, 46.0, 60.0, 76.0];

/// A label farther from its point than this needs a line to it.
pub(super) const NEAR: f64 = 11.0;

/// Place of each label: next to its point in `bounds`, with least overlap of other labels, of `markers` and of `lines`. `None`
/// if the overlap is not small. Equal labels have equal places.
pub(super) fn place(wanted: &[Wanted], bounds: &Area, markers: &[Area], lines: &[Area]) -> Vec<Option<Area>> {
    let on = |area: &Area, others: &[Area]| others.iter().map(|other| area.shared(other)).sum::<f64>();
    let mut places: Vec<Option<Area>> = vec![None; wanted.len()];
    let others = |places: &[Option<Area>], index: usize| -> Vec<Area> {
        places.iter().enumerate().filter(|(other, _)| *other != index).filter_map(|(_, place)| *place).collect()
    };
    // A later round moves labels away from those that had no place in an earlier one.
    for _ in 0..6 {
        for (index, label) in wanted.iter().enumerate() {
            let labels = others(&places, index);
            let cost = |(area, dislike): &(Area, f64)| {
                let outside = area.size() - area.shared(bounds);
                dislike + 50.0 * outside + 8.0 * (on(area, &labels) + on(area, markers)) + 2.0 * on(area, lines)
            };
            places[index] = candidates(label).min_by(|a, b| cost(a).total_cmp(&cost(b))).map(|(area, _)| area);
        }
    }
    for index in (0..places.len()).rev() {
        let labels = others(&places, index);
        places[index] = places[index].filter(|area| {
            let outside = area.size() - area.shared(bounds);
            on(area, &labels) + on(area, markers) + outside < 0.06 * area.size()
        });
    }
    places
}

/// Places around a point with their costs: near before far, right before left, above before below.
fn candidates(label: &Wanted) -> impl Iterator<Item = (Area, f64)> {
    let ([x, y], [width, height]) = (label.point, label.size);
    DISTANCES.into_iter().flat_map(move |distance| {
        (0..16).map(move |turn| {
            let (sine, cosine) = (f64::from(turn) * std::f64::consts::PI / 8.0).sin_cos();
            let longest = sine.abs().max(cosine.abs());
            let [across, down] = [cosine / longest, -sine / longest];
            let centre = [x + across * (width / 2.0 + distance), y + down * (height / 2.0 + distance * 0.7)];
            (Area::around(centre, label.size), 3.0 * distance + 4.0 * (1.0 - cosine) + 2.0 * (1.0 - sine))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_near_points_stay_apart_and_inside() {
        let bounds = Area { left: 0.0, top: 0.0, right: 300.0, bottom: 200.0 };
        let wanted: Vec<Wanted> = (0..8)
            .map(|i| Wanted { point: [290.0 - 4.0 * f64::from(i), 8.0 + 5.0 * f64::from(i)], size: [60.0, 15.0] })
            .collect();
        let places: Vec<Area> = place(&wanted, &bounds, &[], &[]).into_iter().flatten().collect();
        assert_eq!(places.len(), wanted.len());
        for (index, area) in places.iter().enumerate() {
            assert!((area.shared(&bounds) - area.size()).abs() < 1e-6);
            assert!(places[..index].iter().all(|other| area.shared(other) < 30.0));
        }
    }
    #[test]
    fn what_has_no_room_is_left_out() {
        let bounds = Area { left: 0.0, top: 0.0, right: 70.0, bottom: 20.0 };
        let wanted = [Wanted { point: [4.0, 10.0], size: [60.0, 15.0] }; 3];
        let places = place(&wanted, &bounds, &[], &[]);
        assert_eq!(places.iter().flatten().count(), 1);
        let wide = [Wanted { point: [4.0, 10.0], size: [90.0, 15.0] }];
        assert_eq!(place(&wide, &bounds, &[], &[]), [None]);
    }
}
