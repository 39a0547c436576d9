//! What the columns of a file of points mean, and the table they fill.

use snowlab_solver::{Matrix, Vector};

use super::PointCloud;
use super::lines::shown;

const AXES: [&str; 3] = ["x", "y", "z"];
/// The names of velocities, in the order they are written.
const VELOCITIES: [&str; 3] = ["vx", "vy", "vz"];
/// The names of what a point has one positive number of: mass [kg], rest volume [m^D], plastic volume ratio J_P.
const SCALARS: [&str; 3] = ["mass", "volume", "jp"];
/// Scalars that are taken. Chosen: their sums and squares neither vanish nor overflow in f64.
const SCALAR_RANGE: [f64; 2] = [1e-100, 1e100];

/// The names of the entries of the elastic deformation gradient F_E, by rows.
fn deformation_names(dimension: usize) -> Vec<String> {
    let axes = &AXES[..dimension];
    axes.iter().flat_map(|i| axes.iter().map(move |j| format!("f{i}{j}"))).collect()
}

/// Where in a row of the file each quantity stands.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// Two or three columns.
    coordinates: Vec<usize>,
    /// As many as coordinates.
    velocities: Option<Vec<usize>>,
    scalars: [Option<usize>; 3],
    /// Four or nine columns, by rows.
    deformation: Option<Vec<usize>>,
}

impl Columns {
    /// The columns by their names, upper or lower case, in any order.
    pub fn named(names: &[&str]) -> Result<Self, String> {
        let find = |wanted: &str| -> Result<Option<usize>, String> {
            let mut places = names
                .iter()
                .enumerate()
                .filter(|(_, name)| name.eq_ignore_ascii_case(wanted))
                .map(|(i, _)| i);
            match (places.next(), places.next()) {
                (_, Some(_)) => Err(format!("`{wanted}` is there twice; name each column once")),
                (place, None) => Ok(place),
            }
        };
        let find_each = |wanted: &[&str]| -> Result<Vec<Option<usize>>, String> {
            wanted.iter().map(|name| find(name)).collect()
        };
        let mut coordinates = Vec::new();
        for (name, place) in AXES.iter().zip(find_each(&AXES)?) {
            match place {
                Some(place) => coordinates.push(place),
                None if *name == "z" => {}
                None => {
                    let found = shown(&names.join(" "));
                    return Err(format!("`{name}` is missing; found {found}, needed are x, y and, in 3D, z"));
                }
            }
        }
        let velocities = find_each(&VELOCITIES[..coordinates.len()])?.into_iter().collect();
        let mut scalars = [None; 3];
        for (place, name) in scalars.iter_mut().zip(SCALARS) {
            *place = find(name)?;
        }
        let deformation = find_deformation(find)?;
        Ok(Self { coordinates, velocities, scalars, deformation })
    }

    /// Positions alone, by their order.
    pub fn in_order(count: usize) -> Result<Self, String> {
        if count == 2 || count == 3 {
            return Ok(Self { coordinates: (0..count).collect(), ..Self::default() });
        }
        Err(format!(
            "there is no header and each line has {count} number(s), where x y or x y z are expected; \
             name the columns in a first line such as x,y,z"
        ))
    }
}

/// All columns of a deformation gradient in 2D or in 3D, or none: half of one is a mistake.
fn find_deformation(
    find: impl Fn(&str) -> Result<Option<usize>, String>,
) -> Result<Option<Vec<usize>>, String> {
    let names = deformation_names(3);
    let places: Vec<Option<usize>> = names.iter().map(|name| find(name)).collect::<Result<_, _>>()?;
    if places.iter().all(Option::is_none) {
        return Ok(None);
    }
    let plane = names.iter().zip(&places).all(|(name, place)| place.is_none() || !name.contains('z'));
    let wanted = deformation_names(if plane { 2 } else { 3 });
    let place_of = |name: &String| places[names.iter().position(|n| n == name)?];
    match wanted.iter().find(|name| place_of(name).is_none()) {
        Some(missing) => {
            Err(format!("`{missing}` is missing; a deformation gradient has {}", wanted.join(", ")))
        }
        None => Ok(wanted.iter().map(place_of).collect()),
    }
}

