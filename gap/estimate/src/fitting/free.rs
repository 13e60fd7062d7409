//! Free values, with their coordinates, limits and priors.

use nalgebra::{DMatrix, DVector};

use crate::EstimateError;
use crate::data::layout::Layout;
use crate::data::unknown::Unknown;
use crate::gradient::direction::Direction;

/// Coordinate in which a value is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// The value itself, in SI.
    Plain,
    /// Its natural logarithm: levels, noise and lags are positive and known up to factors.
    Logarithm,
}

/// A free value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Free {
    /// The value.
    pub unknown: Unknown,
    /// Its coordinate.
    pub coordinate: Coordinate,
    /// Limits in SI.
    pub range: [f64; 2],
    /// Prior: expected value in SI and standard deviation in the coordinate, of a normal distribution
    /// in the coordinate; for instance a tolerance of the drawing.
    pub prior: Option<[f64; 2]>,
}

impl Free {
    /// A value without further limits and without a prior; positive values in logarithms.
    pub fn of(unknown: Unknown) -> Self {
        let positive = unknown.is_level() || matches!(unknown, Unknown::Lag(_));
        let not_negative = matches!(unknown, Unknown::SensorDelay(_) | Unknown::InputDelay(_));
        let lowest = if positive || not_negative {
            0.0
        } else {
            f64::NEG_INFINITY
        };
        Self {
            unknown,
            coordinate: if positive {
                Coordinate::Logarithm
            } else {
                Coordinate::Plain
            },
            range: [lowest, f64::INFINITY],
            prior: None,
        }
    }

    /// The same within limits in SI.
    #[must_use]
    pub fn within(mut self, low: f64, high: f64) -> Self {
        self.range = [low, high];
        self
    }

    /// The same with a prior, see [`Free::prior`].
    #[must_use]
    pub fn around(mut self, expected: f64, deviation: f64) -> Self {
        self.prior = Some([expected, deviation]);
        self
    }

    /// The coordinate of a value.
    pub fn to_coordinate(&self, value: f64) -> f64 {
        match self.coordinate {
            Coordinate::Plain => value,
            Coordinate::Logarithm => value.ln(),
        }
    }

    /// The value of a coordinate.
    pub fn to_value(&self, coordinate: f64) -> f64 {
        match self.coordinate {
            Coordinate::Plain => coordinate,
            Coordinate::Logarithm => coordinate.exp(),
        }
    }

    /// Derivative of the value with respect to the coordinate.
    pub fn stretch(&self, value: f64) -> f64 {
        match self.coordinate {
            Coordinate::Plain => 1.0,
            Coordinate::Logarithm => value,
        }
    }

    /// A small change of the coordinate, relative to its scale.
    pub(crate) fn small_change(&self, value: f64) -> f64 {
        match (self.coordinate, self.prior) {
            (Coordinate::Logarithm, _) => 1e-4,
            (Coordinate::Plain, Some([_, deviation])) => 1e-3 * deviation,
            (Coordinate::Plain, None) => 1e-4 * value.abs().max(1e-3),
        }
    }
}

/// All free values, with their indices.
#[derive(Debug, Clone)]
pub(crate) struct Selection<'a> {
    pub(crate) free: &'a [Free],
    places: Vec<usize>,
}

impl<'a> Selection<'a> {
    pub(crate) fn new(layout: &Layout, free: &'a [Free]) -> Result<Self, EstimateError> {
        for value in free {
            if let Some([expected, deviation]) = value.prior
                && !(deviation > 0.0 && value.to_coordinate(expected).is_finite())
            {
                return Err(EstimateError::Value {
                    what: format!("prior standard deviation of {:?}", value.unknown),
                    value: deviation,
                    demand: "positive, about a value that its coordinate admits",
                });
            }
        }
        let places = free.iter().map(|free| layout.place(free.unknown));
        Ok(Self {
            free,
            places: places.collect::<Result<_, _>>()?,
        })
    }

