//! A transform that bends: the thin-plate spline.
//!
//! | symbol | meaning |
//! |---|---|
//! | U(r) = r² ln r² | the kernel, what a thin plate does about one point held out of its plane |
//! | K | U between every two control points on the sheet |
//! | P | one row (1, x, y) per control point |
//! | w, a | weights of the kernels and of the affine part, one pair of numbers each |
//! | λ | smoothing |
//!
//! F. L. Bookstein, *IEEE Trans. Pattern Anal. Mach. Intell.* 11 (1989) 567. All of it is solved
//! in centred coordinates of unit size, so that powers of large numbers do not meet.

use glam::{DMat2, DVec2};

use super::{Centred, ControlPoint, Frame, RegistrationError, THIN};

/// Control points the spline needs: three determine an affine transform, which bends nothing.
pub const LEAST_POINTS: usize = 4;

/// Places along each side of the sheet where a fold is looked for.
const FOLD_GRID: usize = 64;

/// A thin-plate spline from the side frame in mm to picture pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    mm: Normal,
    px: Normal,
    nodes: Vec<DVec2>,
    w: Vec<DVec2>,
    a: [DVec2; 3],
    residuals_mm: Vec<Option<f64>>,
}

impl Plate {
    /// Fits the spline to at least [`LEAST_POINTS`] control points.
    ///
    /// `sheet_mm` is the width and height of the side; the spline must not fold within it. A
    /// picture that is a mirror image as a whole is not folded. `smoothing` is λ of G. Wahba,
    /// *Spline Models for Observational Data* (1990), eq. 2.4.23 (there nλ), at least 0, for
    /// coordinates in units of the points' spread: at 0 the spline goes through every point, at 1 it is nearly affine.
    ///
    /// # Errors
    /// [`RegistrationError`] where the points are too few, not finite, doubled or on one line,
    /// where the spline folds, or where `sheet_mm` or `smoothing` is out of range.
    pub fn fit(
        points: &[ControlPoint],
        sheet_mm: DVec2,
        smoothing: f64,
    ) -> Result<Self, RegistrationError> {
        if !(sheet_mm.is_finite() && sheet_mm.min_element() > 0.0) {
            return Err(RegistrationError::NoSheet);
        }
        let plate = Self::anywhere(points, smoothing)?;
        plate.refuse_folds(DVec2::ZERO, sheet_mm)?;
        Ok(plate)
    }

    /// [`fit`](Self::fit) of a spline that may fold.
    pub(in crate::maps) fn anywhere(
        points: &[ControlPoint],
        smoothing: f64,
    ) -> Result<Self, RegistrationError> {
        if !(smoothing.is_finite() && smoothing >= 0.0) {
            return Err(RegistrationError::Smoothing);
        }
        let centred = Centred::new(points, LEAST_POINTS)?;
        let n = points.len();
        let px = Normal::new(centred.px_mean, centred.picture.sum(), n)?;
        let mm = Normal::new(centred.mm_mean, centred.sheet.sum(), n)?;
        let nodes: Vec<DVec2> = points.iter().map(|point| mm.to(point.1)).collect();
        if let Some((first, second)) = doubled(&nodes) {
            return Err(RegistrationError::Doubled {
                first: first + 1,
                second: second + 1,
                of: Frame::Sheet,
            });
        }
        centred.spans_a_plane()?;

        let inverse =
            inverse(system(&nodes, smoothing)).ok_or(RegistrationError::OneLine(Frame::Sheet))?;
        let targets: Vec<DVec2> = points.iter().map(|point| px.to(point.0)).collect();
        let weight =
            |row: &Vec<f64>| -> DVec2 { row.iter().zip(&targets).map(|(&k, &v)| k * v).sum() };
        let w: Vec<DVec2> = inverse[..n].iter().map(weight).collect();
        let a = [0, 1, 2].map(|i| weight(&inverse[n + i]));
        if !w.iter().chain(&a).all(|v| v.is_finite()) {
            return Err(RegistrationError::NotFinite);
        }
        let mut plate = Self {
            mm,
            px,
            nodes,
            w,
            a,
            residuals_mm: Vec::new(),
        };
        plate.residuals_mm = (0..n)
            .map(|i| plate.left_out(points[i].1, plate.w[i], inverse[i][i]))
            .collect();
        Ok(plate)
    }

    /// Where a place on the side, in mm, lies in the picture, in pixels.
    pub fn px_at(&self, mm: DVec2) -> DVec2 {
        let at = self.mm.to(mm);
        let bent: DVec2 = self
            .nodes
            .iter()
            .zip(&self.w)
            .map(|(&node, &w)| w * kernel(at.distance_squared(node)))
            .sum();
        self.px
            .back(self.a[0] + self.a[1] * at.x + self.a[2] * at.y + bent)
    }

