use gonio::{axis::*, bake::*, check::*, gpu::*, models, plan::*, quantity::*};
fn main() {
    let (gpu, line) = Evaluator::choose(&DeviceChoice::Auto).unwrap();
    println!("{line}");
    let cpu = Evaluator::Cpu;
    let r = || Axis::new(Variable::Roughness, 33, [0.0, 1.0], Positions::Nodes, Mapping::Linear).unwrap();
    let rv = || Axis::listed(Variable::Roughness, vec![0.001, 0.01, 0.1, 0.3, 0.7, 1.0]).unwrap();
    let th = |v, n| Axis::natural(v, n).unwrap();
    let mut plans = vec![];
    for m in models::MODELS {
        let rough = |r: Axis| if m.has_roughness { vec![r] } else { vec![] };
        let cat = |mut a: Vec<Axis>, b: Vec<Axis>| { a.extend(b); a };
        plans.push(TablePlan::basis(format!("{}.split", m.name), &SPLIT_SUM, m, None, cat(rough(r()), vec![th(Variable::Mu, 64)])));
        plans.push(TablePlan::basis(format!("{}.split mu 1e-3 nodes", m.name), &SPLIT_SUM, m, None, cat(rough(r()), vec![Axis::new(Variable::Mu, 33, [1e-3,1.0], Positions::Nodes, Mapping::Linear).unwrap()])));
        plans.push(TablePlan::basis(format!("{}.rho_dh", m.name), &RHO_DH, m, None, cat(rough(r()), vec![th(Variable::ThetaI, 33)])));
        plans.push(TablePlan::basis(format!("{}.rho_hh", m.name), &RHO_HH, m, None, rough(r())));
        plans.push(TablePlan::basis(format!("{}.brdf", m.name), &BRDF, m, None, cat(rough(rv()), vec![th(Variable::ThetaI, 33), th(Variable::ThetaE, 65), th(Variable::DeltaPhi, 65)])));
    }
    for p in plans {
        let p = match p { Ok(p) => p, Err(e) => { println!("refused: {e}"); continue } };
        for (n, e) in [("gpu", &gpu), ("cpu", &cpu)] {
            let mut st = Stages::default();
            match e.bake(&p, Check::Sample(2000), &mut st, &Unobserved) {
                Ok(t) => println!("{n} {:28} {:?} rms {:?} n {} {:.3}s check {:.3}s {:?}", p.name, t.error.measured_max, t.error.measured_rms, t.error.texels_checked, t.seconds, st.check, t.error.worst),
                Err(e) => println!("{n} {}: {e}", p.name),
            }
        }
    }
}
