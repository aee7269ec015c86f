//! Counters in SPIR-V: how often each basic block runs, and of fragments how many 2x2 quads they make up and how many would pass a depth
//! test that is done before them.
//!
//! That test is done by the counters themselves, against an image of depths that every fragment writes in the order of submission; with
//! several samples a pixel a fragment hides what is behind it only where it covers all. The driver's own test goes on: a software renderer may
//! do it, sample by sample, before fragments run (llvmpipe does), and then only what it lets through is counted at all. The
//! picture stays what it was.

use super::spirv::{Costs, Instruction, Module, op};
use std::collections::HashMap;

/// Words of counters; an image of depths and one of feathers, each [`ROW`] pixels wide and high, follow.
pub const COUNTER_WORDS: u32 = 1 << 20;
const ROW: u32 = 2048;
/// Stands for the low and the high word of the counters' address.
const MAGIC: u32 = 0x5eed_c0de;
/// Parts of a quad: its lanes count 12, 6, 4 or 3 each.
pub const QUAD: f64 = 12.0;
/// Blocks below this many slots have no counter.
const LEAST_SLOTS: f64 = 2.0;

/// What a counter counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Counted {
    /// Runs of the entry point.
    Invocations,
    /// Runs of a block; its slots, and the function that it belongs to.
    Block(f64, u32),
    /// Twelfths of quads.
    Quads,
    /// Invocations that pass the depth test before.
    Early,
    /// Twelfths of quads with one of those.
    EarlyQuads,
    /// Of [`Self::Early`] those that are no holes.
    Kept,
    /// Pixels with a fragment that is [`Self::Kept`].
    Pixels,
}

/// A module with counters.
pub struct Instrumented {
    /// SPIR-V with [`MAGIC`] in place of an address.
    pub words: Vec<u32>,
    /// From the number that was given on.
    pub counters: Vec<Counted>,
}

/// What belongs to a fragment stage that is tested.
struct Tested {
    solid: bool,
    marks: bool,
    coord: u32,
    helper: u32,
    mask: Option<u32>,
}

struct Counting {
    module: Module,
    /// Types and constants that were missing.
    made: Vec<Instruction>,
    known: HashMap<Vec<u32>, u32>,
    counters: Vec<Counted>,
    first: u32,
    base: u32,
}

impl Counting {
    /// The type or constant that an instruction without its result makes; `result`: the result's place in it.
    fn find(&mut self, list: &[u32], result: usize) -> u32 {
        if let Some(known) = self.known.get(list) {
            return *known;
        }
        let id = self.find_or_make(list, result);
        self.known.insert(list.to_vec(), id);
        id
    }

    fn find_or_make(&mut self, list: &[u32], result: usize) -> u32 {
        let same = |i: &&Instruction| {
            i.len() == list.len() + 1
                && i[0] == list[0]
                && i[1..result] == list[1..result]
                && i[result + 1..] == list[result..]
        };
        let known = self.module.list.iter().chain(&self.made).find(same);
        if let Some(known) = known {
            return known[result];
        }
        let id = self.module.fresh();
        let mut own = list.to_vec();
        own.insert(result, id);
        self.made.push(own);
        id
    }

    fn ty(&mut self, list: &[u32]) -> u32 {
        self.find(list, 1)
    }

    fn uint(&mut self) -> u32 {
        self.ty(&[op::TYPE_INT, 32, 0])
    }

    fn long(&mut self) -> u32 {
        self.ty(&[op::TYPE_INT, 64, 0])
    }

    fn float(&mut self) -> u32 {
        self.ty(&[op::TYPE_FLOAT, 32])
    }

    fn boolean(&mut self) -> u32 {
        self.ty(&[op::TYPE_BOOL])
    }

    fn number(&mut self, value: u32) -> u32 {
        let ty = self.uint();
        self.find(&[op::CONSTANT, ty, value], 2)
    }

    fn real(&mut self, value: f32) -> u32 {
        let ty = self.float();
        self.find(&[op::CONSTANT, ty, value.to_bits()], 2)
    }

