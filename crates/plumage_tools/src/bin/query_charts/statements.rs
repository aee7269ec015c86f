//! The statements that the charts have to bear out, in figures of one run.

use crate::{
    charts::Cost,
    measure::{Measured, Part},
    methods::{Family, SWITCH},
};
use bevy_plumage::maths::query::Evaluator;

/// Cost at which a family reaches an error in a part: between its settings along a straight line in logarithms. The dearest
/// setting's cost and `false` where none reaches it.
fn cost_at(
    measured: &Measured,
    family: Family,
    part: Part,
    cost: Cost,
    error: f64,
) -> Option<(f64, bool)> {
    let mut curve: Vec<(f64, f64)> = measured
        .methods
        .iter()
        .enumerate()
        .filter(|(_, m)| m.family == family)
        .filter_map(|(i, _)| {
            let row = measured.row(i, part)?;
            Some((cost.of(&row)?, row.error[0]))
        })
        .collect();
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    let first = *curve.first()?;
    if first.1 <= error {
        return Some((first.0, true));
    }
    for pair in curve.windows(2) {
        let [(c0, e0), (c1, e1)] = [pair[0], pair[1]];
        if e1 <= error && e0 > error {
            let t = (e0 / error).ln() / (e0 / e1).ln();
            return Some((c0 * (c1 / c0).powf(t), true));
        }
    }
    curve.last().map(|p| (p.0, false))
}

fn verdict(holds: bool) -> &'static str {
    if holds { "holds" } else { "MISSED" }
}

/// One line per statement.
pub fn statements(measured: &Measured) -> Vec<String> {
    let mut lines = Vec::new();
    for cost in [Cost::Cpu, Cost::Gpu] {
        let name = match cost {
            Cost::Cpu => "CPU",
            Cost::Gpu => "GPU",
        };
        let forced = |kind: Evaluator| -> Vec<(f64, f64, &str)> {
            let alone = measured.methods.iter().enumerate();
            alone
                .filter(|(_, m)| m.family == Family::Forced(kind))
                .filter_map(|(i, m)| {
                    let row = measured.row(i, Part::Kind(kind))?;
                    Some((cost.of(&row)?, row.error[0], m.setting.as_str()))
                })
                .collect()
        };
        // The finest setting of NEAR whose error the published method reaches at all; the coarsest if it reaches none.
        let near_part = Part::Kind(Evaluator::Near);
        let equal = |error: f64| cost_at(measured, Family::Spatial, near_part, cost, error);
        let settings = forced(Evaluator::Near);
        let reachable = |s: &&(f64, f64, &str)| equal(s.1).is_some_and(|c| c.1);
        let Some(&(near, error, setting)) = settings.iter().rfind(reachable).or(settings.first())
        else {
            continue;
        };
        let Some((spatial, reached)) = equal(error) else {
            continue;
        };
        let at_least = if reached { "" } else { "more than " };
        lines.push(format!(
            "{name}: NEAR at {setting} costs {near:.0} ns, the published spatial method {at_least}{spatial:.0} ns at the same RMS error \
             {error:.5}: a {:.1}th (at most an 8th: {})",
            spatial / near,
            verdict(near * 8.0 <= spatial)
        ));
        if let Some(&(stripe, error, _)) = forced(Evaluator::Stripe).first() {
            let own = cost_at(
                measured,
                Family::Spatial,
                Part::Kind(Evaluator::Stripe),
                cost,
                error,
            );
            let own = own.map_or_else(String::new, |(c, reached)| {
                let at_least = if reached { "" } else { "less than " };
                format!(
                    "; {at_least}{:.3} % of it on STRIPE's own footprints",
                    100.0 * stripe / c
                )
            });
            lines.push(format!(
                "{name}: STRIPE costs {stripe:.1} ns, {:.2} % of the published spatial method on NEAR's footprints{own} (at \
                 most 5 %: {})",
                100.0 * stripe / spatial,
                verdict(stripe <= 0.05 * spatial)
            ));
        }
        if let (Some(&(mean, _, _)), Some(texture)) =
            (forced(Evaluator::Mean).first(), measured.texture)
            && cost == Cost::Gpu
        {
            lines.push(format!(
                "GPU: MEAN costs {mean:.2} ns, a trilinear texture fetch {texture:.2} ns (less: {})",
                verdict(mean < texture)
            ));
        }
        let chosen = measured.find(Family::Chosen, crate::methods::DEFAULT);
        let switch = measured.find(Family::Switch, SWITCH);
        if let (Some(chosen), Some(switch)) = (chosen, switch)
            && let (Some(a), Some(b)) = (
                measured.row(chosen, Part::All),
                measured.row(switch, Part::All),
            )
            && let (Some(ours), Some(theirs)) = (cost.of(&a), cost.of(&b))
        {
            lines.push(format!(
                "{name}: the sweep's mix costs {ours:.0} ns as chosen, RMS error {:.5}; {theirs:.0} ns with the published hard \
                 switch ({SWITCH}), RMS error {:.5}",
                a.error[0], b.error[0]
            ));
        }
    }
    lines
}
