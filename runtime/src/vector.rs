//! Vector arithmetic of the structs of emitted models, which have named entries.

/// Implements vector operations for a struct `Name<T>` of numbers, whose fields are listed in order: conversion from
/// and to `[T; len]`, sums, differences, scalar multiples, and entrywise maps.
///
/// `vector!(Name { … }, Rates)` in addition implements adding `Rates<T>`, times a time step, to a `Name<T>`. A vector
/// without entries is a `Name` without a scalar, and has no arithmetic.
///
/// ```
/// #[derive(Debug, Clone, Copy, PartialEq)]
/// struct Point<T> {
///     x: T,
///     y: T,
/// }
/// appell_runtime::vector!(Point { x, y });
///
/// let middle = (Point { x: 1.0, y: 2.0 } + Point::splat(3.0)) * 0.5;
/// assert_eq!(middle.to_array(), [2.0, 2.5]);
/// ```
#[macro_export]
macro_rules! vector {
    ($name:ident {}) => {
        impl<T> From<[T; 0]> for $name {
            #[inline]
            fn from([]: [T; 0]) -> Self {
                Self {}
            }
        }

        impl<T> From<$name> for [T; 0] {
            #[inline]
            fn from($name {}: $name) -> Self {
                []
            }
        }
    };
    ($name:ident {}, $rates:ident) => {
        $crate::vector!($name {});
    };
    ($name:ident { $($field:ident),+ $(,)? }, $rates:ident) => {
        $crate::vector!($name { $($field),+ });

        impl<T: Copy + core::ops::Add<Output = T>> core::ops::Add<$rates<T>> for $name<T> {
            type Output = Self;
            #[inline]
            fn add(self, step: $rates<T>) -> Self {
                self + Self::from(step.to_array())
            }
        }

        impl<T: Copy + core::ops::Add<Output = T>> core::ops::AddAssign<$rates<T>> for $name<T> {
            #[inline]
            fn add_assign(&mut self, step: $rates<T>) {
                *self = *self + step;
            }
        }
    };
    ($name:ident { $($field:ident),+ $(,)? }) => {
        impl<T> From<[T; { [$(stringify!($field)),+].len() }]> for $name<T> {
            #[inline]
            fn from([$($field),+]: [T; { [$(stringify!($field)),+].len() }]) -> Self {
                Self { $($field),+ }
            }
        }

        impl<T> From<$name<T>> for [T; { [$(stringify!($field)),+].len() }] {
            #[inline]
            fn from($name { $($field),+ }: $name<T>) -> Self {
                [$($field),+]
            }
        }

        impl<T> $name<T> {
            /// The same value in every entry.
            #[must_use]
            #[inline]
            pub fn splat(value: T) -> Self
            where
                T: Copy,
            {
                Self { $($field: value),+ }
            }

            /// The entries in order.
            #[must_use]
            #[inline]
            pub fn to_array(self) -> [T; { [$(stringify!($field)),+].len() }] {
                self.into()
            }

            /// Applies a function to every entry.
            #[must_use]
            #[inline]
            pub fn map<U>(self, function: impl FnMut(T) -> U) -> $name<U> {
                self.to_array().map(function).into()
            }
        }

        impl<T: Copy + core::ops::Add<Output = T>> core::ops::Add for $name<T> {
            type Output = Self;
            #[inline]
            fn add(self, other: Self) -> Self {
                let (a, b) = (self.to_array(), other.to_array());
                core::array::from_fn(|i| a[i] + b[i]).into()
            }
        }

        impl<T: Copy + core::ops::Sub<Output = T>> core::ops::Sub for $name<T> {
            type Output = Self;
            #[inline]
            fn sub(self, other: Self) -> Self {
                let (a, b) = (self.to_array(), other.to_array());
                core::array::from_fn(|i| a[i] - b[i]).into()
            }
        }

        impl<T: core::ops::Neg<Output = T>> core::ops::Neg for $name<T> {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                self.map(|entry| -entry)
            }
        }

        impl<T: Copy + core::ops::Mul<Output = T>> core::ops::Mul<T> for $name<T> {
            type Output = Self;
            #[inline]
            fn mul(self, factor: T) -> Self {
                self.map(|entry| entry * factor)
            }
        }

        impl<T: Copy + core::ops::Add<Output = T>> core::ops::AddAssign for $name<T> {
            #[inline]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl<T: Copy + core::ops::Sub<Output = T>> core::ops::SubAssign for $name<T> {
            #[inline]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }

        impl<T: Copy + core::ops::Mul<Output = T>> core::ops::MulAssign<T> for $name<T> {
            #[inline]
            fn mul_assign(&mut self, factor: T) {
                *self = *self * factor;
            }
        }
    };
}