    /// Derivative of [`px_at`](Self::px_at), in pixels per mm, one column for each axis of the
    /// side.
    pub fn jacobian_at(&self, mm: DVec2) -> DMat2 {
        let at = self.mm.to(mm);
        let mut jacobian = DMat2::from_cols(self.a[1], self.a[2]);
        for (&node, &w) in self.nodes.iter().zip(&self.w) {
            let slope = kernel_gradient(at - node);
            jacobian += DMat2::from_cols(w * slope.x, w * slope.y);
        }
        jacobian * (self.px.size / self.mm.size)
    }

    /// How far each control point lies from where the others put it, in mm on the side, in the
    /// order given. `None` where the others lie on one line and put it nowhere.
    ///
    /// O. Dubrule, *Math. Geol.* 15 (1983) 687: leaving point i out leaves wᵢ / (L⁻¹)ᵢᵢ, with L
    /// the whole system. The pixels become mm through the slope of the spline at the point.
    pub fn residuals_mm(&self) -> &[Option<f64>] {
        &self.residuals_mm
    }

    /// Root of the mean square of [`residuals_mm`](Self::residuals_mm), in mm, over the points
    /// that have one; `None` where none has.
    pub fn rms_residual_mm(&self) -> Option<f64> {
        let known = || self.residuals_mm.iter().flatten();
        let count = known().count();
        (count > 0).then(|| (known().map(|r| r * r).sum::<f64>() / count as f64).sqrt())
    }

    fn left_out(&self, mm: DVec2, w: DVec2, diagonal: f64) -> Option<f64> {
        // The diagonal is 0 where the rest of the points lie on a line.
        if diagonal.abs() <= THIN {
            return None;
        }
        let px = w / diagonal * self.px.size;
        let residual = (self.jacobian_at(mm).inverse() * px).length();
        residual.is_finite().then_some(residual)
    }

    /// A map folds where its determinant changes sign. Between control points the determinant
    /// varies as slowly as the points are spaced, and at them its slope is steepest. Looked for in
    /// the rectangle of `extent_mm` from `corner_mm`, and at the control points in it.
    pub(in crate::maps) fn refuse_folds(
        &self,
        corner_mm: DVec2,
        extent_mm: DVec2,
    ) -> Result<(), RegistrationError> {
        let step = extent_mm / (FOLD_GRID - 1) as f64;
        let grid = (0..FOLD_GRID * FOLD_GRID)
            .map(|i| corner_mm + DVec2::new((i % FOLD_GRID) as f64, (i / FOLD_GRID) as f64) * step);
        let determinant = |mm: DVec2| self.jacobian_at(mm).determinant();
        let mut found: Vec<(DVec2, f64)> = grid.map(|mm| (mm, determinant(mm))).collect();
        // The mean says which way up the picture is as a whole.
        let mean = found.iter().map(|(_, d)| d).sum::<f64>() / found.len() as f64;
        let is_in = |mm: &DVec2| mm.cmpge(corner_mm).all() && mm.cmple(corner_mm + extent_mm).all();
        let nodes = self.nodes.iter().map(|node| self.mm.back(*node));
        let nodes = nodes.filter(is_in);
        found.extend(nodes.map(|mm| (mm, determinant(mm))));
        if !mean.is_finite() {
            return Err(RegistrationError::NotFinite);
        }
        let worst = found
            .iter()
            .map(|&(mm, d)| (mm, d * mean.signum()))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match worst {
            Some((mm, determinant)) if determinant <= THIN * mean.abs() => {
                Err(RegistrationError::Folded {
                    near_mm: [mm.x.round() as i32, mm.y.round() as i32],
                })
            }
            _ => Ok(()),
        }
    }
}

/// Coordinates about a centre, in units of their spread.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Normal {
    centre: DVec2,
    size: f64,
}

impl Normal {
    fn new(centre: DVec2, moment: f64, count: usize) -> Result<Self, RegistrationError> {
        let size = (moment / count as f64).sqrt();
        // Finite numbers may still be too large to be squared, or too small.
        if !(size.is_normal() && size.recip().is_finite() && centre.is_finite()) {
            return Err(RegistrationError::NotFinite);
        }
        Ok(Self { centre, size })
    }

    fn to(self, v: DVec2) -> DVec2 {
        (v - self.centre) / self.size
    }

    fn back(self, v: DVec2) -> DVec2 {
        v * self.size + self.centre
    }
}

/// U of a squared distance.
fn kernel(r2: f64) -> f64 {
    if r2 > 0.0 { r2 * r2.ln() } else { 0.0 }
}

/// Gradient of U: 2 d (ln r² + 1), which is 0 at the point itself.
fn kernel_gradient(d: DVec2) -> DVec2 {
    let r2 = d.length_squared();
    if r2 > 0.0 {
        d * (2.0 * (r2.ln() + 1.0))
    } else {
        DVec2::ZERO
    }
}

