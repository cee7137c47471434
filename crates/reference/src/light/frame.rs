//! Tangent frames.

/// The tangent frame of a surface whose normal is at (θn, φn) in the world.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    tangent: [f64; 3],
    bitangent: [f64; 3],
    normal: [f64; 3],
}

impl Frame {
    /// n = (sin θ cos φ, sin θ sin φ, cos θ), the tangent ∂n/∂θ and the bitangent ∂n/∂φ / sin θ, whose limit at the poles is
    /// (−sin φ, cos φ, 0) too.
    pub fn new(theta_n: f64, phi_n: f64) -> Self {
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = (theta_n.sin_cos(), phi_n.sin_cos());
        Self {
            tangent: [cos_theta * cos_phi, cos_theta * sin_phi, -sin_theta],
            bitangent: [-sin_phi, cos_phi, 0.0],
            normal: [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta],
        }
    }

    /// The normal.
    pub fn normal(&self) -> [f64; 3] {
        self.normal
    }

    /// A vector of the world in this frame.
    pub fn to_local(&self, world: [f64; 3]) -> [f64; 3] {
        let along = |axis: &[f64; 3]| axis[0] * world[0] + axis[1] * world[1] + axis[2] * world[2];
        [along(&self.tangent), along(&self.bitangent), along(&self.normal)]
    }

    /// A vector of this frame in the world.
    pub fn to_world(&self, local: [f64; 3]) -> [f64; 3] {
        let component =
            |k: usize| local[0] * self.tangent[k] + local[1] * self.bitangent[k] + local[2] * self.normal[k];
        [component(0), component(1), component(2)]
    }

    /// The direction of the world that an ideal mirror shows to one who looks from (θe, φe) of this frame.
    pub fn mirror(&self, theta_e: f64, phi_e: f64) -> [f64; 3] {
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = (theta_e.sin_cos(), phi_e.sin_cos());
        self.to_world([-sin_theta * cos_phi, -sin_theta * sin_phi, cos_theta])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∂n/∂θ and ∂n/∂φ / sin θ by differences, and back and forth.
    #[test]
    fn axes_are_the_derivatives_of_the_normal() {
        let (theta, phi, step) = (0.7, 2.1, 1e-6);
        let frame = Frame::new(theta, phi);
        let slope = |to: Frame, from: Frame, by: f64| -> [f64; 3] {
            std::array::from_fn(|k| (to.normal[k] - from.normal[k]) / by)
        };
        let down = slope(Frame::new(theta + step, phi), Frame::new(theta - step, phi), 2.0 * step);
        let around =
            slope(Frame::new(theta, phi + step), Frame::new(theta, phi - step), 2.0 * step * theta.sin());
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-9);
        assert!(near(down, frame.tangent) && near(around, frame.bitangent), "{frame:?}");
        assert!(near(frame.to_local(frame.to_world([0.1, 0.2, 0.3])), [0.1, 0.2, 0.3]));
        assert!(near(Frame::new(0.0, 0.0).to_world([0.1, 0.2, 0.3]), [0.1, 0.2, 0.3]));
        assert!(near(frame.mirror(0.0, 1.0), frame.normal));
    }
}
