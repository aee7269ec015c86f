//! SPIR-V as instructions, and what one of them costs.

use std::collections::HashMap;

/// Numbers of instructions and storage classes, for patterns.
pub mod op {
    use spirv::{Op, StorageClass};

    pub const NAME: u32 = Op::Name as u32;
    pub const EXTENSION: u32 = Op::Extension as u32;
    pub const EXT_INST_IMPORT: u32 = Op::ExtInstImport as u32;
    pub const EXT_INST: u32 = Op::ExtInst as u32;
    pub const MEMORY_MODEL: u32 = Op::MemoryModel as u32;
    pub const ENTRY_POINT: u32 = Op::EntryPoint as u32;
    pub const CAPABILITY: u32 = Op::Capability as u32;
    pub const TYPE_BOOL: u32 = Op::TypeBool as u32;
    pub const TYPE_INT: u32 = Op::TypeInt as u32;
    pub const TYPE_FLOAT: u32 = Op::TypeFloat as u32;
    pub const TYPE_VECTOR: u32 = Op::TypeVector as u32;
    pub const TYPE_MATRIX: u32 = Op::TypeMatrix as u32;
    pub const TYPE_ARRAY: u32 = Op::TypeArray as u32;
    pub const TYPE_POINTER: u32 = Op::TypePointer as u32;
    pub const CONSTANT: u32 = Op::Constant as u32;
    pub const FUNCTION: u32 = Op::Function as u32;
    pub const VARIABLE: u32 = Op::Variable as u32;
    pub const LOAD: u32 = Op::Load as u32;
    pub const ACCESS_CHAIN: u32 = Op::AccessChain as u32;
    pub const DECORATE: u32 = Op::Decorate as u32;
    pub const COMPOSITE_EXTRACT: u32 = Op::CompositeExtract as u32;
    pub const CONVERT_F_TO_U: u32 = Op::ConvertFToU as u32;
    pub const CONVERT_U_TO_F: u32 = Op::ConvertUToF as u32;
    pub const U_CONVERT: u32 = Op::UConvert as u32;
    pub const CONVERT_U_TO_PTR: u32 = Op::ConvertUToPtr as u32;
    pub const BITCAST: u32 = Op::Bitcast as u32;
    pub const I_ADD: u32 = Op::IAdd as u32;
    pub const F_ADD: u32 = Op::FAdd as u32;
    pub const I_MUL: u32 = Op::IMul as u32;
    pub const F_MUL: u32 = Op::FMul as u32;
    pub const F_DIV: u32 = Op::FDiv as u32;
    pub const LOGICAL_AND: u32 = Op::LogicalAnd as u32;
    pub const LOGICAL_NOT: u32 = Op::LogicalNot as u32;
    pub const SELECT: u32 = Op::Select as u32;
    pub const I_EQUAL: u32 = Op::IEqual as u32;
    pub const U_GREATER_THAN_EQUAL: u32 = Op::UGreaterThanEqual as u32;
    pub const BITWISE_AND: u32 = Op::BitwiseAnd as u32;
    pub const DPDX_FINE: u32 = Op::DPdxFine as u32;
    pub const DPDY_FINE: u32 = Op::DPdyFine as u32;
    pub const ATOMIC_I_ADD: u32 = Op::AtomicIAdd as u32;
    pub const ATOMIC_U_MAX: u32 = Op::AtomicUMax as u32;
    pub const ATOMIC_OR: u32 = Op::AtomicOr as u32;
    pub const PHI: u32 = Op::Phi as u32;
    pub const LABEL: u32 = Op::Label as u32;

    pub const KILL: u32 = Op::Kill as u32;
    pub const RETURN: u32 = Op::Return as u32;
    pub const DEMOTE: u32 = Op::DemoteToHelperInvocation as u32;
    /// Types.
    pub const TYPES: std::ops::RangeInclusive<u32> = 19..=39;
    pub const INPUT: u32 = StorageClass::Input as u32;
    pub const OUTPUT: u32 = StorageClass::Output as u32;
    pub const PHYSICAL: u32 = StorageClass::PhysicalStorageBuffer as u32;
}

/// One instruction: its number, then its words.
pub type Instruction = Vec<u32>;

/// A module.
pub struct Module {
    header: [u32; 5],
    /// In their order.
    pub list: Vec<Instruction>,
}

impl Module {
    /// Reads words.
    pub fn new(words: &[u32]) -> Option<Self> {
        let header = words.get(..5)?.try_into().ok()?;
        let (mut list, mut at) = (Vec::new(), 5);
        while at < words.len() {
            let count = (words[at] >> 16) as usize;
            let mut instruction = words.get(at..at + count.max(1))?.to_vec();
            instruction[0] &= 0xffff;
            at += instruction.len();
            list.push(instruction);
        }
        Some(Self { header, list })
    }

