//! What the compiler refuses: each mistake beside the same lines without it, so that it is refused for
//! no other reason. (Stable compilers ignore the code of the error; nightly ones compare it.)

macro_rules! refused {
    ($(#[$doc:meta])* $name:ident: $code:literal; given $given:literal; good $good:literal; bad $bad:literal) => {
        $(#[$doc])*
        #[doc = concat!("```\n", $given, "\n", $good, "\n```\n")]
        #[doc = concat!("```compile_fail,", $code, "\n", $given, "\n", $bad, "\n```\n")]
        mod $name {}
    };
}

refused! {
    /// Vectors of two frames cannot be added.
    sum_of_frames: "E0308";
    given "
        use stormpetrel_control::math::{Body, Vec3, World};
        let (velocity, rate) = (Vec3::<f64, World>::zero(), Vec3::<f64, Body>::zero());";
    good "let sum = velocity + velocity; let _ = rate;";
    bad "let sum = velocity + rate; let _ = rate;"
}

refused! {
    /// A rotation from body to world takes no vector that is in the world already.
    turned_twice: "E0277";
    given "
        use stormpetrel_control::math::{Body, Rotation, Vec3, World};
        let attitude = Rotation::<f64, Body, World>::default();
        let up = Vec3::<f64, Body>::up(1.0);";
    good "let thrust = attitude * up;";
    bad "let thrust = attitude * (attitude * up);"
}

refused! {
    /// Numbers that may be lanes have no order to branch on.
    branch_on_order: "E0369";
    given "use stormpetrel_control::real::Real;";
    good "fn greater<T: Real>(a: T, b: T) -> T { T::select(a.lt(b), b, a) }";
    bad "fn greater<T: Real>(a: T, b: T) -> T { if a < b { b } else { a } }"
}

refused! {
    /// The answer of a comparison is one for each lane, and none to branch on.
    branch_on_mask: "E0308";
    given "use stormpetrel_control::real::Real;";
    good "fn greater<T: Real>(a: T, b: T) -> T { T::select(a.lt(b), b, a) }";
    bad "fn greater<T: Real>(a: T, b: T) -> T { if a.lt(b) { b } else { a } }"
}

refused! {
    /// A rate law does not fit where an attitude law belongs.
    wrong_block: "E0308";
    given "
        use stormpetrel_control::attitude::AttitudeLaw;
        use stormpetrel_control::rate::RateLaw;
        use stormpetrel_control::stack::Laws;
        fn with(laws: Laws<f64>, attitude: AttitudeLaw<f64>, rate: RateLaw<f64>) -> Laws<f64> {";
    good "Laws { attitude, rate, ..laws } }";
    bad "Laws { attitude: rate, rate, ..laws } }"
}

refused! {
    /// The command of the position law goes to the attitude reference, not to the rate law.
    skipped_level: "E0308";
    given "
        use stormpetrel_control::controller::Controller as _;
        use stormpetrel_control::rate::RateLaw;
        use stormpetrel_control::signals::{Measurement, Rate, Thrust};
        let (mut law, measurement) = (RateLaw::<f64>::default(), Measurement::default());
        let (thrust, rate) = (Thrust::<f64>::default(), Rate::<f64>::default());";
    good "let wrench = law.update(&measurement, &rate, 1e-3); let _ = thrust;";
    bad "let wrench = law.update(&measurement, &thrust, 1e-3); let _ = rate;"
}
