// Samples as instances. Places are lattice units: whole radii are subtracted as integers before anything is a float.

struct Frame {
    // The target's size and the place of the camera's centre on it, in pixels.
    target_size: vec2<f32>,
    middle: vec2<f32>,
    // The camera's centre: whole r, and lattice units beyond.
    whole: vec2<i32>,
    rest: vec2<f32>,
    // Pixels per r, pixels per lattice unit, pixels per screen point, opacity of points.
    scale: vec4<f32>,
    // Radii of dot, cross, diamond and ring in pixels, or of disks.
    radii: vec4<f32>,
    // Outlines, premultiplied, gamma encoded.
    outline: vec4<f32>,
    // Opacity of a disk's fill and of its ring.
    disk: vec2<f32>,
    // Bit k: symbols of kind k are drawn.
    kinds: u32,
    // Only samples of ids below this are drawn.
    shown: u32,
};

@group(0) @binding(0) var<uniform> frame: Frame;

const LATTICE_BITS: u32 = 15u;
const OUTLINE: f32 = 1.6;
const NOWHERE: vec4<f32> = vec4<f32>(2.0, 2.0, 2.0, 1.0);

struct Sample {
    @location(0) place: vec2<i32>,
    @location(1) color: vec4<f32>,
    @location(2) look: u32,
    @location(3) id: u32,
};

struct Mark {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) color: vec4<f32>,
    // The centre on the target, the radius (pixels), and 0 for a disk or the symbol, plus 16 with an outline.
    @location(1) @interpolate(flat, either) shape: vec4<f32>,
};

fn pixel_from_lattice(place: vec2<i32>) -> vec2<f32> {
    let bits = vec2<u32>(LATTICE_BITS);
    let radii = vec2<f32>((place >> bits) - frame.whole);
    // Masked and shifted, a place below 0 has its units counted upwards from the whole r below it.
    let units = vec2<f32>(place & vec2<i32>((1 << LATTICE_BITS) - 1)) - frame.rest;

    let offset = radii * frame.scale.x + units * frame.scale.y;
    return frame.middle + vec2<f32>(offset.x, -offset.y);
}

fn clip_from_pixel(pixel: vec2<f32>) -> vec4<f32> {
    let unit = 2.0 * pixel / frame.target_size - 1.0;
    return vec4<f32>(unit.x, -unit.y, 0.0, 1.0);
}

fn is_shown(in: Sample) -> bool {
    return ((frame.kinds >> (in.look & 7u)) & 1u) == 1u && in.id < frame.shown;
}

// The corner of a square around `middle`, cut off at the border of the target: what lies beyond is not interpolated.
fn corner(index: u32, middle: vec2<f32>, half: f32) -> vec4<f32> {
    let side = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let pixel = clamp(middle + side * half, vec2<f32>(0.0), frame.target_size);
    return clip_from_pixel(pixel);
}

@vertex
fn disk_corner(@builtin(vertex_index) index: u32, in: Sample) -> Mark {
    let middle = pixel_from_lattice(in.place);

    var out: Mark;
    out.position = NOWHERE;

    // A point of the screen more than the disk, for its ring, and a pixel for the soft edge.
    if (in.look & 8u) != 0u && in.id < frame.shown {
        out.position = corner(index, middle, frame.radii.x + frame.scale.z + 1.0);
    }

    out.color = in.color;
    out.shape = vec4<f32>(middle, frame.radii.x, 0.0);
    return out;
}

@vertex
fn symbol_corner(@builtin(vertex_index) index: u32, in: Sample) -> Mark {
    let middle = pixel_from_lattice(in.place);
    let symbol = in.look & 7u;
    let outlined = (in.look >> 4u) & 1u;
    let size = f32((in.look >> 8u) & 255u) / 16.0;

    var radius = frame.radii.x;
    if symbol == 2u { radius = frame.radii.y; }
    if symbol == 3u { radius = frame.radii.z; }
    if symbol == 4u { radius = frame.radii.w; }
    radius *= size;

    var out: Mark;
    out.position = NOWHERE;

    if is_shown(in) {
        let around = (1.0 + OUTLINE * f32(outlined)) * frame.scale.z + 1.0;
        out.position = corner(index, middle, radius + around);
    }

    out.color = in.color;
    out.shape = vec4<f32>(middle, radius, f32(symbol + 16u * outlined));
    return out;
}

