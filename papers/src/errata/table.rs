//! Every erratum, in the order of the papers.

use super::{
    ACCELERATION_ENERGY, Comparison, Erratum, ErratumOrigin, Evidence, Quantity, Source, Subject,
};

/// The sliding mass's acceleration in (36), line 5, corrected.
const SLIDING_ACCELERATION: &str = "1/(5*m*R**2 + 4*m0*r**2)*((5*m*R**2 + 4*m0*(R**2 + r**2))*r*w1**2 + (5*m*R**2*r - 4*m0*R*r**2*tan(th) + 4*m0*r**3 - m*R**3*tan(th))*w3**2 - 8*m0*R*r*w1*s + R*(m*R**2 + 4*m0*(R*r*tan(th) - r**2))*w2*w3 - (m*R**2 + 4*m0*r**2)*g*sin(th) - 4*m0*g*R*r*cos(th) + (5*m/m0*R**2 + 4*R**2 + 4*r**2)*u)";

/// All errata.
pub const ERRATA: &[Erratum] = &[
    Erratum {
        source: Source::Steering,
        equation: "(17)",
        printed: "seven rows",
        right: "eight rows, x_G before y_G",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Context("(7) has eight states"),
    },
    Erratum {
        source: Source::Steering,
        equation: "(21)",
        printed: "14/5 ψ̇ ψ̇ sin ϑ and 12/5 ψ̇²",
        right: "14/5 ψ̇ φ̇ sin ϑ and 12/5 φ̇²",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "equation_21_has_the_pitch_rate_in_two_terms",
            Comparison {
                subject: Subject::Wheel,
                quantity: Quantity::Formula("A12*A21 + A13*A31 + A14*A41"),
                printed: "4*g/(5*R)*cos(th) - (Pd**2 + 14/5*Pd*Pd*sin(th) + 12/5*Pd**2)",
                right: "4*g/(5*R)*cos(th) - (Pd**2 + 14/5*Pd*Fd*sin(th) + 12/5*Fd**2)",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "after (23)",
        printed: "the limit tilt holds for any rolling wheel",
        right: "for homogeneous thin discs only; a thin hoop has 19.20°",
        origin: ErratumOrigin::Misprint,
        evidence: Evidence::Context(
            "with the inertias k₁ m R² and k₂ m R² of a general wheel the limit depends on k₁ and k₂; tested: `a_wheel_with_any_axisymmetric_inertia_follows_the_general_equations`, `turning_of_a_disc_beyond_18_62_and_of_a_hoop_beyond_19_20_degrees_is_always_stable`",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "text on figure 3",
        printed: "panels (c) and (d) show the level sets of ψ̇ and φ̇, respectively",
        right: "(c) has levels of φ̇, (d) of ψ̇",
        origin: ErratumOrigin::Misprint,
        evidence: Evidence::Context(
            "the line φ̇ → ±∞ of (c) lies in the plane of ϑ and ψ̇; motions that differ in ψ̇ alone, as in (d), lie over one place of the plane of ϑ and φ̇",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(29)",
        printed: "seven entries in rows 7 and 8",
        right: "one more zero in each",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Context("(18) and (19) have eight columns"),
    },
    Erratum {
        source: Source::Steering,
        equation: "(35)",
        printed: "ω₁ := ϑ̂",
        right: "ω₁ := ϑ̇",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "equation_35_defines_the_first_pseudo_velocity_as_tilt_rate",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("w1"),
                printed: "th",
                right: "thd",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(36) line 5",
        printed: "prefactor m₀/(5mR² + 4m₀r²)",
        right: "1/(5mR² + 4m₀r²)",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Test(
            "equation_36_line_5_has_no_mass_in_its_prefactor",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("sd"),
                printed: "m0/(5*m*R**2 + 4*m0*r**2)*((5*m*R**2 + 4*m0*(R**2 + r**2))*r*w1**2 + (5*m*R**2*r - 4*m0*R*r**2*tan(th) + 4*m0*r**3 - m*R**3*tan(th))*w3**2 - 8*m0*R*r*w1*s + R*(m*R**2 + 4*m0*(R*r*tan(th) - r**2))*w2*w3 - (m*R**2 + 4*m0*r**2)*g*sin(th) - 4*m0*g*R*r*cos(th) + (5*m/m0*R**2 + 4*R**2 + 4*r**2)*u)",
                right: SLIDING_ACCELERATION,
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(36) line 5",
        printed: "ω₂² (5mR²r − …)",
        right: "ω₃² (5mR²r − …)",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Test(
            "equation_36_line_5_has_the_third_pseudo_velocity_squared",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("sd"),
                printed: "1/(5*m*R**2 + 4*m0*r**2)*((5*m*R**2 + 4*m0*(R**2 + r**2))*r*w1**2 + (5*m*R**2*r - 4*m0*R*r**2*tan(th) + 4*m0*r**3 - m*R**3*tan(th))*w2**2 - 8*m0*R*r*w1*s + R*(m*R**2 + 4*m0*(R*r*tan(th) - r**2))*w2*w3 - (m*R**2 + 4*m0*r**2)*g*sin(th) - 4*m0*g*R*r*cos(th) + (5*m/m0*R**2 + 4*R**2 + 4*r**2)*u)",
                right: SLIDING_ACCELERATION,
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(36) line 5",
        printed: "− 8 ω₁ σ R² r",
        right: "− 8 ω₁ σ m₀ R r",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Test(
            "equation_36_line_5_has_the_sliding_mass_in_its_coriolis_term",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("sd"),
                printed: "1/(5*m*R**2 + 4*m0*r**2)*((5*m*R**2 + 4*m0*(R**2 + r**2))*r*w1**2 + (5*m*R**2*r - 4*m0*R*r**2*tan(th) + 4*m0*r**3 - m*R**3*tan(th))*w3**2 - 8*R**2*r*w1*s + R*(m*R**2 + 4*m0*(R*r*tan(th) - r**2))*w2*w3 - (m*R**2 + 4*m0*r**2)*g*sin(th) - 4*m0*g*R*r*cos(th) + (5*m/m0*R**2 + 4*R**2 + 4*r**2)*u)",
                right: SLIDING_ACCELERATION,
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(36) last line",
        printed: "cut after −ω₁",
        right: "ẏ_G = −ω₁ R cos ψ cos ϑ + ω₂ R sin ψ",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "equation_36_last_line_is_the_lateral_velocity",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("yGd"),
                printed: "-w1",
                right: "-w1*R*cos(psi)*cos(th) + w2*R*sin(psi)",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(48)",
        printed: "matrix missing",
        right: "the sparsity of appendix C; all other entries are zero",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Context(
            "(49) is exact for it; tested: `steering_paper_equation_48_and_appendix_c_linear_unicycle`",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(50)",
        printed: "A₅₄ = −R/5",
        right: "−g/5",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Test(
            "equation_50_has_gravity_in_entry_54",
            Comparison {
                subject: Subject::StraightUnicycle,
                quantity: Quantity::Derived("A54"),
                printed: "-R/5",
                right: "-g/5",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(50)",
        printed: "nine rows; R φ̇ in column 8",
        right: "ten rows; A₁₀,₇ = R φ̇",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "equation_50_has_the_forward_speed_in_entry_107",
            Comparison {
                subject: Subject::StraightUnicycle,
                quantity: Quantity::Derived("A107"),
                printed: "0",
                right: "R*Fd",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(50)",
        printed: "row of x_G missing",
        right: "A₉₂ = R",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "equation_50_has_the_radius_in_entry_92",
            Comparison {
                subject: Subject::StraightUnicycle,
                quantity: Quantity::Derived("A92"),
                printed: "0",
                right: "R",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(51)–(54)",
        printed: "stable if a, b, c have the same sign",
        right: "b² > 4ac is needed too; it always holds, so (54) stands",
        origin: ErratumOrigin::Misprint,
        evidence: Evidence::Context(
            "the discriminant of (b² − 4ac)/(16 g²R²) in φ̇²R/g is −20 m² m₀ (3m + m₀) < 0",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(55)",
        printed: "B₅ = (5m + 4m₀)/(5 m₀)",
        right: "(5m + 4m₀)/(5 m m₀)",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Test(
            "equation_55_has_both_masses_in_the_denominator",
            Comparison {
                subject: Subject::StraightUnicycle,
                quantity: Quantity::Derived("B5"),
                printed: "(5*m + 4*m0)/(5*m0)",
                right: "(5*m + 4*m0)/(5*m*m0)",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(57)",
        printed: "rows like M₁₁ M₁₂ M₁₃ 0 0 M₁₆",
        right: "odd and even powers of A alternate between two sets of rows; the rank 6 is right",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Context("ω₁ and σ answer in even powers, ϑ, r, y_G and ω₃ in odd ones"),
    },
    Erratum {
        source: Source::Steering,
        equation: "section IV.B",
        printed: "critical speed 1.21 m/s²",
        right: "1.2131 m/s",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Context("√(R g/2) is a velocity"),
    },
    Erratum {
        source: Source::Steering,
        equation: "after (66)",
        printed: "L = 10 m at 2 m/s",
        right: "L = 10 m at 5 m/s",
        origin: ErratumOrigin::Misprint,
        evidence: Evidence::Context(
            "tables II and III have the gains of 1 and 5 m/s; 10 m at 2 m/s would need a lateral velocity of 3.1 m/s",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(61)",
        printed: "“the input y”, “the state v_G”",
        right: "output y, state y_G",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Context("the text around it"),
    },
    Erratum {
        source: Source::Steering,
        equation: "(65)",
        printed: "six zeros and y_des",
        right: "five zeros and y_des",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Context("(61) has six outputs"),
    },
    Erratum {
        source: Source::Steering,
        equation: "(66)",
        printed: "L (cos(·) − 1), then −L",
        right: "(L/2) (cos(·) − 1), then −L",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Context(
            "the reference must not jump; tested: `the_reference_paths_are_continuous_as_corrected_and_not_as_printed`",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(69)",
        printed: "a stray row of eleven entries",
        right: "five rows that select the states 1, 4, 5, 6, 7",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Context("(68)"),
    },
    Erratum {
        source: Source::Steering,
        equation: "(71)",
        printed: "final value +π/2",
        right: "−π/2",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Context(
            "the reference must not jump, and a right turn has negative yaw; tested: `the_reference_paths_are_continuous_as_corrected_and_not_as_printed`",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "table III",
        printed: "P_ψ = 536.67 N at 1 m/s",
        right: "563.67 N",
        origin: ErratumOrigin::Misprint,
        evidence: Evidence::Context(
            "P_ψ = 5R²mp⁵/(8 φ̇ g); tested: `the_printed_gains_are_the_closed_forms_but_for_one`",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "section IV.B.1",
        printed: "|u| < 10 N at both speeds",
        right: "3.015 N at 1 m/s, 10.350 N at 5 m/s",
        origin: ErratumOrigin::Misprint,
        evidence: Evidence::Context(
            "simulated: `lane_change_at_5_metres_per_second_needs_more_force_than_the_paper_says`",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "(78)",
        printed: "velocities [… ψ̇ φ̇ φ̇]",
        right: "[ẋ_G ẏ_G ψ̇ ϑ̇ φ̇]",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Context("its matrix has the column of ϑ̇; the solution (79) is tested"),
    },
    Erratum {
        source: Source::Steering,
        equation: "(89)",
        printed: "− 4 m₀ R ω̇₁ σ̇",
        right: "− m₀ R ω̇₁ σ̇",
        origin: ErratumOrigin::Undecided,
        evidence: Evidence::Test(
            "equation_89_couples_tilt_and_slider_by_one_mass_times_radius",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::AccelerationEnergy,
                printed: PRINTED_ACCELERATION_ENERGY,
                right: ACCELERATION_ENERGY,
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "appendix C, A₁₃",
        printed: "3mR² ψ̇ and a second 2m₀Rr ψ̇ sin ϑ tan ϑ",
        right: "3mR² φ̇ and 2m₀Rr φ̇ tan ϑ",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "appendix_c_entry_13_has_the_pitch_rate_in_two_terms",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("A13"),
                printed: "2/(5*m*R**2 + 4*m0*r**2)*(2*m*R**2*Pd*sin(th) + 3*m*R**2*Pd + 2*m0*R*r*Pd*sin(th)*tan(th) + 2*m0*R*r*Pd*sin(th)*tan(th) - 4*m0*r**2*Pd*sin(th))",
                right: "2/(5*m*R**2 + 4*m0*r**2)*(2*m*R**2*Pd*sin(th) + 3*m*R**2*Fd + 2*m0*R*r*Pd*sin(th)*tan(th) + 2*m0*R*r*Fd*tan(th) - 4*m0*r**2*Pd*sin(th))",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "appendix C, A₁₄",
        printed: "4 m₈ R cos ϑ",
        right: "4 m g R cos ϑ",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "appendix_c_entry_14_has_gravity",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("A14"),
                printed: "4*m0*R*r*Pd*(Fd + Pd*sin(th))/((5*m*R**2 + 4*m0*r**2)*cos(th)) + (-m*R**2*Pd**2 + 4*m*R*cos(th) - 4*m0*r**2*Pd**2 + 4*m0*g*r*sin(th))/(5*m*R**2 + 4*m0*r**2)",
                right: "4*m0*R*r*Pd*(Fd + Pd*sin(th))/((5*m*R**2 + 4*m0*r**2)*cos(th)) + (-m*R**2*Pd**2 + 4*m*g*R*cos(th) - 4*m0*r**2*Pd**2 + 4*m0*g*r*sin(th))/(5*m*R**2 + 4*m0*r**2)",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "appendix C, A₁₆",
        printed: "products ψ̇ ψ̇",
        right: "ψ̇ φ̇",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "appendix_c_entry_16_has_products_of_yaw_and_pitch_rate",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("A16"),
                printed: "4*m0/(5*m*R**2 + 4*m0*r**2)**2*(5*m*R**3*Pd**2*sin(th)**2 + 5*m*R**3*Pd*Pd*sin(th) - 20*m*R**2*r*Pd**2*sin(th)*cos(th) - 12*m*R**2*r*Pd*Pd*cos(th) - 5*m*g*R**2*cos(th) - 4*m0*R*r**2*Pd**2*sin(th)**2 - 4*m0*R*r**2*Pd*Pd*sin(th) - 8*m*g*R*r*sin(th) + 4*m0*g*r**2*cos(th))",
                right: "4*m0/(5*m*R**2 + 4*m0*r**2)**2*(5*m*R**3*Pd**2*sin(th)**2 + 5*m*R**3*Pd*Fd*sin(th) - 20*m*R**2*r*Pd**2*sin(th)*cos(th) - 12*m*R**2*r*Pd*Fd*cos(th) - 5*m*g*R**2*cos(th) - 4*m0*R*r**2*Pd**2*sin(th)**2 - 4*m0*R*r**2*Pd*Fd*sin(th) - 8*m*g*R*r*sin(th) + 4*m0*g*r**2*cos(th))",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "appendix C, A₅₆",
        printed: "products ψ̇ ψ̇",
        right: "ψ̇ φ̇",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "appendix_c_entry_56_has_products_of_yaw_and_pitch_rate",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("A56"),
                printed: "(25*m**2*R**4*Pd**2*cos(th)**2 + 20*m*m0*R**4*Pd**2*sin(th)**2 + 20*m*m0*R**4*Pd*Pd*sin(th) - 80*m*m0*R**3*r*Pd**2*sin(th)*cos(th) - 48*m*m0*R**3*r*Pd*Pd*cos(th) - 20*m*m0*g*R**3*cos(th) + 40*m*m0*R**2*r**2*Pd**2*cos(th)**2 - 16*m0**2*R**2*r**2*Pd**2*sin(th)**2 - 16*m0**2*R**2*r**2*Pd*Pd*sin(th) - 32*m*m0*g*R**2*r*sin(th) + 16*m0**2*g*R*r**2*cos(th) + 16*m0**2*r**4*Pd**2*cos(th)**2)/(5*m*R**2 + 4*m0*r**2)**2",
                right: "(25*m**2*R**4*Pd**2*cos(th)**2 + 20*m*m0*R**4*Pd**2*sin(th)**2 + 20*m*m0*R**4*Pd*Fd*sin(th) - 80*m*m0*R**3*r*Pd**2*sin(th)*cos(th) - 48*m*m0*R**3*r*Pd*Fd*cos(th) - 20*m*m0*g*R**3*cos(th) + 40*m*m0*R**2*r**2*Pd**2*cos(th)**2 - 16*m0**2*R**2*r**2*Pd**2*sin(th)**2 - 16*m0**2*R**2*r**2*Pd*Fd*sin(th) - 32*m*m0*g*R**2*r*sin(th) + 16*m0**2*g*R*r**2*cos(th) + 16*m0**2*r**4*Pd**2*cos(th)**2)/(5*m*R**2 + 4*m0*r**2)**2",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "appendix C, A₂₁",
        printed: "4m₀Rr ψ̇ in the last but one term",
        right: "4m₀Rr φ̇",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "appendix_c_entry_21_has_the_pitch_rate",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("A21"),
                printed: "-(2*m*R**2*Pd*cos(th) + 2*m0*R**2*Pd*cos(th) + 4*m0*R*r*Pd*sin(th) + 4*m0*R*r*Pd + 8*m0*r**2*Pd*cos(th))/(3*m*R**2 + 2*m0*R**2 + 12*m0*r**2)",
                right: "-(2*m*R**2*Pd*cos(th) + 2*m0*R**2*Pd*cos(th) + 4*m0*R*r*Pd*sin(th) + 4*m0*R*r*Fd + 8*m0*r**2*Pd*cos(th))/(3*m*R**2 + 2*m0*R**2 + 12*m0*r**2)",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "appendix C, A₅₂",
        printed: "Rψ̇ cos ϑ/(5mR² + 4m₀R² + 4m₀Rr tan ϑ − 4m₀r²)",
        right: "Rψ̇ cos ϑ (mR² + 4m₀Rr tan ϑ − 4m₀r²)/(5mR² + 4m₀r²)",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "appendix_c_entry_52_is_a_quotient",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("A52"),
                printed: "R*Pd*cos(th)/(5*m*R**2 + 4*m0*R**2 + 4*m0*R*r*tan(th) - 4*m0*r**2)",
                right: "R*Pd*cos(th)/(5*m*R**2 + 4*m0*r**2)*(m*R**2 + 4*m0*R*r*tan(th) - 4*m0*r**2)",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "appendix C, A₅₃",
        printed: "a spurious 4m₀r/r and repeated fragments",
        right: "the entry of the test",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Context(
            "all legible terms agree; tested: `steering_paper_equation_48_and_appendix_c_linear_unicycle`",
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "appendix C, second A₉₁",
        printed: "A₉₁ = −R (ψ̇ sin ϑ + φ̇) sin ψ",
        right: "this is A₉₇",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "appendix_c_names_entry_97_by_the_name_of_entry_91",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("A91"),
                printed: "-R*(Pd*sin(th) + Fd)*sin(psi)",
                right: "R*sin(psi)*cos(th)",
            },
        ),
    },
    Erratum {
        source: Source::Steering,
        equation: "appendix C, A₁₀,₇",
        printed: "cut",
        right: "R (ψ̇ sin ϑ + φ̇) cos ψ",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "appendix_c_entry_107_is_cut",
            Comparison {
                subject: Subject::Unicycle,
                quantity: Quantity::Derived("A107"),
                printed: "R",
                right: "R*(Pd*sin(th) + Fd)*cos(psi)",
            },
        ),
    },
    Erratum {
        source: Source::Euc,
        equation: "(10)",
        printed: "last argument φ̇",
        right: "φ̈",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "equation_10_depends_on_the_angular_acceleration_of_the_rider",
            Comparison {
                subject: Subject::Euc3,
                quantity: Quantity::Solves {
                    residual: "row2 + row3",
                    unknown: "Md",
                    before: &[("ddx", "(Md/R - m12*ddga - m13*ddph - h1)/m11")],
                },
                printed: "R*m11/(R*m11 + m12 + m13)*((m0*h0 - m*l0)*g*sin(ga) + m*g*h*sin(ph) - (m22 + m23)*ddga - (m23 + m33)*dph - h2 - h3 + (m12 + m13)/m11*(m12*ddga + m13*dph + h1))",
                right: "R*m11/(R*m11 + m12 + m13)*((m0*h0 - m*l0)*g*sin(ga) + m*g*h*sin(ph) - (m22 + m23)*ddga - (m23 + m33)*ddph - h2 - h3 + (m12 + m13)/m11*(m12*ddga + m13*ddph + h1))",
            },
        ),
    },
    Erratum {
        source: Source::Euc,
        equation: "(13), first formula",
        printed: "sin φ φ² and cos φ φ",
        right: "sin φ φ̇² and cos φ φ̈",
        origin: ErratumOrigin::Recognition,
        evidence: Evidence::Test(
            "equation_13_has_rates_of_the_rider_angle",
            Comparison {
                subject: Subject::Euc2,
                quantity: Quantity::Solves {
                    residual: "row1",
                    unknown: "Md",
                    before: &[],
                },
                printed: "-m*h*R*sin(ph)*ph**2 + (m + m0 + mw + Jw/R**2)*R*ddx + m*h*R*cos(ph)*ph",
                right: "-m*h*R*sin(ph)*dph**2 + (m + m0 + mw + Jw/R**2)*R*ddx + m*h*R*cos(ph)*ddph",
            },
        ),
    },
];

/// Acceleration energy (89) as printed.
const PRINTED_ACCELERATION_ENERGY: &str = concat!(
    "1/8*(5*m*R**2 + 4*m0*(R**2 + r**2))*w1d**2 + 1/4*(3*m + 2*m0)*R**2*w2d**2",
    " + 1/8*(m*R**2 + 4*m0*r**2)*w3d**2 + m0/2*sd**2 - 4*m0*R*w1d*sd - m0*R*r*w2d*w3d",
    " + 1/4*(8*w1*s*m0*r + w3**2*(4*m0*r**2*tan(th) + 4*m0*R*r + m*R**2*tan(th))",
    " - w2*w3*(6*m*R**2 + 4*m0*R**2 + 4*m0*R*r*tan(th)))*w1d",
    " + (w1*w3*(m*R**2 + m0*R**2 + m0*R*r*tan(th)) - 2*w3*s*m0*R)*w2d",
    " + 1/4*(2*w1*w2*m*R**2 - w1*w3*(m*R**2 + 4*m0*r**2)*tan(th) - 4*w1*w3*m0*R*r + 8*w3*s*m0*r)*w3d",
    " - m0*(w1**2*r - w2*w3*R + w3**2*r)*sd",
);
