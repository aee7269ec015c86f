//! The skeleton: names, parents, bind positions, and forward kinematics.

use bevy::math::{Mat4, Quat, Vec3};

use crate::species::Species;

/// One joint. Every joint's bind rotation is the identity.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name, `_L` or `_R` on paired joints.
    pub name: String,
    /// Parent, always earlier in the list.
    pub parent: Option<usize>,
    /// Bind position in model space, mm.
    pub position: Vec3,
}

/// All joints, parents first.
pub struct Skeleton {
    /// Joints.
    pub joints: Vec<Joint>,
}

/// A pose: per joint rotation, translation added to the bind offset, and scale.
#[derive(Clone, Debug)]
pub struct Pose {
    /// Local rotations.
    pub rotation: Vec<Quat>,
    /// Added local translations, mm.
    pub offset: Vec<Vec3>,
    /// Local scales.
    pub scale: Vec<Vec3>,
}

const CENTRE: [(&str, &str); 10] = [
    ("root", ""),
    ("hips", "root"),
    ("chest", "hips"),
    ("neck1", "chest"),
    ("neck2", "neck1"),
    ("neck3", "neck2"),
    ("neck4", "neck3"),
    ("head", "neck4"),
    ("jaw", "head"),
    ("upper_bill", "head"),
];

const SIDE: [(&str, &str); 14] = [
    ("eye", "head"),
    ("lid_up", "head"),
    ("lid_lo", "head"),
    ("tail_fan", "tail"),
    ("scap", "chest"),
    ("humerus", "scap_L"),
    ("ulna", "humerus_L"),
    ("hand", "ulna_L"),
    ("digit", "hand_L"),
    ("alula", "hand_L"),
    ("propat", "humerus_L"),
    ("femur", "hips"),
    ("tibia", "femur_L"),
    ("tarsus", "tibia_L"),
];

impl Skeleton {
    /// Builds the 57 joints of a bird; `toes` gives the bind positions of the joints (a, b) of toes I..IV of the left foot.
    pub fn new(species: &Species, toes: &[[Vec3; 2]; 4]) -> Self {
        let mut skeleton = Self { joints: Vec::new() };
        for (name, parent) in CENTRE {
            skeleton.add(name, parent, species.joint(name));
        }
        skeleton.add("tail", "hips", species.joint("tail"));
        for side in ["_L", "_R"] {
            let mirror = if side == "_L" {
                Vec3::ONE
            } else {
                Vec3::new(-1.0, 1.0, 1.0)
            };
            for (stem, parent) in SIDE {
                let parent = parent.replace("_L", side);
                skeleton.add(
                    &format!("{stem}{side}"),
                    &parent,
                    species.joint(&format!("{stem}_L")) * mirror,
                );
            }
            let foot = format!("foot{side}");
            skeleton.add(
                &foot,
                &format!("tarsus{side}"),
                species.joint("foot_L") * mirror,
            );
            for (i, [a, b]) in toes.iter().enumerate() {
                let first = format!("toe{}a{side}", i + 1);
                skeleton.add(&first, &foot, *a * mirror);
                skeleton.add(&format!("toe{}b{side}", i + 1), &first, *b * mirror);
            }
        }
        skeleton
    }

    fn add(&mut self, name: &str, parent: &str, position: Vec3) {
        let parent = self.joints.iter().position(|j| j.name == parent);
        self.joints.push(Joint {
            name: name.to_string(),
            parent,
            position,
        });
    }

    /// Index of a joint by name; the root when there is none.
    pub fn index(&self, name: &str) -> usize {
        self.joints.iter().position(|j| j.name == name).unwrap_or(0)
    }

    /// Bind offset from the parent.
    pub fn offset(&self, i: usize) -> Vec3 {
        let j = &self.joints[i];
        j.position - j.parent.map_or(Vec3::ZERO, |p| self.joints[p].position)
    }

    /// The bind pose.
    pub fn bind(&self) -> Pose {
        let n = self.joints.len();
        Pose {
            rotation: vec![Quat::IDENTITY; n],
            offset: vec![Vec3::ZERO; n],
            scale: vec![Vec3::ONE; n],
        }
    }

    /// Skinning matrices (model space to model space) of a pose.
    pub fn matrices(&self, pose: &Pose) -> Vec<Mat4> {
        let mut global: Vec<Mat4> = Vec::with_capacity(self.joints.len());
        for (i, j) in self.joints.iter().enumerate() {
            let local = Mat4::from_scale_rotation_translation(
                pose.scale[i],
                pose.rotation[i],
                self.offset(i) + pose.offset[i],
            );
            global.push(j.parent.map_or(local, |p| global[p] * local));
        }
        global
            .iter()
            .zip(&self.joints)
            .map(|(g, j)| *g * Mat4::from_translation(-j.position))
            .collect()
    }

    /// Global rotations of a pose, without scale.
    pub fn rotations(&self, pose: &Pose) -> Vec<Quat> {
        let mut global: Vec<Quat> = Vec::with_capacity(self.joints.len());
        for (i, j) in self.joints.iter().enumerate() {
            global.push(
                j.parent
                    .map_or(pose.rotation[i], |p| global[p] * pose.rotation[i]),
            );
        }
        global
    }
}

impl Pose {
    /// Sets a joint's local rotation so that its global rotation is `global`, given its parent's.
    pub fn set_global(&mut self, skeleton: &Skeleton, joint: usize, parent: Quat, global: Quat) {
        debug_assert!(joint < skeleton.joints.len());
        self.rotation[joint] = (parent.inverse() * global).normalize();
    }
}