    /// Writes words.
    pub fn words(&self) -> Vec<u32> {
        let mut words = self.header.to_vec();
        // Of the first version with what counters need.
        words[1] = words[1].max(0x0001_0300);
        for instruction in &self.list {
            words.push((instruction.len() as u32) << 16 | instruction[0]);
            words.extend(&instruction[1..]);
        }
        words
    }

    /// A number that nothing has yet.
    pub fn fresh(&mut self) -> u32 {
        self.header[3] += 1;
        self.header[3] - 1
    }

    /// Names by what they name.
    pub fn names(&self) -> HashMap<u32, String> {
        let names = self.list.iter().filter(|i| i[0] == op::NAME);
        names.map(|i| (i[1], text(&i[2..]))).collect()
    }
}

fn text(words: &[u32]) -> String {
    let bytes = words.iter().flat_map(|word| word.to_le_bytes());
    let bytes: Vec<u8> = bytes.take_while(|byte| *byte != 0).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// What instructions cost.
pub struct Costs {
    types: HashMap<u32, Instruction>,
    /// Type of every result.
    results: HashMap<u32, u32>,
    /// Whether a pointer leads to memory.
    memory: HashMap<u32, u32>,
    library: u32,
}

impl Costs {
    /// Looks through a module.
    pub fn new(module: &Module) -> Self {
        let mut own = Self {
            types: HashMap::new(),
            results: HashMap::new(),
            memory: HashMap::new(),
            library: 0,
        };
        for i in &module.list {
            match i[0] {
                op::EXT_INST_IMPORT => own.library = i[1],
                number if op::TYPES.contains(&number) => {
                    own.types.insert(i[1], i.clone());
                }
                // No results: names, entries, decorations, stores, merges and branches.
                op::NAME
                | 6
                | 15
                | 16
                | op::CAPABILITY
                | 62
                | 63
                | op::DECORATE
                | 72
                | 246..=255 => {}
                number if number >= op::EXT_INST && i.len() > 2 => {
                    own.results.insert(i[2], i[1]);
                    if number == op::VARIABLE {
                        own.memory.insert(i[2], i[3]);
                    } else if number == op::ACCESS_CHAIN || number == op::ACCESS_CHAIN + 1 {
                        let root = own.memory.get(&i[3]).copied().unwrap_or_default();
                        own.memory.insert(i[2], root);
                    }
                }
                _ => {}
            }
        }
        own
    }

    fn components(&self, ty: u32) -> f64 {
        match self.types.get(&ty) {
            Some(i) if i[0] == op::TYPE_VECTOR => f64::from(i[3]),
            Some(i) if i[0] == op::TYPE_MATRIX => f64::from(i[3]) * self.components(i[2]),
            _ => 1.0,
        }
    }

    fn components_of(&self, value: u32) -> f64 {
        self.components(self.results.get(&value).copied().unwrap_or_default())
    }

    /// Issue slots of one lane, as a GPU has them: 1 for an operation on a component, 4 for a transcendental. What compilers fold (moves,
    /// signs, parts of a multiplication and an addition) counts for less.
    pub fn slots(&self, i: &Instruction) -> f64 {
        let own = || self.components(i[1]);
        match i[0] {
            126 => 0.25 * own(),
            op::F_ADD | 131 | op::F_MUL | 142 => 0.8 * own(),
            op::I_MUL => 4.0 * own(),
            134 | 135 | 137..=139 => 30.0 * own(),
            op::F_DIV => 5.0 * own(),
            140 | 141 => 7.0 * own(),
            109..=114 | op::I_ADD | 130 | op::SELECT | 194..=204 => own(),
            164..=168 => 0.5 * own(),
            205 => 2.0 * own(),
            170..=191 => self.components_of(i[3]),
            143 => own(),
            144 => self.components_of(i[4]),
            145 => self.components_of(i[3]),
            146 => 64.0,
            148 => self.components_of(i[3]),
            op::EXT_INST if i[3] == self.library => self.library_slots(i),
            77 | 78 => 2.0,
            87..=98 => 1.0,
            207..=215 => 2.0 * own(),
            227..=242 => 1.0,
            250 => 1.5,
            251 => (i.len() - 3) as f64,
            _ => 0.0,
        }
    }

    /// Of a function of GLSL.std.450.
    fn library_slots(&self, i: &Instruction) -> f64 {
        let count = self.components(i[1]);
        let first = i.get(5).map_or(1.0, |value| self.components_of(*value));
        match i[4] {
            4 => 0.0,
            6 | 46 | 73..=75 => 2.0 * count,
            13 | 14 | 27 | 28 => 5.0 * count,
            15 => 12.0 * count,
            16 | 17 | 21 => 16.0 * count,
            18 => 20.0 * count,
            25 => 26.0 * count,
            26 | 49 => 9.0 * count,
            29..=32 => 4.0 * count,
            54..=65 => 4.0,
            66 | 67 => first + 4.0,
            68 => 6.0,
            69 => 2.0 * first + 4.0,
            71 => 3.0 * count,
            72 => 4.0 * count + 4.0,
            _ => count,
        }
    }
}
