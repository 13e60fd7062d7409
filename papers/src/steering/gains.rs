//! Tables II and III of the paper: gains that place all poles at −8 1/s.

/// A column of table II or III.
#[derive(Debug)]
pub struct Gains {
    /// The table.
    pub table: &'static str,
    /// Forward velocity in m/s.
    pub speed: f64,
    /// Gains as printed, in the order of [`OUTPUTS`]; the turn of table III leaves the last one out.
    pub printed: &'static [&'static str],
}

impl Gains {
    /// The gains with the misprint corrected.
    pub fn mended(&self) -> impl Iterator<Item = f64> {
        let [misprint, right] = MISPRINT;
        self.printed.iter().map(move |&printed| {
            let digits = if printed == misprint { right } else { printed };
            digits.parse().unwrap_or(f64::NAN)
        })
    }
}

/// The outputs of the gains.
pub const OUTPUTS: [&str; 6] = ["omega_1", "theta", "sigma", "r", "psi", "y_G"];

/// The misprinted gain and its correction: two digits are swapped.
pub const MISPRINT: [&str; 2] = ["536.67", "563.67"];

/// The columns of both tables.
pub const GAINS: [Gains; 4] = [
    Gains {
        table: "table II",
        speed: 1.0,
        printed: &[
            "-2042.70", "-7637.29", "2116.86", "11942.04", "3382.02", "4509.36",
        ],
    },
    Gains {
        table: "table II",
        speed: 5.0,
        printed: &["75.51", "777.28", "99.52", "405.60", "676.4", "180.37"],
    },
    Gains {
        table: "table III",
        speed: 1.0,
        printed: &["-776.65", "-2776.88", "882.53", "4881.84", "536.67"],
    },
    Gains {
        table: "table III",
        speed: 5.0,
        printed: &["106.44", "-128.32", "41.49", "73.69", "112.73"],
    },
];
