//! The polynomials of the interface.

use super::*;

/// The numbers of a uniform as the shader finds them in memory.
pub fn words<T: ShaderType + WriteInto>(uniform: &T) -> Vec<f32> {
    let mut buffer = StorageBuffer::new(Vec::new());
    buffer.write(uniform).expect("a Vec grows");
    buffer
        .into_inner()
        .chunks_exact(4)
        .map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]]))
        .collect()
}

/// What the terms of a polynomial add up to before they cancel, times the rounding of each.
fn polynomial_rounding(coefficients: &[f64], mu: f64) -> f64 {
    let terms = coefficients.iter().enumerate();
    let sum: f64 = terms.map(|(k, c)| c.abs() * mu.sqrt().powi(k as i32)).sum();
    sum * UNIT_PRODUCT
}

/// Roughness beyond what is fitted too.
fn fit_roots() -> Twins {
    let cases = [-1.0, 0.0, 1.5, 9.0].into_iter().chain(alphas());
    Twins {
        name: "fit_root",
        body: "found[to] = fit_root(given[at]);".into(),
        twin: |x| vec![fit_root(x[0])],
        relative: |_| RELATIVE,
        cases: cases.map(|alpha| vec![alpha]).collect(),
    }
}

pub fn compare_interfaces(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    let mut worst = fit_roots().compare(gpu, physics)?;
    let mut rows: Vec<(String, InterfaceRow)> = Vec::new();
    for (index, specular) in [(1.0, 1.0), (1.5, 1.0), (1.5, 0.3), (3.0, 1.0)] {
        let name = format!("interface of index {index}, specular {specular}");
        let table = InterfaceTable::new(index, specular);
        for alpha in alphas().into_iter().map(f64::from) {
            rows.push((format!("{name}, fitted, α {alpha}"), table.row(alpha)));
        }
        for alpha in [0.0, 0.01, 0.5] {
            let here = InterfaceTable::at_roughness(alpha, index, specular);
            rows.push((format!("{name}, α {alpha}"), here.row(alpha)));
        }
    }
    let mut cosines = cosines();
    cosines.extend([0.0, 0.25, 0.9999]);
    let cases = grid(&[cosines]);
    for (name, row) in &rows {
        let uniform = words(&RowUniform::new(row));
        let from = uniform.len();
        let numbers: Vec<String> = (0..from).map(|i| format!("given[{i}u]")).collect();
        let (t, late) = numbers.split_at(MU_TERMS);
        let body = format!(
            "let row = InterfaceRow(array<f32, 7>({}), array<f32, 7>({}));
            let at_mu = interface_at(row, given[{from}u + index]);
            found[to] = at_mu.t;
            found[to + 1u] = at_mu.late;",
            t.join(", "),
            late.join(", "),
        );
        let text = format!("{physics}\n{}", entry("f32", cases.len(), 2, &body));
        let given = [uniform, cases.concat()].concat();
        let found = gpu.run(&text, &given, cases.len(), 2);
        let pairs: Vec<Pair> = cases
            .iter()
            .zip(found.chunks(2))
            .flat_map(|(case, found)| {
                let mu = f64::from(case[0]);
                let at = interface_at(row, mu);
                let pair = |found: f32, exact: f64, coefficients: &[f64]| {
                    let mut pair = Pair::new(found, exact, RELATIVE);
                    pair.allowed += polynomial_rounding(coefficients, mu);
                    pair
                };
                [
                    pair(found[0], at.t, &row.t),
                    pair(found[1], at.late, &row.late),
                ]
            })
            .collect();
        let error = judge(name, &pairs, |i| {
            format!("{:?}, output {}", cases[i / 2], i % 2)
        })?;
        worst = worst.max(error);
    }
    Ok(worst)
}