fn doubled(nodes: &[DVec2]) -> Option<(usize, usize)> {
    (1..nodes.len()).find_map(|second| {
        (0..second)
            .find(|&first| nodes[first].distance(nodes[second]) <= THIN)
            .map(|first| (first, second))
    })
}

/// L of Bookstein's eq. 5: K and P, Pᵀ and zeros, with λ on the diagonal of K.
fn system(nodes: &[DVec2], smoothing: f64) -> Vec<Vec<f64>> {
    let n = nodes.len();
    let mut rows = vec![vec![0.0; n + 3]; n + 3];
    for (i, &node) in nodes.iter().enumerate() {
        for (j, &other) in nodes.iter().enumerate() {
            rows[i][j] = kernel(node.distance_squared(other));
        }
        rows[i][i] = smoothing;
        for (k, value) in [1.0, node.x, node.y].into_iter().enumerate() {
            rows[i][n + k] = value;
            rows[n + k][i] = value;
        }
    }
    rows
}

/// Inverse of a square matrix by its LU factors with partial pivoting (G. H. Golub, C. F. Van
/// Loan, *Matrix Computations* (2013), alg. 3.4.1), `None` where a pivot is 0 or not finite.
fn inverse(mut lu: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let n = lu.len();
    let mut order: Vec<usize> = (0..n).collect();
    for column in 0..n {
        let pivot = (column..n).max_by(|&a, &b| {
            let size = |row: usize| lu[row][column].abs();
            size(a).total_cmp(&size(b))
        })?;
        lu.swap(column, pivot);
        order.swap(column, pivot);
        if !lu[column][column].is_normal() {
            return None;
        }
        let (above, below) = lu.split_at_mut(column + 1);
        let pivot = &above[column];
        for row in below {
            row[column] /= pivot[column];
            let factor = row[column];
            for (value, p) in row[column + 1..].iter_mut().zip(&pivot[column + 1..]) {
                *value -= factor * p;
            }
        }
    }
    let mut inverse = vec![vec![0.0; n]; n];
    for column in 0..n {
        let mut x: Vec<f64> = order
            .iter()
            .map(|&row| f64::from(u8::from(row == column)))
            .collect();
        let dot = |row: &[f64], x: &[f64]| row.iter().zip(x).map(|(a, b)| a * b).sum::<f64>();
        for i in 1..n {
            x[i] -= dot(&lu[i][..i], &x[..i]);
        }
        for i in (0..n).rev() {
            x[i] = (x[i] - dot(&lu[i][i + 1..], &x[i + 1..])) / lu[i][i];
        }
        for (row, value) in inverse.iter_mut().zip(x) {
            row[column] = value;
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use glam::dvec2;

    use super::*;

    const SHEET: DVec2 = dvec2(150.0, 220.0);

    /// Twelve pixels a millimetre, bent by a parabola of `bow` pixels.
    fn bent(mm: DVec2, bow: f64) -> DVec2 {
        let across = mm / SHEET * 2.0 - DVec2::ONE;
        mm * 12.0 + dvec2(bow * across.y * across.y, -bow * across.x * across.x)
    }

    fn grid(bow: f64) -> Vec<ControlPoint> {
        (0..30)
            .map(|i| dvec2(f64::from(i % 5) * 35.0 + 5.0, f64::from(i / 5) * 42.0 + 5.0))
            .map(|mm| (bent(mm, bow), mm))
            .collect()
    }

    #[test]
    fn goes_through_its_points_and_near_the_truth_between_them() {
        let points = grid(20.0);
        let plate = Plate::fit(&points, SHEET, 0.0).expect("a plate");
        for (px, mm) in &points {
            assert!(plate.px_at(*mm).distance(*px) < 1e-8);
        }
        let between = dvec2(61.0, 100.0);
        let off = plate.px_at(between).distance(bent(between, 20.0));
        assert!(off < 0.5, "{off} px");
        // An affine transform is far off, so this is not trivially passed.
        let affine = super::super::affine(&points).expect("affine").px_from_mm;
        assert!(
            affine
                .transform_point2(between)
                .distance(bent(between, 20.0))
                > 3.0
        );
    }

    #[test]
    fn its_jacobian_is_its_slope() {
        let plate = Plate::fit(&grid(20.0), SHEET, 0.0).expect("a plate");
        for mm in [dvec2(61.0, 100.0), dvec2(5.0, 5.0)] {
            let step = 1e-4;
            let slope = |axis: DVec2| {
                (plate.px_at(mm + axis * step) - plate.px_at(mm - axis * step)) / (2.0 * step)
            };
            let expected = DMat2::from_cols(slope(DVec2::X), slope(DVec2::Y));
            assert!(
                plate.jacobian_at(mm).abs_diff_eq(expected, 1e-4),
                "{expected}"
            );
        }
    }

    #[test]
    fn residuals_are_what_leaving_a_point_out_gives() {
        // The others' spread, the unit of smoothing, is a little different.
        for (smoothing, within) in [(0.0, 1e-8), (0.1, 0.01)] {
            let mut points = grid(20.0);
            points[12].0.x += 12.0;
            let plate = Plate::fit(&points, SHEET, smoothing).expect("a plate");
            for left_out in [0, 7, 12] {
                let (px, mm) = points[left_out];
                let mut others = points.clone();
                others.remove(left_out);
                let others = Plate::fit(&others, SHEET, smoothing).expect("a plate");
                let expected = plate.jacobian_at(mm).inverse() * (px - others.px_at(mm));
                let residual = plate.residuals_mm()[left_out].expect("a residual");
                assert!(
                    (residual - expected.length()).abs() < within,
                    "{residual} {expected}"
                );
            }
            let worst = plate.residuals_mm().iter().flatten().copied();
            let worst = worst.fold(0.0, f64::max);
            assert_eq!(plate.residuals_mm()[12], Some(worst));
            assert!((0.7..1.3).contains(&worst), "{worst} mm");
            let rms = plate.rms_residual_mm().expect("residuals");
            assert!(rms > 0.1 && rms < worst, "{rms} mm");
        }
    }

    #[test]
    fn a_point_whose_others_lie_on_a_line_has_no_residual() {
        let mm = [
            dvec2(10.0, 10.0),
            dvec2(20.0, 10.0),
            dvec2(30.0, 10.0),
            dvec2(20.0, 40.0),
        ];
        let points = mm.map(|mm| (mm * 12.0, mm));
        let plate = Plate::fit(&points, SHEET, 0.0).expect("a plate");
        assert_eq!(plate.residuals_mm()[3], None);
        assert!(plate.residuals_mm()[0].is_some_and(|r| r < 1e-9));
    }

    #[test]
    fn smoothing_tends_to_the_affine_fit() {
        let mut points = grid(0.0);
        points[12].0.x += 12.0;
        let affine = super::super::affine(&points).expect("affine").px_from_mm;
        let off = |smoothing: f64| {
            let plate = Plate::fit(&points, SHEET, smoothing).expect("a plate");
            let mm = points[12].1;
            plate.px_at(mm).distance(affine.transform_point2(mm))
        };
        assert!(off(0.0) > 10.0);
        assert!(off(1e6) < 1e-3);
    }

    #[test]
    fn degenerate_points_say_why() {
        let points = grid(5.0);
        let refused = |points: &[ControlPoint]| Plate::fit(points, SHEET, 0.0).expect_err("bad");
        assert_eq!(
            refused(&points[..3]),
            RegistrationError::TooFew {
                found: 3,
                needed: 4
            }
        );
        assert_eq!(
            refused(&points[..5]),
            RegistrationError::OneLine(Frame::Sheet)
        );
        let mut twice = points.clone();
        twice[9].1 = twice[2].1;
        assert_eq!(
            refused(&twice).to_string(),
            "control points 3 and 10 lie in one place on the sheet; remove one"
        );
        for bad in [f64::NAN, f64::INFINITY] {
            let mut points = points.clone();
            points[4].0.x = bad;
            assert_eq!(refused(&points), RegistrationError::NotFinite, "{bad}");
        }
        let mut vast = points.clone();
        vast[4].0.x = 1e300;
        refused(&vast);
        assert_eq!(
            Plate::fit(&points, dvec2(150.0, f64::NAN), 0.0),
            Err(RegistrationError::NoSheet)
        );
        assert_eq!(
            Plate::fit(&points, SHEET, -1.0),
            Err(RegistrationError::Smoothing)
        );
    }

    #[test]
    fn a_fold_is_refused_with_its_place() {
        let mut points = grid(0.0);
        // Two neighbours exchanged.
        let (left, right) = (points[11].0, points[12].0);
        (points[11].0, points[12].0) = (right, left);
        let folded = Plate::fit(&points, SHEET, 0.0).expect_err("a fold");
        let RegistrationError::Folded { near_mm: [x, y] } = folded else {
            panic!("{folded}");
        };
        assert!(
            (35..=80).contains(&x) && (60..=120).contains(&y),
            "{folded}"
        );
    }

    #[test]
    fn a_mirror_image_is_not_folded() {
        let points: Vec<ControlPoint> = grid(20.0)
            .iter()
            .map(|&(px, mm)| (dvec2(2417.0 - px.x, px.y), mm))
            .collect();
        let plate = Plate::fit(&points, SHEET, 0.0).expect("a plate");
        assert!(plate.jacobian_at(SHEET / 2.0).determinant() < 0.0);
    }
}