/// The points of a file, whose dimension is not decided yet.
pub struct Table {
    columns: Columns,
    positions: Vec<[f64; 3]>,
    velocities: Vec<[f64; 3]>,
    scalars: [Vec<f64>; 3],
    /// Four or nine numbers a point.
    deformations: Vec<f64>,
    /// Line and number of the first point with a z or vz other than 0.
    first_off_plane: Option<(u64, usize)>,
}

impl Table {
    pub fn new(columns: Columns) -> Self {
        Self {
            columns,
            positions: Vec::new(),
            velocities: Vec::new(),
            scalars: Default::default(),
            deformations: Vec::new(),
            first_off_plane: None,
        }
    }

    /// Adds the point of a row, `value` being the number in a column; `line` is where the row stands, 0 without lines.
    pub fn push(
        &mut self,
        line: u64,
        mut value: impl FnMut(usize) -> Result<f64, String>,
    ) -> Result<(), String> {
        let mut number = |column: usize, name: &str, check: fn(&str, f64) -> Result<(), String>| {
            let number = value(column).map_err(|message| format!("`{name}`: {message}"))?;
            check(name, number).map(|()| number)
        };
        let mut position = [0.0; 3];
        for (axis, &column) in self.columns.coordinates.iter().enumerate() {
            position[axis] = number(column, AXES[axis], check_finite)?;
        }
        let mut height = [position[2], 0.0];
        if let Some(columns) = &self.columns.velocities {
            let mut velocity = [0.0; 3];
            for (axis, &column) in columns.iter().enumerate() {
                velocity[axis] = number(column, VELOCITIES[axis], check_finite)?;
            }
            height[1] = velocity[2];
            self.velocities.push(velocity);
        }
        for ((column, values), name) in self.columns.scalars.iter().zip(&mut self.scalars).zip(SCALARS) {
            if let Some(column) = *column {
                values.push(number(column, name, check_scalar)?);
            }
        }
        for &column in self.columns.deformation.iter().flatten() {
            self.deformations.push(number(column, "deformation gradient", check_finite)?);
        }
        if self.first_off_plane.is_none() && height != [0.0, 0.0] {
            self.first_off_plane = Some((line, self.positions.len()));
        }
        self.positions.push(position);
        Ok(())
    }

    /// 3 where some z or vz differs from 0, or a deformation gradient has nine entries; else 2.
    pub fn dimension(&self) -> usize {
        if self.first_off_plane.is_some() || self.deformation_dimension() == Some(3) { 3 } else { 2 }
    }

    fn deformation_dimension(&self) -> Option<usize> {
        self.columns.deformation.as_ref().map(|columns| if columns.len() == 9 { 3 } else { 2 })
    }

    /// The points in `D` dimensions, or the line and the message of what stands against it.
    pub fn into_cloud<const D: usize>(self) -> Result<PointCloud<D>, (u64, String)> {
        if D == 3 && self.columns.coordinates.len() == 2 {
            return Err((
                0,
                "`z` is missing, so the points are 2D; add a column z to read them in 3D".into(),
            ));
        }
        if let (2, Some((line, point))) = (D, self.first_off_plane) {
            let message = format!(
                "point {point} (from 0) has a z or vz other than 0, so the points are 3D; \
                 for 2D set them all to 0"
            );
            return Err((line, message));
        }
        if let Some(other) = self.deformation_dimension().filter(|&dimension| dimension != D) {
            let message = format!(
                "the deformation gradient has {} columns, so it is {other}D; in {D}D they are {}",
                other * other,
                deformation_names(D).join(", ")
            );
            return Err((0, message));
        }
        let vectors =
            |rows: &[[f64; 3]]| rows.iter().map(|row| Vector::from_fn(|axis, _| row[axis])).collect();
        let [masses, volumes, plastic_ratios] = self.scalars;
        let [mass, volume, plastic_ratio] = self.columns.scalars;
        Ok(PointCloud {
            positions: vectors(&self.positions),
            velocities: self.columns.velocities.as_ref().map(|_| vectors(&self.velocities)),
            masses: mass.map(|_| masses),
            volumes: volume.map(|_| volumes),
            plastic_ratios: plastic_ratio.map(|_| plastic_ratios),
            deformations: self
                .columns
                .deformation
                .map(|_| self.deformations.chunks_exact(D * D).map(Matrix::from_row_slice).collect()),
        })
    }
}

