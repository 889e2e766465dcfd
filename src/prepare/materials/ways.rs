//! Ways to tell classes apart, and how often each class is met.
//!
//! Swatches show each medium about as often as any other, sheets do not: where most is paper, a place that
//! looks half like paper and half like lead point is paper. How often a class is met is found from the sheet
//! itself, by the method of Saerens, Latinne & Decaestecker, *Neural Computation* 14 (2002) 21.

use std::fmt;

use super::{
    confusion::Confusion,
    discriminant::Discriminant,
    features::{FEATURES, Features, OWN, WITH_RELIEF},
    network::Network,
};

/// Starts of the network, of which the best is kept.
const STARTS: u64 = 2;
/// Who took swatches of a medium has seen it: no class is met in a smaller share of places.
const LEAST_SHARE: f64 = 0.01;
/// Rounds in which shares are found, at most, and the change at which they are.
const ROUNDS: usize = 200;
const STILL: f64 = 1e-6;

/// A method of telling classes apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Fisher's linear discriminant.
    Discriminant,
    /// A network with one hidden layer, fitted by Levenberg and Marquardt's method.
    Network,
}

/// A method, and what it sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    pub method: Method,
    pub surroundings: Surroundings,
}

/// What is seen of a place's surroundings. A thin pen stroke, whose surroundings are its neighbours', is told better
/// without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surroundings {
    Nothing,
    /// How uneven and how hollow the relief is: a groove is told by that.
    Relief,
    /// How uneven the colour is as well: chalk is told by that.
    All,
}

impl Way {
    /// The simpler ones first.
    pub const ALL: [Self; 6] = [
        Self::new(Method::Discriminant, Surroundings::Nothing),
        Self::new(Method::Discriminant, Surroundings::Relief),
        Self::new(Method::Discriminant, Surroundings::All),
        Self::new(Method::Network, Surroundings::Nothing),
        Self::new(Method::Network, Surroundings::Relief),
        Self::new(Method::Network, Surroundings::All),
    ];

    const fn new(method: Method, surroundings: Surroundings) -> Self {
        Self {
            method,
            surroundings,
        }
    }

    /// What it sees of a place.
    pub fn sees(self, features: &Features) -> Features {
        let mut seen = *features;
        let first_unseen = match self.surroundings {
            Surroundings::Nothing => OWN,
            Surroundings::Relief => WITH_RELIEF,
            Surroundings::All => FEATURES,
        };
        seen[first_unseen..].fill(0.0);
        seen
    }
}

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.method {
            Method::Discriminant => "linear discriminant",
            Method::Network => "network",
        })?;
        f.write_str(match self.surroundings {
            Surroundings::Nothing => ", each place by itself",
            Surroundings::Relief => ", relief around it seen",
            Surroundings::All => ", surroundings seen",
        })
    }
}

#[derive(Clone, Debug)]
enum Fitted {
    Discriminant(Discriminant),
    Network(Network),
}

/// A way that was fitted to swatches.
#[derive(Clone, Debug)]
pub struct Classifier {
    pub way: Way,
    fitted: Fitted,
    /// How much more often each class is met than it was learnt from.
    ratios: Vec<f64>,
}

impl Classifier {
    /// Fits `way` to places whose class is known; of several starts the one that does best on `choosing` is kept.
    /// `None` where no discriminant exists.
    pub fn fit(
        way: Way,
        learning: &[(Features, usize)],
        choosing: &[(Features, usize)],
        classes: usize,
    ) -> Option<Self> {
        let seen: Vec<(Features, usize)> = learning
            .iter()
            .map(|(features, class)| (way.sees(features), *class))
            .collect();
        // As if each class were met as often, however many places it was learnt from.
        let even = learning.len() as f64 / classes.max(1) as f64;
        let ratio = |class| {
            let count = learning.iter().filter(|(_, of)| *of == class).count();
            even / count.max(1) as f64
        };
        let ratios: Vec<f64> = (0..classes).map(ratio).collect();
        let of = |fitted| Self {
            way,
            fitted,
            ratios: ratios.clone(),
        };
        match way.method {
            Method::Discriminant => {
                Some(of(Fitted::Discriminant(Discriminant::fit(&seen, classes)?)))
            }
            Method::Network => {
                let starts =
                    (0..STARTS).map(|seed| of(Fitted::Network(Network::fit(&seen, classes, seed))));
                let judged = starts.map(|one| (one.judged(choosing).accuracy(), one));
                // Of equals the first.
                let best = judged.reduce(|best, next| match next.0 > best.0 {
                    true => next,
                    false => best,
                });
                best.map(|(_, one)| one)
            }
        }
    }

    /// What it takes places for whose class is known.
    pub fn judged(&self, places: &[(Features, usize)]) -> Confusion {
        let pairs = places
            .iter()
            .map(|(features, is)| (*is, self.class(features)));
        Confusion::of(pairs, self.ratios.len())
    }