    /// An instruction with a result.
    fn add(&mut self, code: &mut Vec<Instruction>, number: u32, ty: u32, rest: &[u32]) -> u32 {
        let id = self.module.fresh();
        let mut own = vec![number, ty, id];
        own.extend(rest);
        code.push(own);
        id
    }

    /// A pointer to a word behind the base; `offset`: a 64-bit number of bytes.
    fn pointer(&mut self, code: &mut Vec<Instruction>, offset: u32) -> u32 {
        let (long, uint) = (self.long(), self.uint());
        let ty = self.ty(&[op::TYPE_POINTER, op::PHYSICAL, uint]);
        let base = self.base;
        let at = self.add(code, op::I_ADD, long, &[base, offset]);
        self.add(code, op::CONVERT_U_TO_PTR, ty, &[at])
    }

    /// Adds `value` to a new counter.
    fn bump(&mut self, code: &mut Vec<Instruction>, counted: Counted, value: u32) {
        let index = self.first + self.counters.len() as u32;
        self.counters.push(counted);
        let long = self.long();
        let offset = self.find(&[op::CONSTANT, long, 4 * index, 0], 2);
        let pointer = self.pointer(code, offset);
        let (uint, device, relaxed) = (self.uint(), self.number(1), self.number(0));
        self.add(
            code,
            op::ATOMIC_I_ADD,
            uint,
            &[pointer, device, relaxed, value],
        );
    }

    fn part(&mut self, code: &mut Vec<Instruction>, of: u32, index: u32) -> u32 {
        let float = self.float();
        self.add(code, op::COMPOSITE_EXTRACT, float, &[of, index])
    }

    /// Pointers to a pixel's depth and feather, and the bits of the fragment's depth.
    fn pixel(&mut self, code: &mut Vec<Instruction>, coord: u32) -> (u32, u32, u32) {
        let (float, uint, long) = (self.float(), self.uint(), self.long());
        let vector = self.ty(&[op::TYPE_VECTOR, float, 4]);
        let place = self.add(code, op::LOAD, vector, &[coord]);
        let [x, y, z] = [0, 1, 2].map(|index| self.part(code, place, index));
        let [x, y] = [x, y].map(|value| self.add(code, op::CONVERT_F_TO_U, uint, &[value]));
        let row = self.number(ROW);
        let before = self.add(code, op::I_MUL, uint, &[y, row]);
        let pixel = self.add(code, op::I_ADD, uint, &[before, x]);
        let four = self.number(4);
        let bytes = self.add(code, op::I_MUL, uint, &[pixel, four]);
        let [depth, feather] = [COUNTER_WORDS, COUNTER_WORDS + ROW * ROW].map(|first| {
            let first = self.number(4 * first);
            let at = self.add(code, op::I_ADD, uint, &[bytes, first]);
            let at = self.add(code, op::U_CONVERT, long, &[at]);
            self.pointer(code, at)
        });
        let bits = self.add(code, op::BITCAST, uint, &[z]);
        (depth, feather, bits)
    }

    /// Twelfths of the quad that a lane with `flag` stands for.
    fn share_of_quad(&mut self, code: &mut Vec<Instruction>, coord: u32, flag: u32) -> u32 {
        let (float, uint) = (self.float(), self.uint());
        let [one, none] = [1.0, 0.0].map(|value| self.real(value));
        let vector = self.ty(&[op::TYPE_VECTOR, float, 4]);
        let place = self.add(code, op::LOAD, vector, &[coord]);
        let mut sum = self.add(code, op::SELECT, float, &[flag, one, none]);
        for (axis, derivative) in [(0, op::DPDX_FINE), (1, op::DPDY_FINE)] {
            // The neighbor's value is this one's and the difference, forth or back.
            let at = self.part(code, place, axis);
            let at = self.add(code, op::CONVERT_F_TO_U, uint, &[at]);
            let bit = self.number(1);
            let odd = self.add(code, op::BITWISE_AND, uint, &[at, bit]);
            let odd = self.add(code, op::CONVERT_U_TO_F, float, &[odd]);
            let double = self.real(-2.0);
            let back = self.add(code, op::F_MUL, float, &[odd, double]);
            let sign = self.add(code, op::F_ADD, float, &[back, one]);
            let step = self.add(code, derivative, float, &[sum]);
            let step = self.add(code, op::F_MUL, float, &[sign, step]);
            let other = self.add(code, op::F_ADD, float, &[sum, step]);
            sum = self.add(code, op::F_ADD, float, &[sum, other]);
        }
        let (quad, half) = (self.real(QUAD as f32), self.real(0.5));
        let share = self.add(code, op::F_DIV, float, &[quad, sum]);
        let share = self.add(code, op::F_ADD, float, &[share, half]);
        let share = self.add(code, op::SELECT, float, &[flag, share, none]);
        self.add(code, op::CONVERT_F_TO_U, uint, &[share])
    }

