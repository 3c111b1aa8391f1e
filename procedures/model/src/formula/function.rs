//! The functions that a formula may call.

use std::f64::consts::TAU;

/// Name in a formula and in C, and the number of arguments.
macro_rules! functions {
    ($($variant:ident $name:literal $c:literal $arity:literal $apply:expr;)*) => {
        /// A function of a formula. Angles are in radians, logarithms of non-positive arguments are not finite.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Function {
            $(#[doc = concat!("`", $name, "`: `", stringify!($apply), "`.")] $variant),*
        }

        impl Function {
            /// Every function.
            pub const ALL: &'static [Function] = &[$(Function::$variant),*];

            /// Name in a formula.
            pub fn name(self) -> &'static str {
                match self { $(Function::$variant => $name),* }
            }

            /// Name in C99's math.h; `sign` and `wrap` (an angle within half a turn of zero) are defined separately.
            pub fn c_name(self) -> &'static str {
                match self { $(Function::$variant => $c),* }
            }

            /// Number of arguments, 1 or 2.
            pub fn arity(self) -> usize {
                match self { $(Function::$variant => $arity),* }
            }

            /// The value; a function of one argument ignores the second.
            pub fn apply(self, x: f64, y: f64) -> f64 {
                let apply: fn(f64, f64) -> f64 = match self { $(Function::$variant => $apply),* };
                apply(x, y)
            }
        }
    };
}

functions! {
    Abs "abs" "fabs" 1 |x, _| x.abs();
    Sign "sign" "" 1 |x, _| if x > 0.0 { 1.0 } else if x < 0.0 { -1.0 } else { 0.0 };
    Sqrt "sqrt" "sqrt" 1 |x, _| x.sqrt();
    Exp "exp" "exp" 1 |x, _| x.exp();
    Ln "ln" "log" 1 |x, _| x.ln();
    Log10 "log10" "log10" 1 |x, _| x.log10();
    Sin "sin" "sin" 1 |x, _| x.sin();
    Cos "cos" "cos" 1 |x, _| x.cos();
    Tan "tan" "tan" 1 |x, _| x.tan();
    Asin "asin" "asin" 1 |x, _| x.asin();
    Acos "acos" "acos" 1 |x, _| x.acos();
    Atan "atan" "atan" 1 |x, _| x.atan();
    Atan2 "atan2" "atan2" 2 f64::atan2;
    Sinh "sinh" "sinh" 1 |x, _| x.sinh();
    Cosh "cosh" "cosh" 1 |x, _| x.cosh();
    Tanh "tanh" "tanh" 1 |x, _| x.tanh();
    Min "min" "fmin" 2 f64::min;
    Max "max" "fmax" 2 f64::max;
    Wrap "wrap" "" 1 |x, _| x - TAU * (x / TAU).round_ties_even();
}

impl Function {
    /// The function with a name. `None` if there is none.
    pub fn find(name: &str) -> Option<Function> {
        Function::ALL.iter().copied().find(|f| f.name() == name)
    }

    /// A periodic function: its mean over an interval differs from its value at the middle.
    pub fn is_periodic(self) -> bool {
        matches!(self, Function::Sin | Function::Cos | Function::Tan | Function::Wrap)
    }
}
