//! What Rust says of the memory that it shares with the shaders; a test holds it against the WGSL.

/// A struct of uniforms: the fields, in their order, with their offsets in bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructLayout {
    /// File below `src/shaders`.
    pub file: &'static str,
    /// Name in the WGSL.
    pub name: &'static str,
    /// Name and offset of each field.
    pub fields: Vec<(&'static str, u64)>,
    /// Size in bytes.
    pub size: u64,
}

/// A constant of a shader file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstantLayout {
    /// File below `src/shaders`.
    pub file: &'static str,
    /// Name in the WGSL.
    pub name: &'static str,
    /// What Rust packs by.
    pub value: u32,
}

/// The [`StructLayout`] of a `ShaderType` whose fields are named in their order; a field left out does not compile.
macro_rules! struct_layout {
    ($type:ident, $file:literal, $name:literal, { $($field:ident),+ $(,)? }) => {{
        // Every field is named.
        let _ = |value: $type| {
            let $type { $($field: _),+ } = value;
        };
        let names = [$(stringify!($field)),+];
        $crate::shaders::StructLayout {
            file: $file,
            name: $name,
            fields: names
                .into_iter()
                .enumerate()
                .map(|(i, name)| {
                    let metadata =
                        <$type as bevy::render::render_resource::ShaderType>::METADATA;
                    (name, metadata.offset(i))
                })
                .collect(),
            size: <$type as bevy::render::render_resource::ShaderType>::min_size().get(),
        }
    }};
}
pub(crate) use struct_layout;
