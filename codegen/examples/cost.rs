//! Operations and times of the derivation of specs: `cost SPEC...`
use appell_codegen::compile;
use appell_codegen::program::FunctionKind as F;
use appell_codegen::schedule;
use std::time::Instant;
fn main() {
    let kinds_of = |s: &str| match s {
        "m" => F::MassMatrix,
        "mh" => F::MassMatrixAndBias,
        "r" => F::Rates,
        "j" => F::Jacobians,
        "p" => F::ParameterJacobian,
        "f" => F::GeneralizedForces,
        "b" => F::Bias,
        _ => panic!(),
    };
    let args: Vec<String> = std::env::args().skip(1).collect();
    let kinds: Vec<F> = args[0].split(',').map(kinds_of).collect();
    for path in &args[1..] {
        let text = std::fs::read_to_string(path).unwrap();
        let t0 = Instant::now();
        let d = match compile::derived(path, &text) {
            Ok(d) => d,
            Err(e) => {
                println!("{path}: {e}");
                continue;
            }
        };
        let t1 = t0.elapsed().as_secs_f64();
        let p = match d.program(&text, &kinds) {
            Ok(d) => d,
            Err(e) => {
                println!("{path}: {e}");
                continue;
            }
        };
        let t2 = t0.elapsed().as_secs_f64();
        print!(
            "{:24} derive {:.3} program {:.3} nodes {} |",
            path.rsplit('/').next().unwrap(),
            t1,
            t2 - t1,
            p.graph.len()
        );
        for f in &p.functions {
            let t = Instant::now();
            let s = schedule::schedule(&p, f);
            let c = schedule::OperationCount::of(&s);
            print!(
                " {:?} {} ({} div) {:.3}s |",
                f.kind,
                c.total(),
                c.divide,
                t.elapsed().as_secs_f64()
            );
        }
        println!();
    }
}
