//! How often a classifier takes one material for another.

/// Counts of places by what they are (rows) and what they were taken for (columns).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Confusion {
    pub counts: Vec<Vec<u64>>,
}

impl Confusion {
    /// Of places that are and were found to be of some of `classes` classes.
    pub fn of(pairs: impl IntoIterator<Item = (usize, usize)>, classes: usize) -> Self {
        let mut counts = vec![vec![0; classes]; classes];
        for (is, found) in pairs {
            counts[is][found] += 1;
        }
        Self { counts }
    }

    /// How many places it counts.
    pub fn total(&self) -> u64 {
        self.counts.iter().flatten().sum()
    }

    /// The share of a class's places that were found; `None` where it has none.
    pub fn recall(&self, class: usize) -> Option<f64> {
        let row = self.counts.get(class)?;
        let all: u64 = row.iter().sum();
        (all > 0).then(|| row[class] as f64 / all as f64)
    }

    /// The mean share of each class's places that were found, so that rare media count as much as
    /// paper; 0 without any places.
    pub fn accuracy(&self) -> f64 {
        let recalls: Vec<f64> = (0..self.counts.len())
            .filter_map(|class| self.recall(class))
            .collect();
        recalls.iter().sum::<f64>() / recalls.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rare_classes_count_as_much() {
        let many = std::iter::repeat_n((0, 0), 900);
        let few = std::iter::repeat_n((1, 0), 10);
        let confusion = Confusion::of(many.chain(few), 3);
        assert_eq!(confusion.total(), 910);
        assert_eq!(confusion.recall(1), Some(0.0));
        assert_eq!(confusion.recall(2), None);
        assert!((confusion.accuracy() - 0.5).abs() < 1e-12);
        assert_eq!(Confusion::default().accuracy(), 0.0);
    }
}