impl<const D: usize> PointCloud<D> {
    fn scalars(&self) -> [(&'static str, Option<&[f64]>); 3] {
        let [mass, volume, plastic_ratio] = SCALARS;
        [
            (mass, self.masses.as_deref()),
            (volume, self.volumes.as_deref()),
            (plastic_ratio, self.plastic_ratios.as_deref()),
        ]
    }

    /// The names of the columns it is written in, positions and velocities having `axes` of them.
    pub(super) fn names(&self, axes: usize) -> Vec<String> {
        let velocities = self.velocities.iter().flat_map(|_| &VELOCITIES[..axes]);
        let scalars = self.scalars().into_iter().filter_map(|(name, values)| values.map(|_| name));
        let names = AXES[..axes].iter().chain(velocities).copied().chain(scalars).map(String::from);
        names.chain(self.deformations.iter().flat_map(|_| deformation_names(D))).collect()
    }

    /// The numbers of a point in these columns, 0 on an axis that the cloud does not have.
    pub(super) fn numbers(&self, point: usize, axes: usize) -> Vec<f64> {
        let vectors = [Some(&self.positions), self.velocities.as_ref()].into_iter().flatten();
        let vectors =
            vectors.flat_map(|rows| (0..axes).map(move |axis| rows[point].get(axis).copied().unwrap_or(0.0)));
        let scalars = self.scalars().into_iter().filter_map(|(_, values)| values.map(|v| v[point]));
        let deformation = self
            .deformations
            .iter()
            .flat_map(|rows| rows[point].transpose().iter().copied().collect::<Vec<_>>());
        vectors.chain(scalars).chain(deformation).collect()
    }

    /// Refuses what could not be read back: numbers that are not finite, scalars out of range, columns of other lengths.
    pub(super) fn check(&self) -> Result<(), String> {
        let points = self.positions.len();
        let lengths = [
            ("velocities", self.velocities.as_ref().map(Vec::len)),
            ("masses", self.masses.as_ref().map(Vec::len)),
            ("volumes", self.volumes.as_ref().map(Vec::len)),
            ("plastic ratios", self.plastic_ratios.as_ref().map(Vec::len)),
            ("deformations", self.deformations.as_ref().map(Vec::len)),
        ];
        for (quantity, length) in lengths {
            if let Some(length) = length.filter(|&length| length != points) {
                return Err(format!("{points} points but {length} {quantity}; give one per point"));
            }
        }
        let names = self.names(D);
        for point in 0..points {
            let at = |message| format!("point {point} (from 0): {message}");
            let numbers = self.numbers(point, D);
            for (name, number) in
                names.iter().zip(numbers).filter(|(name, _)| !SCALARS.contains(&name.as_str()))
            {
                check_finite(name, number).map_err(at)?;
            }
            for (name, values) in self.scalars() {
                values.map_or(Ok(()), |values| check_scalar(name, values[point])).map_err(at)?;
            }
        }
        Ok(())
    }
}

fn check_finite(name: &str, value: f64) -> Result<(), String> {
    if value.is_finite() {
        return Ok(());
    }
    Err(format!("`{name}` is {value}; only finite numbers are taken: correct the point or leave it out"))
}

fn check_scalar(name: &str, value: f64) -> Result<(), String> {
    let [least, greatest] = SCALAR_RANGE;
    if value >= least && value <= greatest {
        return Ok(());
    }
    let unit = if name == SCALARS[0] { " kg" } else { "" };
    Err(format!(
        "`{name}` is {value:?}; allowed is {least:e} to {greatest:e}{unit}: correct it, or leave out the column"
    ))
}
