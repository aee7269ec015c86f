//! Tables of thin layers, computed off the main thread.

use super::pack::{Layers, StackTables, find_stack};
use crate::{anatomy::Feather, maths::scattering::interference::StackTable};
use bevy::{
    prelude::Resource,
    tasks::{AsyncComputeTaskPool, Task, block_on, poll_once},
};

/// Stacks that are computed off the main thread; each once.
#[derive(Resource, Default)]
pub struct StackWork {
    ready: StackTables,
    tasks: Vec<(Layers, Task<StackTable>)>,
}

impl StackWork {
    /// The tables of these feathers, once they are all there; starts what is missing.
    pub fn tables(&mut self, feathers: &[&Feather]) -> Option<StackTables> {
        let ready = &mut self.ready;
        self.tasks.retain_mut(|(layers, task)| {
            let done = block_on(poll_once(task));
            let waiting = done.is_none();
            ready.extend(done.map(|table| (*layers, table)));
            waiting
        });
        let mut out = StackTables::new();
        let mut missing = false;
        for layers in feathers.iter().filter_map(|f| Layers::of(f)) {
            if let Some(table) = find_stack(&self.ready, &layers) {
                if find_stack(&out, &layers).is_none() {
                    out.push((layers, table.clone()));
                }
                continue;
            }
            missing = true;
            if !self.tasks.iter().any(|(known, _)| known.same(&layers)) {
                let pool = AsyncComputeTaskPool::get();
                // Every row on its own.
                let rows: Vec<_> = (0..layers.rows())
                    .map(|i| pool.spawn(async move { layers.row(i) }))
                    .collect();
                let task = pool.spawn(async move {
                    let mut texels = Vec::new();
                    for row in rows {
                        texels.extend(row.await);
                    }
                    layers.joined(texels)
                });
                self.tasks.push((layers, task));
            }
        }
        (!missing).then_some(out)
    }
}
