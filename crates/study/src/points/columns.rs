//! What the columns of a file of points mean, and the table they fill.

use snowlab_solver::Vector;

use super::PointCloud;
use super::lines::shown;

/// The names of position, velocity and mass, in the order they are written.
pub const COORDINATES: [&str; 3] = ["x", "y", "z"];
pub const VELOCITIES: [&str; 3] = ["vx", "vy", "vz"];
pub const MASS: &str = "mass";
/// Masses that are taken [kg]. Chosen: their sums and squares neither vanish nor overflow in f64.
const MASS_RANGE: [f64; 2] = [1e-100, 1e100];

/// Where in a row of the file each quantity stands.
#[derive(Clone, Debug)]
pub struct Columns {
    /// Two or three columns.
    coordinates: Vec<usize>,
    /// As many as coordinates.
    velocities: Option<Vec<usize>>,
    mass: Option<usize>,
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
        for (name, place) in COORDINATES.iter().zip(find_each(&COORDINATES)?) {
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
        Ok(Self { coordinates, velocities, mass: find(MASS)? })
    }

    /// Positions alone, by their order.
    pub fn in_order(count: usize) -> Result<Self, String> {
        if count == 2 || count == 3 {
            return Ok(Self { coordinates: (0..count).collect(), velocities: None, mass: None });
        }
        Err(format!(
            "there is no header and each line has {count} number(s), where x y or x y z are expected; \
             name the columns in a first line such as x,y,z"
        ))
    }
}

/// The points of a file, whose dimension is not decided yet.
pub struct Table {
    columns: Columns,
    positions: Vec<[f64; 3]>,
    velocities: Vec<[f64; 3]>,
    masses: Vec<f64>,
    /// Line and number of the first point with a z or vz other than 0.
    first_off_plane: Option<(u64, usize)>,
}

impl Table {
    pub fn new(columns: Columns) -> Self {
        let (positions, velocities, masses) = (Vec::new(), Vec::new(), Vec::new());
        Self { columns, positions, velocities, masses, first_off_plane: None }
    }

    /// Adds the point of a row, `value` being the number in a column; `line` is where the row stands, 0 without lines.
    pub fn push(
        &mut self,
        line: u64,
        mut value: impl FnMut(usize) -> Result<f64, String>,
    ) -> Result<(), String> {
        let mut vector = |columns: &[usize], names: [&str; 3]| -> Result<[f64; 3], String> {
            let mut vector = [0.0; 3];
            for (axis, &column) in columns.iter().enumerate() {
                vector[axis] = value(column).map_err(|message| format!("`{}`: {message}", names[axis]))?;
                if !vector[axis].is_finite() {
                    return Err(not_finite(names[axis], vector[axis]));
                }
            }
            Ok(vector)
        };
        let position = vector(&self.columns.coordinates, COORDINATES)?;
        let mut height = [position[2], 0.0];
        if let Some(columns) = &self.columns.velocities {
            let velocity = vector(columns, VELOCITIES)?;
            height[1] = velocity[2];
            self.velocities.push(velocity);
        }
        if let Some(column) = self.columns.mass {
            let mass = value(column).map_err(|message| format!("`{MASS}`: {message}"))?;
            check_mass(mass)?;
            self.masses.push(mass);
        }
        if self.first_off_plane.is_none() && height != [0.0, 0.0] {
            self.first_off_plane = Some((line, self.positions.len()));
        }
        self.positions.push(position);
        Ok(())
    }

    /// 3 where some z or vz differs from 0, else 2.
    pub fn dimension(&self) -> usize {
        if self.first_off_plane.is_some() { 3 } else { 2 }
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
        let vectors =
            |rows: &[[f64; 3]]| rows.iter().map(|row| Vector::from_fn(|axis, _| row[axis])).collect();
        Ok(PointCloud {
            positions: vectors(&self.positions),
            velocities: self.columns.velocities.as_ref().map(|_| vectors(&self.velocities)),
            masses: self.columns.mass.map(|_| self.masses),
        })
    }
}

/// Refuses what could not be read back: numbers that are not finite, masses out of range, columns of other lengths.
pub fn check<const D: usize>(
    positions: &[Vector<f64, D>],
    velocities: Option<&[Vector<f64, D>]>,
    masses: Option<&[f64]>,
) -> Result<(), String> {
    let points = positions.len();
    let lengths = [("velocities", velocities.map(<[_]>::len)), ("masses", masses.map(<[_]>::len))];
    for (quantity, length) in lengths {
        if let Some(length) = length.filter(|&length| length != points) {
            return Err(format!("{points} points but {length} {quantity}; give one per point"));
        }
    }
    for (rows, names) in [(Some(positions), COORDINATES), (velocities, VELOCITIES)] {
        for (point, row) in rows.unwrap_or_default().iter().enumerate() {
            if let Some(axis) = (0..D).find(|&axis| !row[axis].is_finite()) {
                return Err(format!("point {point} (from 0): {}", not_finite(names[axis], row[axis])));
            }
        }
    }
    for (point, &mass) in masses.unwrap_or_default().iter().enumerate() {
        check_mass(mass).map_err(|message| format!("point {point} (from 0): {message}"))?;
    }
    Ok(())
}

fn not_finite(name: &str, value: f64) -> String {
    format!("`{name}` is {value}; only finite numbers are taken: correct the point or leave it out")
}

fn check_mass(mass: f64) -> Result<(), String> {
    let [least, greatest] = MASS_RANGE;
    if mass >= least && mass <= greatest {
        return Ok(());
    }
    Err(format!(
        "`{MASS}` is {mass:?}; allowed is {least:e} to {greatest:e} kg: correct it, or leave out the column"
    ))
}
