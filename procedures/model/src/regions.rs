//! The worst regions of the residual maps, in the columns and words of the run.

use crate::prepare::Prepared;
use crate::report::Region;
use crate::select::{MapFinding, Maps};
use crate::words::figure;

/// More regions than these nobody reads.
const MOST: usize = 8;

pub fn regions(prepared: &Prepared, maps: &Maps) -> Vec<Region> {
    maps.findings.iter().take(MOST).map(|f| region(prepared, f)).collect()
}

fn region(prepared: &Prepared, f: &MapFinding) -> Region {
    let scale = prepared.column_scale(f.axis);
    let (axis, unit) = (prepared.column_name(f.axis), prepared.column_unit(f.axis));
    let (from, to) = (f.from * scale, f.to * scale);
    let direction = f.direction.map(|d| if d > 0.0 { "positive" } else { "negative" });
    let side = if f.mean > 0.0 { "low" } else { "high" };
    let motion = direction.map_or_else(String::new, |d| format!(", {d} motion"));
    let sentence = format!(
        "the model is {} too {side} where {} is between {} and {}{motion}",
        figure(f.mean.abs(), &prepared.unit()),
        axis.trim_end_matches(&format!("_{}", suffix(axis))).replace('_', " "),
        figure(from, &unit),
        figure(to, &unit),
    );
    Region {
        axis: axis.into(),
        from,
        to,
        mean_residual: f.mean,
        ci95: [f.mean - f.half_width, f.mean + f.half_width],
        samples: f.rows,
        direction: direction.map(Into::into),
        sentence,
    }
}

fn suffix(column: &str) -> &str {
    ["rad_s2", "rad_s3", "rad_s", "rad", "nm", "s", "c", "a"]
        .into_iter()
        .find(|s| column.ends_with(&format!("_{s}")))
        .unwrap_or_default()
}
