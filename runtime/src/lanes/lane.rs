//! From lanes to scalars and back.

use crate::Real;

/// A scalar that is one number of a lane.
pub trait Lane: Real {
    /// The scalar of a number.
    #[must_use]
    fn of(value: f64) -> Self;
    /// Its number.
    fn value(self) -> f64;
}

/// `load!(Name { fields }, array, lane)`: the vector of the numbers of a lane.
///
/// This and [`store!`](crate::store) are no functions: a loop with functions in it that take references
/// does not become vector code.
#[macro_export]
macro_rules! load {
    ($name:ident { $($field:ident),* }, $array:ident, $lane:ident) => {{
        let mut next = 0;
        $(let $field = $crate::lanes::Lane::of($array[next][$lane]); next += 1;)*
        let _ = next;
        $name { $($field),* }
    }};
}

/// `store!(vector, [fields], array, lane, unknown)` writes the entries of a vector to a lane;
/// `store!(matrix, [rows] [columns], …)` those of a vector of vectors. `unknown` becomes true if one is NaN.
#[macro_export]
macro_rules! store {
    ($vector:expr, [$($field:ident),*], $array:ident, $lane:ident, $unknown:ident) => {
        let vector = $vector;
        let mut next = 0;
        $({
            let value = $crate::lanes::Lane::value(vector.$field);
            $unknown |= value.is_nan();
            $array[next][$lane] = value;
            next += 1;
        })*
        let _ = next;
    };
    ($matrix:expr, [$($row:ident),*] $columns:tt, $array:ident, $lane:ident, $unknown:ident) => {
        let matrix = $matrix;
        let mut next = 0;
        $($crate::store!(@row matrix.$row, $columns, next, $array, $lane, $unknown);)*
        let _ = next;
    };
    (@row $vector:expr, [$($field:ident),*], $next:ident, $array:ident, $lane:ident, $unknown:ident) => {
        let vector = $vector;
        $({
            let value = $crate::lanes::Lane::value(vector.$field);
            $unknown |= value.is_nan();
            $array[$next][$lane] = value;
            $next += 1;
        })*
    };
}
