#define_import_path bevy_plumage::math

// Pure maths shared by the other modules. Twin of src/query/math.rs.

const PI: f32 = 3.14159265358979;

// Error function, Abramowitz and Stegun 7.1.26, absolute error below 1.5e-7 plus rounding.
fn error_function(x: f32) -> f32 {
    let a = abs(x);
    let t = 1.0 / (1.0 + 0.3275911 * a);
    let p = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t;
    let y = 1.0 - p * exp(-a * a);
    return select(y, -y, x < 0.0);
}
