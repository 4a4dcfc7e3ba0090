//! `dacrt nodes`: the nodes of one trace as a table, and what can be said of them in a few lines.

use super::Verdict;
use super::args::NodesArgs;
use super::plan::{self, check_writable};
use super::run::{Answers, make_rays};
use super::source::{SceneSource, Views, mesh_folders};
use super::text::{columns, counted, print, thousands};
use anyhow::{Context, ensure};
use dacrt::Method;
use dacrt::workloads::Workload;
use dacrt_validate::nodes::{Format, Regime, Row, write};

/// Traces once as always and once with a log, and writes the log.
pub fn nodes(args: &NodesArgs) -> anyhow::Result<Verdict> {
    let method = plan::method(&args.method)?;
    ensure!(
        [Method::Afra2012, Method::Nabata2013].contains(&method),
        "--method {method}: only afra2012 and nabata2013 split by what is written down here"
    );
    let parameters = args.knobs.single(method)?;
    let precision = plan::precision(&args.precision)?;
    let choice = plan::engine(&args.engine)?;
    let rays = plan::ray_type(&args.rays)?;
    let film = plan::film(args.resolution, args.spp)?;
    Format::of(&args.out).context("--out")?;
    check_writable(&args.out).context("--out")?;
    let source = SceneSource::find(&args.scene)?;
    if let Some(camera) = &args.camera {
        source.cameras(std::slice::from_ref(camera))?;
    }
    source.allows(args.camera.as_deref(), rays)?;

    let mesh = source.mesh(&mesh_folders(&args.meshes))?;
    let view = Views::new(&source, &mesh).of(args.camera.as_deref())?;
    let mut workload = Workload::new(&mesh, view, film, choice.seed)?;
    let batch = make_rays(&mut workload, rays, &mesh)?;
    let tracer = choice.tracer(parameters, precision);
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    let mut usual = Answers::room(batch.len(), rays.is_any_hit());
    let trace = usual.trace(&tracer, &mesh, &batch, &mut workspace);
    let mut answers = Answers::room(batch.len(), rays.is_any_hit());
    let (logged, records) = answers.log(&tracer, &mesh, &batch, &mut workspace);
    let rows: Vec<Row> = records.iter().map(Row::of).collect();
    write(&args.out, &rows)?;

    let mut text = format!(
        "{} {rays} by {method}: {}, {}, {}\n\n",
        source.name(),
        counted(batch.len() as u64, "ray"),
        counted(mesh.len() as u64, "triangle"),
        counted(rows.len() as u64, "node")
    );
    text += &summary(&rows);
    text += &format!("\nnodes: {}\n", args.out.display());
    let is_same = logged == trace && answers.differing(&usual) == 0;
    if !is_same {
        text += "FINDING: the trace with a log gave other hits or counters than the one without\n";
    }
    print(&text)?;
    Ok(match is_same {
        true => Verdict::Good,
        false => Verdict::Finding,
    })
}

/// What the rules cost and give, and how good the estimates are.
fn summary(rows: &[Row]) -> String {
    let head = [
        "",
        "nodes",
        "box tests",
        "of samples",
        "regret",
        "of area",
        "rays a node",
    ];
    let mut table = vec![head.map(str::to_owned).to_vec()];
    for regime in Regime::ALL {
        let of: Vec<&Row> = rows.iter().filter(|row| row.regime == regime).collect();
        if of.is_empty() {
            continue;
        }
        let sum = |f: &dyn Fn(&Row) -> f64| of.iter().map(|row| f(row)).sum::<f64>();
        let tests = sum(&|row| row.box_tests() as f64);
        let samples = sum(&|row| row.sample_box.unwrap_or(0) as f64);
        let least = sum(&|row| row.least_cost.unwrap_or(0) as f64);
        // Each node counts by what it costs.
        let regret = |cost: &dyn Fn(&Row) -> Option<u64>| {
            let costs = sum(&|row| cost(row).unwrap_or(0) as f64);
            match least > 0.0 {
                true => format!("{:.3}", costs / least),
                false => "-".to_owned(),
            }
        };
        table.push(vec![
            regime.name().to_owned(),
            thousands(of.len() as u64),
            thousands(tests as u64),
            match tests > 0.0 {
                true => format!("{:.1} %", 100.0 * samples / tests),
                false => "-".to_owned(),
            },
            regret(&|row| row.cost),
            regret(&|row| row.cost_by_area),
            format!("{:.0}", sum(&|row| f64::from(row.rays)) / of.len() as f64),
        ]);
    }
    let mut text = columns(&table, &[1, 2, 3, 4, 5, 6]);
    text += "\nregret: pairs of a ray and a triangle in the children over those of the split that is best by\n\
             all rays; of area: of that of the surface area heuristic.\n";
    let children: Vec<(f32, f32, bool)> = rows.iter().filter_map(Row::children).flatten().collect();
    if !children.is_empty() {
        let n = children.len() as f64;
        let error = |f: &dyn Fn(f64) -> f64| {
            let errors = children
                .iter()
                .map(|(estimated, ratio, _)| f64::from(estimated - ratio));
            errors.map(f).sum::<f64>() / n
        };
        let skipped = children.iter().filter(|(.., skipped)| *skipped).count();
        text += &format!(
            "\nratios of {} by samples: too small by {:.4} in the mean, {:.4} off (root mean square);\n\
             {} skipped\n",
            counted(children.len() as u64, "child").replace("childs", "children"),
            -error(&|e| e),
            error(&|e| e * e).sqrt(),
            thousands(skipped as u64)
        );
    }
    text
}
