//! A scalar that counts what is done with it, run through the very code of an evaluator (`tests/scattering/cost.rs`).

use bevy_plumage::maths::Real;
use num_traits::{Float, Num, NumCast, One, ToPrimitive, Zero};
use std::{
    cell::Cell,
    cmp::Ordering,
    num::FpCategory,
    ops::{Add, Div, Mul, Neg, Rem, Sub},
};

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// A number in double precision.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted(pub f64);

/// What `work` does: a sum, product, comparison, minimum, maximum or rounding counts one, a quotient, root or transcendental function
/// four, as on a GPU. A sign costs nothing, and neither does a copy.
pub fn operations<R>(work: impl FnOnce() -> R) -> (R, u64) {
    let before = OPERATIONS.get();
    let result = work();
    (result, OPERATIONS.get() - before)
}

fn count(operations: u64, value: f64) -> Counted {
    OPERATIONS.set(OPERATIONS.get() + operations);
    Counted(value)
}

macro_rules! operators {
    ($($name:ident $function:ident $cost:literal),*) => {
        $(impl $name for Counted {
            type Output = Self;
            fn $function(self, other: Self) -> Self {
                count($cost, self.0.$function(other.0))
            }
        })*
    };
}

operators!(Add add 1, Sub sub 1, Mul mul 1, Div div 4, Rem rem 4);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl PartialEq for Counted {
    fn eq(&self, other: &Self) -> bool {
        count(1, self.0).0 == other.0
    }
}

impl PartialOrd for Counted {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        count(1, self.0).0.partial_cmp(&other.0)
    }
}

impl Zero for Counted {
    fn zero() -> Self {
        Self(0.0)
    }
    fn is_zero(&self) -> bool {
        count(1, self.0).0 == 0.0
    }
}

impl One for Counted {
    fn one() -> Self {
        Self(1.0)
    }
}

impl ToPrimitive for Counted {
    fn to_i64(&self) -> Option<i64> {
        self.0.to_i64()
    }
    fn to_u64(&self) -> Option<u64> {
        self.0.to_u64()
    }
    fn to_f64(&self) -> Option<f64> {
        Some(self.0)
    }
}

impl NumCast for Counted {
    fn from<T: ToPrimitive>(value: T) -> Option<Self> {
        value.to_f64().map(Self)
    }
}

impl Num for Counted {
    type FromStrRadixErr = <f64 as Num>::FromStrRadixErr;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self)
    }
}

macro_rules! float {
    (constants: $($constant:ident)*; asked: $($asked:ident)*; of_one: $($cost:literal: $($one:ident)*;)* of_two: $($cost_of_two:literal: $($two:ident)*;)*) => {
        impl Float for Counted {
            $(fn $constant() -> Self { Self(<f64 as Float>::$constant()) })*
            $(fn $asked(self) -> bool { Float::$asked(self.0) })*
            $($(fn $one(self) -> Self { count($cost, Float::$one(self.0)) })*)*
            $($(fn $two(self, other: Self) -> Self { count($cost_of_two, Float::$two(self.0, other.0)) })*)*
            fn abs_sub(self, other: Self) -> Self { (self - other).max(Self(0.0)) }
            fn classify(self) -> FpCategory { self.0.classify() }
            fn mul_add(self, a: Self, b: Self) -> Self { self * a + b }
            fn powi(self, n: i32) -> Self { count(4, self.0.powi(n)) }
            fn sin_cos(self) -> (Self, Self) { (self.sin(), self.cos()) }
            fn integer_decode(self) -> (u64, i16, i8) { self.0.integer_decode() }
        }
    };
}

float! {
    constants: nan infinity neg_infinity neg_zero min_value min_positive_value max_value;
    asked: is_nan is_infinite is_finite is_normal is_sign_positive is_sign_negative;
    of_one:
        0: abs;
        1: floor ceil round trunc fract signum;
        4: recip sqrt exp exp2 ln log2 log10 cbrt sin cos tan asin acos atan exp_m1 ln_1p sinh cosh tanh asinh acosh atanh;
    of_two:
        1: max min;
        4: powf log hypot atan2;
}

impl Real for Counted {
    fn of(x: f64) -> Self {
        Self(x)
    }
}