    fn count_if(&mut self, code: &mut Vec<Instruction>, counted: Counted, flag: u32) -> u32 {
        let (uint, one, zero) = (self.uint(), self.number(1), self.number(0));
        let value = self.add(code, op::SELECT, uint, &[flag, one, zero]);
        self.bump(code, counted, value);
        value
    }

    /// At the beginning of a tested fragment; whether it passes.
    fn arrive(&mut self, code: &mut Vec<Instruction>, tested: &Tested) -> u32 {
        let (uint, boolean) = (self.uint(), self.boolean());
        let (depth, _, bits) = self.pixel(code, tested.coord);
        // With an alignment of four bytes.
        let nearest = self.add(code, op::LOAD, uint, &[depth, 2, 4]);
        let helper = self.add(code, op::LOAD, boolean, &[tested.helper]);
        let live = self.add(code, op::LOGICAL_NOT, boolean, &[helper]);
        let near = self.add(code, op::U_GREATER_THAN_EQUAL, boolean, &[bits, nearest]);
        let passes = self.add(code, op::LOGICAL_AND, boolean, &[live, near]);
        for (counted, flag) in [(Counted::Quads, live), (Counted::EarlyQuads, passes)] {
            let share = self.share_of_quad(code, tested.coord, flag);
            self.bump(code, counted, share);
        }
        self.count_if(code, Counted::Early, passes);
        passes
    }

    /// At its end, where it has left no hole.
    fn leave(&mut self, code: &mut Vec<Instruction>, tested: &Tested, passes: u32) {
        let (uint, boolean) = (self.uint(), self.boolean());
        let (device, relaxed, zero) = (self.number(1), self.number(0), self.number(0));
        let (depth, feather, bits) = self.pixel(code, tested.coord);
        let one = self.count_if(code, Counted::Kept, passes);
        if tested.marks {
            let before = self.add(code, op::ATOMIC_OR, uint, &[feather, device, relaxed, one]);
            let fresh = self.add(code, op::I_EQUAL, boolean, &[before, zero]);
            let fresh = self.add(code, op::LOGICAL_AND, boolean, &[fresh, passes]);
            self.count_if(code, Counted::Pixels, fresh);
        }
        if !tested.solid {
            return;
        }
        let mut hides = bits;
        if let Some(mask) = tested.mask {
            let pointed = self.pointed(mask);
            let array = self
                .module
                .list
                .iter()
                .find(|i| i[0] == op::TYPE_ARRAY && i[1] == pointed);
            let (element, place) = match array.map(|i| i[2]) {
                Some(element) => {
                    let ty = self.ty(&[op::TYPE_POINTER, op::OUTPUT, element]);
                    let place = self.add(code, op::ACCESS_CHAIN, ty, &[mask, zero]);
                    (element, place)
                }
                None => (pointed, mask),
            };
            let mut value = self.add(code, op::LOAD, element, &[place]);
            if element != uint {
                value = self.add(code, op::BITCAST, uint, &[value]);
            }
            let all = self.number(15);
            let covered = self.add(code, op::BITWISE_AND, uint, &[value, all]);
            let whole = self.add(code, op::I_EQUAL, boolean, &[covered, all]);
            hides = self.add(code, op::SELECT, uint, &[whole, bits, zero]);
        }
        self.add(
            code,
            op::ATOMIC_U_MAX,
            uint,
            &[depth, device, relaxed, hides],
        );
    }

