use gonio::{axis::*, bake::*, check::*, gpu::*, models, plan::*, quantity::*};
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let t: f64 = std::env::args().nth(2).unwrap().parse().unwrap();
    let (gpu, _) = Evaluator::choose(&DeviceChoice::Auto).unwrap();
    let axes = vec![Axis::natural(Variable::Roughness, n).unwrap(), Axis::natural(Variable::Mu, n).unwrap()];
    let p = TablePlan::basis("dfg", &SPLIT_SUM, models::find("ggx").unwrap(), None, axes)
        .unwrap()
        .with_tolerance(t);
    let mut best = vec![];
    for k in 0..15 {
        let mut st = Stages::default();
        let table = gpu
            .bake(&p, if k == 0 { Check::Sample(1000) } else { Check::Sample(0) }, &mut st, &Unobserved)
            .unwrap();
        if k == 0 {
            println!("{:?} {:?}", table.error.measured_max, table.error.worst);
            continue;
        }
        best.push((st.dispatch, st.compile));
    }
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    println!(
        "dispatch min {:.2} ms median {:.2} ms; prepare {:.2} ms",
        1e3 * best[0].0,
        1e3 * best[7].0,
        1e3 * best[7].1
    );
}
