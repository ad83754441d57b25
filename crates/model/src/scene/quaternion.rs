//! Quaternions: normalization and spherical interpolation with the same bits on every host.

use glam::DQuat;

/// A normalized quaternion. Without a direction (a spline may pass through zero) it is the
/// identity.
pub fn unit(q: [f64; 4]) -> DQuat {
    let largest = q.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return DQuat::IDENTITY;
    }
    let q = q.map(|v| v / largest);
    let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    DQuat::from_array(q.map(|v| v / length))
}

/// Spherical interpolation along the shorter arc (Shoemake 1985). It uses libm, so every host
/// computes the same bits.
pub fn slerp(a: DQuat, b: DQuat, fraction: f64) -> DQuat {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    let (apart, together) = ((a - b).length(), (a + b).length());
    let angle = 2.0 * libm::atan2(apart, together);
    let (from, to) = if angle < 1e-8 {
        (1.0 - fraction, fraction)
    } else {
        let whole = libm::sin(angle);
        (
            libm::sin((1.0 - fraction) * angle) / whole,
            libm::sin(fraction * angle) / whole,
        )
    };
    unit((a * from + b * to).to_array())
}
