//! Joint transforms of a skin: matrices for linear skinning, or dual quaternions with a stretch.
//! Rounded to f32 once.

use std::sync::Arc;

use glam::{DMat3, DMat4, DQuat, DVec3};

use super::quaternion::unit;
use crate::accuracy::Skinning;

/// The upper three rows of the matrix from the mesh to the scene; the fourth row is 0 0 0 1.
pub type JointMatrix = [[f32; 4]; 3];

/// A joint matrix as a stretch followed by a unit dual quaternion (rotation and translation).
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct DualQuaternionJoint {
    /// The rotation, a unit quaternion (x, y, z, w).
    pub real: [f32; 4],
    /// Half the translation times the rotation.
    pub dual: [f32; 4],
    /// Rows of a 3 x 3 matrix; the fourth entry of each is 0.
    pub stretch: [[f32; 4]; 3],
}

/// The joints of a skin, in the form that its skinning method needs.
#[derive(Clone, Debug, PartialEq)]
pub enum JointTransforms {
    Linear(Arc<[JointMatrix]>),
    Dual(Arc<[DualQuaternionJoint]>),
}

impl JointTransforms {
    /// The number of joints.
    pub fn len(&self) -> usize {
        match self {
            Self::Linear(joints) => joints.len(),
            Self::Dual(joints) => joints.len(),
        }
    }

    /// Returns true if there are no joints.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The skinning method that these transforms are for.
    pub fn skinning(&self) -> Skinning {
        match self {
            Self::Linear(_) => Skinning::Linear,
            Self::Dual(_) => Skinning::Dual,
        }
    }

    /// The matrix of one joint.
    pub fn matrix(&self, joint: usize) -> DMat4 {
        match self {
            Self::Linear(joints) => matrix(&joints[joint]),
            Self::Dual(joints) => joints[joint].matrix(),
        }
    }

    /// The matrices of all joints.
    pub fn matrices(&self) -> impl Iterator<Item = DMat4> {
        (0..self.len()).map(|joint| self.matrix(joint))
    }
}

impl DualQuaternionJoint {
    /// Splits an affine matrix. Gram-Schmidt on its columns gives the rotation, and the remaining
    /// factor is the stretch, which also holds mirroring. A degenerate column is replaced by
    /// any orthonormal one.
    pub(super) fn of(m: &DMat4) -> Self {
        let linear = DMat3::from_mat4(*m);
        let x = linear.x_axis.try_normalize().unwrap_or(DVec3::X);
        let y = (linear.y_axis - x * x.dot(linear.y_axis))
            .try_normalize()
            .unwrap_or_else(|| x.any_orthonormal_vector());
        let rotation = DMat3::from_cols(x, y, x.cross(y));
        let stretch = rotation.transpose() * linear;
        let real = unit(DQuat::from_mat3(&rotation).to_array());
        let shift = m.w_axis.truncate();
        let dual = DQuat::from_xyzw(shift.x, shift.y, shift.z, 0.0) * real * 0.5;
        let rounded = |v: [f64; 4]| v.map(|v| v as f32);
        let row = |row: usize| rounded(stretch.row(row).extend(0.0).to_array());
        Self {
            real: rounded(real.to_array()),
            dual: rounded(dual.to_array()),
            stretch: [row(0), row(1), row(2)],
        }
    }

    /// The same transform as a matrix.
    pub fn matrix(&self) -> DMat4 {
        let [real, dual] = [self.real, self.dual].map(|q| DQuat::from_array(q.map(f64::from)));
        let shift = dual * real.conjugate() * (2.0 / real.length_squared());
        let rows = self
            .stretch
            .map(|row| DVec3::new(row[0].into(), row[1].into(), row[2].into()));
        let linear = DMat3::from_quat(unit(real.to_array()))
            * DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
        let mut matrix = DMat4::from_mat3(linear);
        matrix.w_axis = DVec3::new(shift.x, shift.y, shift.z).extend(1.0);
        matrix
    }
}

/// The matrix of a joint.
pub fn matrix([x, y, z]: &JointMatrix) -> DMat4 {
    let rows = [
        x.map(f64::from),
        y.map(f64::from),
        z.map(f64::from),
        [0.0, 0.0, 0.0, 1.0],
    ];
    DMat4::from_cols_array_2d(&rows).transpose()
}

pub(super) fn rounded_rows(m: &DMat4) -> JointMatrix {
    [0, 1, 2].map(|row| m.row(row).to_array().map(|entry| entry as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_taken_apart_is_the_same_matrix() {
        let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -2.0) / 3.0, 2.5);
        for scale in [
            DVec3::ONE,
            DVec3::new(2.0, 0.5, 3.0),
            DVec3::new(1.0, 1.0, -1.0),
        ] {
            let m =
                DMat4::from_scale_rotation_translation(scale, turn, DVec3::new(5.0, -7.0, 0.25));
            let sheared = m * DMat4::from_cols_array(&[
                1., 0., 0., 0., 0.5, 1., 0., 0., 0., -0.25, 1., 0., 0., 0., 0., 1.,
            ]);
            for m in [m, sheared] {
                assert!(
                    DualQuaternionJoint::of(&m).matrix().abs_diff_eq(m, 4e-6),
                    "{m}\n{}",
                    DualQuaternionJoint::of(&m).matrix()
                );
            }
        }
    }

    #[test]
    fn rows_and_matrices_say_the_same() {
        let m = DMat4::from_cols_array(&[
            1., 2., 3., 0., 4., 5., 6., 0., 7., 8., 9., 0., 10., 11., 12., 1.,
        ]);
        assert_eq!(matrix(&rounded_rows(&m)), m);
    }
}
