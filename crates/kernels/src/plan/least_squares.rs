//! Nonnegative least squares: the costs, none below 0, with which sums of terms come nearest to measured values, each by its relative
//! error. Values that fit nothing, as of a disturbed measurement, count less.

/// A measured value and the terms that add up to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// How much of each cost the value contains.
    pub terms: Vec<f64>,
    /// Above 0.
    pub value: f64,
    pub weight: f64,
}

/// Rounds in which weights are computed again from the last costs.
const ROUNDS: usize = 12;
/// Sweeps over all costs in a round.
const SWEEPS: usize = 3000;
/// Relative errors beyond this count in proportion instead of by their square.
const ROBUST: f64 = 0.1;

/// The `count` costs that explain the observations best; 0 for one that no observation contains.
pub fn nonnegative(observations: &[Observation], count: usize) -> Vec<f64> {
    // Columns of the same length make the sweeps converge.
    let largest = |column: usize| observations.iter().map(|one| one.terms[column] / one.value).fold(0.0, f64::max);
    let scales: Vec<f64> = (0..count).map(|column| Some(largest(column)).filter(|most| *most > 0.0).unwrap_or(1.0)).collect();
    let rows: Vec<Vec<f64>> =
        observations.iter().map(|one| one.terms.iter().zip(&scales).map(|(term, scale)| term / scale).collect()).collect();
    let mut costs = vec![0.0; count];
    for round in 0..ROUNDS {
        let weight = |(one, row): (&Observation, &Vec<f64>)| {
            let predicted: f64 = row.iter().zip(&costs).map(|(term, cost)| term * cost).sum();
            if round == 0 || predicted <= 0.0 {
                return one.weight / (one.value * one.value);
            }
            // An error of twice the value and one of half of it count alike.
            let error = (predicted - one.value).abs() / (predicted * one.value).sqrt();
            one.weight / (predicted * one.value) * (ROBUST / error.max(ROBUST))
        };
        let weights: Vec<f64> = observations.iter().zip(&rows).map(weight).collect();
        descend(observations, &rows, &weights, &mut costs);
    }
    costs.iter().zip(&scales).map(|(cost, scale)| cost / scale).collect()
}

/// Coordinate descent on the normal equations of the weighted problem.
fn descend(observations: &[Observation], rows: &[Vec<f64>], weights: &[f64], costs: &mut [f64]) {
    let count = costs.len();
    let sum = |of: &dyn Fn(usize) -> f64| (0..rows.len()).map(|i| weights[i] * of(i)).sum::<f64>();
    let products: Vec<Vec<f64>> = (0..count).map(|a| (0..count).map(|b| sum(&|i| rows[i][a] * rows[i][b])).collect()).collect();
    let values: Vec<f64> = (0..count).map(|a| sum(&|i| rows[i][a] * observations[i].value)).collect();
    for _ in 0..SWEEPS {
        let mut moved: f64 = 0.0;
        for a in (0..count).filter(|a| products[*a][*a] > 0.0) {
            let others: f64 = (0..count).filter(|b| *b != a).map(|b| products[a][b] * costs[b]).sum();
            let next = ((values[a] - others) / products[a][a]).max(0.0);
            moved = moved.max((next - costs[a]).abs() / next.max(costs[a]).max(f64::MIN_POSITIVE));
            costs[a] = next;
        }
        if moved < 1e-6 {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cost_that_would_be_negative_is_zero() {
        // The second term makes values smaller, which no cost can.
        let one = |terms: [f64; 2], value: f64| Observation { terms: terms.to_vec(), value, weight: 1.0 };
        let costs = nonnegative(&[one([1.0, 0.0], 2.0), one([2.0, 1.0], 3.9), one([3.0, 0.5], 5.95)], 2);
        assert!((costs[0] - 2.0).abs() < 0.05 && costs[1] == 0.0, "{costs:?}");
    }

    #[test]
    fn what_is_never_observed_costs_nothing() {
        let costs = nonnegative(&[Observation { terms: vec![1.0, 0.0], value: 3.0, weight: 1.0 }], 2);
        assert!((costs[0] - 3.0).abs() < 1e-9 && costs[1] == 0.0, "{costs:?}");
        assert_eq!(nonnegative(&[], 1), [0.0]);
    }
}
