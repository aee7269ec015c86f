// How far behind the nearest feather another one may lie and still be seen. Twin of src/maths/order.rs.
#define_import_path bevy_plumage::order
#import bevy_plumage::math::smooth_step

// `window`: the widest; `facing`: cosine between the eye and the front face; `along`: share of the length.
fn order_reach(window: f32, facing: f32, along: f32) -> f32 {
    return window * clamp(4.0 * facing, 0.0, 1.0) * smooth_step(0.05, 0.3, along);
}
