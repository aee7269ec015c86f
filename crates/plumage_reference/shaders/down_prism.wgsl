#define_import_path bevy_plumage::down_prism

// Address of a point inside a prism of the shell. Twin of crates/plumage_reference/src/undercoat/prism.rs, where the comments are.

const MAX_LEVEL: u32 = 12u;

struct PrismCell {
    a: u32,
    b: u32,
    down: bool,
}

fn prism_index(lambda: vec3<f32>, level: u32) -> u32 {
    let rows = 1u << min(level, MAX_LEVEL);
    let n = f32(rows);
    let u = n * clamp(lambda.y, 0.0, 1.0);
    let v = n * clamp(lambda.z, 0.0, 1.0);
    let row = min(u32(u + v), rows - 1u);
    let a = min(u32(u), row);
    let b = min(u32(v), row - a);
    return row * row + row + b - a;
}

fn prism_cell(index: u32) -> PrismCell {
    var row = u32(sqrt(f32(index)));
    if row * row > index {
        row -= 1u;
    }
    if (row + 1u) * (row + 1u) <= index {
        row += 1u;
    }
    let twice = index - row * row;
    let down = twice & 1u;
    let b = twice / 2u;
    return PrismCell(row - down - b, b, down == 1u);
}

fn prism_centre(cell: PrismCell, level: u32) -> vec3<f32> {
    let n = f32(1u << min(level, MAX_LEVEL));
    let third = select(1.0 / 3.0, 2.0 / 3.0, cell.down);
    let l = (vec2(f32(cell.a), f32(cell.b)) + third) / n;
    return vec3(1.0 - l.x - l.y, l.x, l.y);
}

fn prism_element(base: u32, layer: u32, level: u32, index: u32) -> u32 {
    return base + (layer << (2u * min(level, MAX_LEVEL))) + index;
}

fn prism_level(edge_px: f32, target_px: f32, deepest: u32) -> f32 {
    let ratio = edge_px / max(target_px, 1e-6);
    return clamp(log2(max(ratio, 1.0)), 0.0, f32(min(deepest, MAX_LEVEL)));
}

fn prism_level_next(current: u32, wanted: f32) -> u32 {
    let off = wanted - f32(current);
    if off > 0.8 {
        return current + 1u;
    }
    if off < -0.8 && current > 0u {
        return current - 1u;
    }
    return current;
}