    /// The class of a place.
    pub fn class(&self, features: &Features) -> usize {
        let seen = self.way.sees(features);
        match &self.fitted {
            Fitted::Discriminant(discriminant) => discriminant.class(&seen),
            Fitted::Network(network) => {
                let each = network.shares(&seen).into_iter().zip(&self.ratios);
                let weighed = each.map(|(share, ratio)| share * ratio).enumerate();
                weighed
                    .max_by(|a, b| a.1.total_cmp(&b.1))
                    .map_or(0, |(class, _)| class)
            }
        }
    }

    /// Finds how often each class is met among `places`, `learnt` having been the numbers that were learnt from.
    /// A discriminant's distances are no probabilities, and it goes on taking all classes for equally frequent.
    pub fn meet(&mut self, places: &[Features], learnt: &[usize]) {
        let Fitted::Network(network) = &self.fitted else {
            return;
        };
        let all: usize = learnt.iter().sum();
        if places.is_empty() || all == 0 {
            return;
        }
        let before: Vec<f64> = learnt
            .iter()
            .map(|count| (*count as f64 / all as f64).max(LEAST_SHARE))
            .collect();
        let shares: Vec<Vec<f64>> = places
            .iter()
            .map(|features| network.shares(&self.way.sees(features)))
            .collect();
        let mut now = before.clone();
        for _ in 0..ROUNDS {
            let mut next = vec![0.0; now.len()];
            for share in &shares {
                let weighed: Vec<f64> = (0..now.len())
                    .map(|class| share[class] * now[class] / before[class])
                    .collect();
                let sum = weighed.iter().sum::<f64>().max(f64::MIN_POSITIVE);
                for (next, weight) in next.iter_mut().zip(weighed) {
                    *next += weight / sum / shares.len() as f64;
                }
            }
            let moved = next.iter().zip(&now).map(|(a, b)| (a - b).abs());
            let still = moved.fold(0.0, f64::max) < STILL;
            now = next;
            if still {
                break;
            }
        }
        self.ratios = now
            .iter()
            .zip(&before)
            .map(|(now, before)| now.max(LEAST_SHARE) / before)
            .collect();
    }
}

#[cfg(test)]
mod tests {
    use rand::{SeedableRng, rngs::Xoshiro256PlusPlus};
    use rand_distr::{Distribution, Normal};

    use super::{
        super::features::{FEATURES, Features},
        *,
    };

    /// Places of two classes that overlap by colour: `counts` of each.
    fn places(counts: [usize; 2], seed: u64) -> Vec<(Features, usize)> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut all = Vec::new();
        for (class, count) in counts.into_iter().enumerate() {
            let value = Normal::new([0.4, 0.6][class], 0.1).expect("a spread");
            for _ in 0..count {
                let mut features = [0.5; FEATURES];
                features[1] = value.sample(&mut random) as f32;
                all.push((features, class));
            }
        }
        all
    }

    #[test]
    fn a_rare_class_is_not_seen_everywhere() {
        let learning = places([500, 500], 1);
        let sheet = places([9700, 300], 2);
        let way = Way::new(Method::Network, Surroundings::All);
        let mut network = Classifier::fit(way, &learning, &[], 2).expect("a network");
        let wrong = |network: &Classifier| {
            let off = sheet.iter().filter(|(f, is)| network.class(f) != *is);
            off.count() as f64 / sheet.len() as f64
        };
        let before = wrong(&network);
        let seen: Vec<Features> = sheet.iter().map(|(features, _)| *features).collect();
        network.meet(&seen, &[500, 500]);
        let after = wrong(&network);
        eprintln!(
            "{before:.4} of all places wrong, then {after:.4}; {:?}",
            network.ratios
        );
        // Bayes' error of equally frequent classes, Φ(−1), and of these ones.
        assert!((before - 0.159).abs() < 0.03, "{before}");
        assert!(after < 0.03, "{after}");
        assert!(
            (network.ratios[1] / 2.0 - 0.03).abs() < 0.02,
            "{:?}",
            network.ratios
        );
        // Where both are as frequent as in the swatches, nothing changes.
        let even: Vec<Features> = places([2000, 2000], 3).iter().map(|(f, _)| *f).collect();
        network.meet(&even, &[500, 500]);
        assert!(network.ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.1));
    }

    #[test]
    fn who_does_not_look_around_is_not_led_astray_by_surroundings() {
        let apart = |around: [f32; 2]| -> Vec<(Features, usize)> {
            let mut all = places([200, 200], 4);
            for (features, class) in &mut all {
                features[1] = [0.2, 0.8][*class] + 0.1 * features[1];
                features[OWN] = around[*class];
            }
            all
        };
        let learning = apart([0.0, 1.0]);
        let elsewhere = apart([1.0, 0.0]);
        let right = |surroundings: Surroundings| {
            let way = Way::new(Method::Network, surroundings);
            let network = Classifier::fit(way, &learning, &learning, 2).expect("a network");
            network.judged(&elsewhere).accuracy()
        };
        assert_eq!(right(Surroundings::Nothing), 1.0);
        assert!(right(Surroundings::Relief) < 1.0, "the case that must fail");
    }
}