    /// Type of what a variable holds.
    fn pointed(&self, variable: u32) -> u32 {
        let list = &self.module.list;
        let made = list
            .iter()
            .find(|i| i[0] == op::VARIABLE && i[2] == variable);
        let pointer = made.map_or(0, |i| i[1]);
        let ty = list
            .iter()
            .find(|i| i[0] == op::TYPE_POINTER && i[1] == pointer);
        ty.map_or(0, |i| i[3])
    }
}

/// Variables with a decoration `kind` of `value` in a storage class.
fn decorated(module: &Module, kind: u32, value: u32, storage: u32) -> Option<u32> {
    let decorations = module
        .list
        .iter()
        .filter(|i| i[0] == op::DECORATE && i.len() > 3);
    let mut own = decorations
        .filter(|i| i[2] == kind && i[3] == value)
        .map(|i| i[1]);
    own.find(|id| {
        let mut variables = module.list.iter().filter(|i| i[0] == op::VARIABLE);
        variables.any(|i| i[2] == *id && i[3] == storage)
    })
}

/// Puts counters from the number `first` on into a module. `tested`: its fragments are tested, and hide others if they are `solid`.
/// `marks`: they mark their pixels, for [`Counted::Pixels`].
pub fn instrument(
    words: &[u32],
    first: u32,
    [tested, solid, marks]: [bool; 3],
) -> Option<Instrumented> {
    const BUILT_IN: u32 = 11;
    const FRAG_COORD: u32 = 15;
    const SAMPLE_MASK: u32 = 20;
    const HELPER: u32 = 23;
    let module = Module::new(words)?;
    let costs = Costs::new(&module);
    let entry = module.list.iter().find(|i| i[0] == op::ENTRY_POINT)?[2];
    let coord = decorated(&module, BUILT_IN, FRAG_COORD, op::INPUT).filter(|_| tested);
    let mask = decorated(&module, BUILT_IN, SAMPLE_MASK, op::OUTPUT);
    let mut own = Counting {
        module,
        made: Vec::new(),
        known: HashMap::new(),
        counters: Vec::new(),
        first,
        base: 0,
    };
    let long = own.long();
    own.base = own.find(&[op::CONSTANT, long, MAGIC, MAGIC], 2);
    let tested = coord.map(|coord| {
        let boolean = own.boolean();
        let ty = own.ty(&[op::TYPE_POINTER, op::INPUT, boolean]);
        let helper = own.module.fresh();
        own.made.push(vec![op::VARIABLE, ty, helper, op::INPUT]);
        Tested {
            solid,
            marks,
            coord,
            helper,
            mask,
        }
    });
    let start = own.module.list.iter().position(|i| i[0] == op::FUNCTION)?;
    let body = own.module.list.split_off(start);
    // Slots of each block come before its code.
    let mut slots = HashMap::new();
    let mut label = 0;
    for i in &body {
        if i[0] == op::LABEL {
            label = i[1];
        }
        *slots.entry(label).or_insert(0.0) += costs.slots(i);
    }
    let (mut code, mut function, mut blocks) = (Vec::new(), 0, 0);
    let mut pending = false;
    let mut passes = 0;
    for i in body {
        match i[0] {
            op::FUNCTION => (function, blocks) = (i[2], 0),
            op::LABEL => (label, pending) = (i[1], true),
            // Phis and variables come first in a block.
            op::PHI | op::VARIABLE => {}
            _ if pending => {
                pending = false;
                let begins = function == entry && blocks == 0;
                blocks += 1;
                let one = own.number(1);
                if begins {
                    own.bump(&mut code, Counted::Invocations, one);
                    if let Some(tested) = &tested {
                        passes = own.arrive(&mut code, tested);
                    }
                }
                if slots[&label] >= LEAST_SLOTS {
                    own.bump(&mut code, Counted::Block(slots[&label], function), one);
                }
            }
            _ => {}
        }
        if i[0] == op::RETURN
            && function == entry
            && let Some(tested) = &tested
        {
            own.leave(&mut code, tested, passes);
        }
        code.push(i);
    }
    // In front: capabilities, the extension, 64-bit pointers, the helper among the interface.
    const PHYSICAL_POINTERS: u32 = 5347;
    const LONG: u32 = 11;
    const FINE_DERIVATIVES: u32 = 51;
    let mut list = Vec::new();
    for capability in [PHYSICAL_POINTERS, LONG, FINE_DERIVATIVES] {
        let known = own
            .module
            .list
            .iter()
            .any(|i| i[..] == [op::CAPABILITY, capability]);
        if !known && (capability != FINE_DERIVATIVES || tested.is_some()) {
            list.push(vec![op::CAPABILITY, capability]);
        }
    }
    let mut extended = false;
    for mut i in std::mem::take(&mut own.module.list) {
        if !extended && matches!(i[0], op::EXT_INST_IMPORT | op::MEMORY_MODEL) {
            let name = b"SPV_KHR_physical_storage_buffer\0";
            let words = name
                .as_chunks::<4>()
                .0
                .iter()
                .map(|c| u32::from_le_bytes(*c));
            list.push([op::EXTENSION].into_iter().chain(words).collect());
            extended = true;
        }
        match (i[0], &tested) {
            (op::MEMORY_MODEL, _) => i[1] = 5348,
            (op::ENTRY_POINT, Some(tested)) => i.push(tested.helper),
            _ => {}
        }
        list.push(i);
    }
    if let Some(tested) = &tested {
        let at = list
            .iter()
            .position(|i| op::TYPES.contains(&i[0]) && i[0] < 34)?;
        list.insert(at, vec![op::DECORATE, tested.helper, BUILT_IN, HELPER]);
    }
    list.extend(own.made);
    list.extend(code);
    own.module.list = list;
    Some(Instrumented {
        words: own.module.words(),
        counters: own.counters,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_of_a_fragment() {
        let text = "@group(0) @binding(0) var<uniform> light: vec4<f32>;
            @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
                if (at.x > 8.0) { discard; }
                var sum = vec4(0.0);
                for (var i = 0u; i < 3u; i++) { sum += sqrt(light) * f32(i); }
                return sum;
            }";
        let module = naga::front::wgsl::parse_str(text).unwrap();
        let all = naga::valid::Capabilities::all();
        let info = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), all)
            .validate(&module)
            .unwrap();
        let options = naga::back::spv::Options::default();
        let words = naga::back::spv::write_vec(&module, &info, &options, None).unwrap();
        let tested = instrument(&words, 7, [true; 3]).unwrap();
        let many = |of: Counted| tested.counters.iter().filter(|c| **c == of).count();
        for once in [
            Counted::Invocations,
            Counted::Quads,
            Counted::Early,
            Counted::EarlyQuads,
        ] {
            assert_eq!(many(once), 1, "{once:?}");
        }
        // The function has one return.
        assert_eq!((many(Counted::Kept), many(Counted::Pixels)), (1, 1));
        // Four roots, a number and a multiplication and addition of each component, in the loop.
        let dearest = tested.counters.iter().map(|counted| match counted {
            Counted::Block(slots, _) => *slots,
            _ => 0.0,
        });
        assert!(dearest.fold(0.0, f64::max) >= 16.0);
        let adds = |words: &[u32]| {
            let list = Module::new(words).unwrap().list;
            list.iter().filter(|i| i[0] == op::ATOMIC_I_ADD).count()
        };
        assert_eq!(adds(&tested.words), tested.counters.len());
        let untested = instrument(&words, 0, [false; 3]).unwrap();
        assert_eq!(adds(&untested.words), untested.counters.len());
        assert!(untested.counters.len() + 5 == tested.counters.len());
    }
}