@vertex
fn point(in: Sample) -> Mark {
    let middle = pixel_from_lattice(in.place);
    var out: Mark;
    out.position = NOWHERE;
    if is_shown(in) {
        out.position = clip_from_pixel(middle);
    }
    out.color = in.color * frame.scale.w;
    out.shape = vec4<f32>(middle, 0.5, 0.0);
    return out;
}

// Opacity from the distance to the edge in pixels, negative inside.
fn solid(distance: f32) -> f32 {
    return clamp(0.5 - distance, 0.0, 1.0);
}

fn line(distance: f32, width: f32) -> f32 {
    return solid(abs(distance) - 0.5 * width);
}

fn cross_opacity(at: vec2<f32>, radius: f32) -> f32 {
    let point = frame.scale.z;
    let turned = abs(vec2<f32>(at.x + at.y, at.x - at.y)) * sqrt(0.5);

    let arm = max(0.26 * radius, min(0.7 * point, 0.5 * radius));
    let one = max(turned.x - radius, turned.y - arm);
    let other = max(turned.y - radius, turned.x - arm);
    let distance = min(one, other);

    // A small cross is filled; of a large one only the outline is drawn.
    if radius < 4.0 * point {
        return solid(distance);
    }
    return line(distance, 1.1 * point);
}

fn opacity(symbol: u32, at: vec2<f32>, radius: f32) -> f32 {
    let from_middle = length(at);
    switch symbol {
        case 2u: { return cross_opacity(at, radius); }
        case 3u: { return solid((abs(at.x) + abs(at.y) - radius) * sqrt(0.5)); }
        case 4u: {
            let ring = line(from_middle - radius, min(1.4 * frame.scale.z, 0.6 * radius));
            return max(ring, solid(from_middle - 0.34 * radius));
        }
        default: { return solid(from_middle - radius); }
    }
}

fn disk_color(in: Mark) -> vec4<f32> {
    let edge = distance(in.position.xy, in.shape.xy) - in.shape.z;
    let ring = frame.disk.y * line(edge, 0.9 * frame.scale.z);
    return in.color * max(frame.disk.x * solid(edge), ring);
}

fn symbol_color(in: Mark) -> vec4<f32> {
    let at = in.position.xy - in.shape.xy;
    let kind = u32(in.shape.w);
    let symbol = kind & 15u;

    let mark = in.color * opacity(symbol, at, in.shape.z);
    if (kind & 16u) == 0u {
        return mark;
    }

    let wide = min(OUTLINE * frame.scale.z, 0.8 * in.shape.z);
    let around = opacity(symbol, at, in.shape.z + wide);
    return mark + frame.outline * around * (1.0 - mark.a);
}

// The user interface blends gamma-encoded colours. A target that encodes by itself is given linear ones.
fn linear_from_gamma(color: vec4<f32>) -> vec4<f32> {
    let low = color.rgb / 12.92;
    let high = pow((color.rgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, color.rgb < vec3<f32>(0.04045)), color.a);
}

@fragment
fn disk_gamma(in: Mark) -> @location(0) vec4<f32> {
    return disk_color(in);
}

@fragment
fn disk_linear(in: Mark) -> @location(0) vec4<f32> {
    return linear_from_gamma(disk_color(in));
}

@fragment
fn symbol_gamma(in: Mark) -> @location(0) vec4<f32> {
    return symbol_color(in);
}

@fragment
fn symbol_linear(in: Mark) -> @location(0) vec4<f32> {
    return linear_from_gamma(symbol_color(in));
}

@fragment
fn point_gamma(in: Mark) -> @location(0) vec4<f32> {
    return in.color;
}

@fragment
fn point_linear(in: Mark) -> @location(0) vec4<f32> {
    return linear_from_gamma(in.color);
}
