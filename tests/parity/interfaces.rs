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
fn polynomial_rounding(coefficients: &[AlphaPolynomial], mu: f64, alpha: f64) -> f64 {
    let (x, s) = (mu.sqrt(), alpha.clamp(ALPHA_FIT_MIN, 1.0).sqrt());
    let powers = |of: f64, k: usize| of.powi(k as i32);
    let sum: f64 = coefficients
        .iter()
        .enumerate()
        .map(|(i, over_s)| {
            let terms = over_s.iter().enumerate();
            powers(x, i) * terms.map(|(j, c)| c.abs() * powers(s, j)).sum::<f64>()
        })
        .sum();
    sum * UNIT_PRODUCT
}

pub fn compare_interfaces(gpu: &Gpu, physics: &str) -> Result<f64, String> {
    let mut worst = 0.0f64;
    let mut tables: Vec<(String, bool, InterfaceTable)> = Vec::new();
    for (index, specular) in [(1.0, 1.0), (1.5, 1.0), (1.5, 0.3), (3.0, 1.0)] {
        let name = format!("interface of index {index}, specular {specular}");
        tables.push((name.clone(), true, InterfaceTable::new(index, specular)));
        for alpha in [0.0, 0.01, 0.5] {
            let table = InterfaceTable::at_roughness(alpha, index, specular);
            tables.push((format!("{name}, α {alpha}"), false, table));
        }
    }
    let mut cosines = cosines();
    cosines.extend([0.0, 0.25, 0.9999]);
    let cases = grid(&[cosines, alphas()]);
    for (name, fitted, table) in &tables {
        let uniform = words(&InterfaceUniform::new(table));
        // Table first, then the cases, as one array of numbers.
        let table_words = uniform.len();
        let vector = |at: usize| {
            let numbers: Vec<String> = (at..at + 4).map(|i| format!("given[{i}u]")).collect();
            format!("vec4({})", numbers.join(", "))
        };
        let vectors: Vec<String> = (0..table_words).step_by(4).map(vector).collect();
        let (t, rest) = vectors.split_at(MU_TERMS);
        let (lost, means) = rest.split_at(LOST_TERMS);
        let powers = if *fitted {
            "fit_powers(alpha)"
        } else {
            "vec4(1.0, 0.0, 0.0, 0.0)"
        };
        let body = format!(
            "let table = InterfaceTable(array({}), array({}), {});
            let mu = given[{table_words}u + 2u * index];
            let alpha = given[{table_words}u + 2u * index + 1u];
            let p = {powers};
            let at_mu = interface_at(interface_row(table, p), mu);
            let mean = interface_mean_at(table, p);
            found[to] = at_mu.t;
            found[to + 1u] = at_mu.lost;
            found[to + 2u] = mean.compensation;
            found[to + 3u] = mean.t_mean;
            found[to + 4u] = mean.capture;
            found[to + 5u] = mean.floor;",
            t.join(", "),
            lost.join(", "),
            means.join(", ")
        );
        let text = format!("{physics}\n{}", entry("f32", cases.len(), 6, &body));
        let given = [uniform, cases.concat()].concat();
        let found = gpu.run(&text, &given, cases.len(), 6);
        let pairs: Vec<Pair> = cases
            .iter()
            .zip(found.chunks(6))
            .flat_map(|(case, found)| {
                let (mu, alpha) = (f64::from(case[0]), f64::from(case[1]));
                let (at, mean) = (table.at(mu, alpha), table.mean_at(alpha));
                let expected = [
                    at.t,
                    at.lost,
                    mean.compensation,
                    mean.t_mean,
                    mean.capture,
                    mean.floor,
                ];
                let rounding = [
                    polynomial_rounding(&table.t, mu, alpha),
                    polynomial_rounding(&table.lost, mu, alpha),
                    polynomial_rounding(&[table.compensation], mu, alpha),
                    polynomial_rounding(&[table.t_mean], mu, alpha),
                    polynomial_rounding(&[table.capture], mu, alpha),
                    polynomial_rounding(&[table.floor], mu, alpha),
                ];
                std::array::from_fn::<_, 6, _>(|k| {
                    let mut pair = Pair::new(found[k], expected[k], RELATIVE);
                    pair.allowed += rounding[k];
                    pair
                })
            })
            .collect();
        let error = judge(name, &pairs, |i| {
            format!("{:?}, output {}", cases[i / 6], i % 6)
        })?;
        worst = worst.max(error);
    }
    Ok(worst)
}