    pub(crate) fn len(&self) -> usize {
        self.free.len()
    }

    /// The coordinates of the values, inside the limits.
    pub(crate) fn coordinates(&self, values: &[f64]) -> Result<DVector<f64>, EstimateError> {
        let mut coordinates = DVector::zeros(self.len());
        for (i, (free, &place)) in self.free.iter().zip(&self.places).enumerate() {
            let [low, high] = free.range;
            let value = values[place].max(low).min(high);
            coordinates[i] = free.to_coordinate(value);
            if !coordinates[i].is_finite() {
                return Err(EstimateError::Value {
                    what: format!("start of {:?}", free.unknown),
                    value: values[place],
                    demand: match free.coordinate {
                        Coordinate::Plain => "finite",
                        Coordinate::Logarithm => "positive: it is counted by its logarithm",
                    },
                });
            }
        }
        Ok(coordinates)
    }

    /// Writes coordinates into a list of values.
    pub(crate) fn write(&self, coordinates: &DVector<f64>, values: &mut [f64]) {
        let places = self.free.iter().zip(&self.places);
        for ((free, &place), &coordinate) in places.zip(coordinates.iter()) {
            let [low, high] = free.range;
            values[place] = free.to_value(coordinate).max(low).min(high);
        }
    }

    /// The directions of the values.
    pub(crate) fn directions(&self) -> Vec<Direction> {
        let unknowns = self.free.iter().map(|free| Direction::Value(free.unknown));
        unknowns.collect()
    }

    /// The Fisher information of the coordinates, from that of the values.
    pub(crate) fn stretched(&self, mut information: DMatrix<f64>, values: &[f64]) -> DMatrix<f64> {
        for (i, (free, &place)) in self.free.iter().zip(&self.places).enumerate() {
            let stretch = free.stretch(values[place]);
            information.row_mut(i).scale_mut(stretch);
            information.column_mut(i).scale_mut(stretch);
        }
        information
    }

    /// The gradient with respect to the coordinates, from that with respect to the values.
    pub(crate) fn gradient(&self, values: &[f64], by_values: &[f64]) -> DVector<f64> {
        let places = self.free.iter().zip(&self.places);
        let entries = places.map(|(free, &place)| free.stretch(values[place]) * by_values[place]);
        DVector::from_iterator(self.len(), entries)
    }

    /// Lowest and highest coordinates.
    pub(crate) fn limits(&self) -> Vec<[f64; 2]> {
        let limits = self.free.iter();
        limits
            .map(|free| free.range.map(|limit| free.to_coordinate(limit)))
            .collect()
    }

    /// Log-prior, up to a constant, and its gradient.
    pub(crate) fn prior(&self, coordinates: &DVector<f64>) -> (f64, DVector<f64>) {
        let (mut sum, mut gradient) = (0.0, DVector::zeros(self.len()));
        for (i, free) in self.free.iter().enumerate() {
            if let Some([expected, deviation]) = free.prior {
                let off = (coordinates[i] - free.to_coordinate(expected)) / deviation;
                sum -= 0.5 * off * off;
                gradient[i] = -off / deviation;
            }
        }
        (sum, gradient)
    }

    /// Prior information.
    pub(crate) fn prior_information(&self) -> DVector<f64> {
        let entries = self
            .free
            .iter()
            .map(|free| free.prior.map_or(0.0, |[_, d]| d.powi(-2)));
        DVector::from_iterator(self.len(), entries)
    }

    /// The values with one coordinate changed.
    pub(crate) fn changed(&self, values: &[f64], index: usize, change: f64) -> Vec<f64> {
        let mut changed = values.to_vec();
        let (free, place) = (&self.free[index], self.places[index]);
        changed[place] = free.to_value(free.to_coordinate(values[place]) + change);
        changed
    }

    pub(crate) fn value(&self, values: &[f64], index: usize) -> f64 {
        values[self.places[index]]
    }
}
