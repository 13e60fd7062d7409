//! Equations written out in a loop over lanes.

/// Makes a type `Name` of [`Equations`](crate::lanes::Equations) from an emitted function, for the
/// implementation of [`Model`](crate::model::Model):
///
/// ```text
/// in_lanes! {
///     Name = function [at time] (
///         Parameters[count] { fields }, State[count] { fields }, Inputs[count] { fields }
///     ) => [count](result [fields]) [count](result [rows] [columns]) [0]()
/// }
/// ```
///
/// `whole` stands for the result of a function that has but one. Everything is written out in one loop: one
/// that calls functions with references, or loops over results, does not become vector code.
#[macro_export]
macro_rules! in_lanes {
    (
        $name:ident = $function:ident $(at $time:ident)? (
            $parameters:ident[$p:literal] { $($parameter:ident),* },
            $states:ident[$x:literal] { $($state:ident),* },
            $inputs:ident[$u:literal] { $($input:ident),* }
        ) => [$first:literal]($($of_first:tt)*) [$second:literal]($($of_second:tt)*) [$third:literal]($($of_third:tt)*)
    ) => {
        struct $name;

        impl $crate::lanes::Equations<$x, $u, $p, $first, $second, $third> for $name {
            #[inline(always)]
            fn evaluate<T: $crate::lanes::Lane, const N: usize>(
                t: &[f64; N],
                x: &[[f64; N]; $x],
                u: &[[f64; N]; $u],
                p: &[[f64; N]; $p],
                first: &mut [[f64; N]; $first],
                second: &mut [[f64; N]; $second],
                third: &mut [[f64; N]; $third],
            ) -> bool {
                let mut unknown = false;
                for lane in 0..N {
                    let all = self::$function(
                        $({ let $time = T::of(t[lane]); $time },)?
                        &$crate::in_lanes!(@load $parameters { $($parameter),* }, p, lane),
                        &$crate::in_lanes!(@load $states { $($state),* }, x, lane),
                        &$crate::in_lanes!(@load $inputs { $($input),* }, u, lane),
                    );
                    $crate::in_lanes!(@store all, ($($of_first)*), first, lane, unknown);
                    $crate::in_lanes!(@store all, ($($of_second)*), second, lane, unknown);
                    $crate::in_lanes!(@store all, ($($of_third)*), third, lane, unknown);
                }
                unknown
            }
        }
    };
    (@load $name:ident { $($field:ident),* }, $from:ident, $lane:ident) => {{
        let mut next = 0;
        $(let $field = T::of($from[next][$lane]); next += 1;)*
        let _ = next;
        $name { $($field),* }
    }};
    (@store $all:ident, (), $to:ident, $lane:ident, $unknown:ident) => {
        let _ = &$to;
    };
    (@store $all:ident, (whole [$($field:ident),*]), $to:ident, $lane:ident, $unknown:ident) => {
        let mut next = 0;
        $crate::in_lanes!(@row $all, [$($field),*], next, $to, $lane, $unknown);
        let _ = next;
    };
    (@store $all:ident, ($of:ident [$($field:ident),*]), $to:ident, $lane:ident, $unknown:ident) => {
        let mut next = 0;
        $crate::in_lanes!(@row $all.$of, [$($field),*], next, $to, $lane, $unknown);
        let _ = next;
    };
    (@store $all:ident, ($of:ident [$($row:ident),*] $columns:tt), $to:ident, $lane:ident, $unknown:ident) => {
        let mut next = 0;
        $($crate::in_lanes!(@row $all.$of.$row, $columns, next, $to, $lane, $unknown);)*
        let _ = next;
    };
    (@row $vector:expr, [$($field:ident),*], $next:ident, $to:ident, $lane:ident, $unknown:ident) => {
        let _vector = $vector;
        $(
            let value = $crate::lanes::Lane::value(_vector.$field);
            $unknown |= value.is_nan();
            $to[$next][$lane] = value;
            $next += 1;
        )*
    };
}
