//! The probability that a team reaches the quorum.

/// Returns the probability that at least `quorum` of `team` UAVs detect in one step, each with
/// probability `detection`. It is the upper tail of a binomial distribution.
#[must_use]
pub fn quorum_probability(team: usize, quorum: usize, detection: f64) -> f64 {
    if quorum == 0 {
        return 1.0;
    }
    if quorum > team {
        return 0.0;
    }
    if detection >= 1.0 {
        return 1.0;
    }
    let miss = 1.0 - detection;
    // The loop sums P(exactly k) from k = 0 up to the quorum; the result is the complement of the
    // sum.
    let mut exactly = libm::pow(miss, team as f64);
    let mut below = 0.0;
    for k in 0..quorum {
        below += exactly;
        exactly *= (team - k) as f64 / (k + 1) as f64 * (detection / miss);
    }
    (1.0 - below).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::quorum_probability;

    #[test]
    fn equals_the_sum_over_all_outcomes() {
        let (team, quorum, detection) = (7usize, 3usize, 0.16f64);
        let by_enumeration: f64 = (0u32..1 << team)
            .filter(|outcome| outcome.count_ones() as usize >= quorum)
            .map(|outcome| {
                let hits = outcome.count_ones() as i32;
                detection.powi(hits) * (1.0 - detection).powi(team as i32 - hits)
            })
            .sum();
        let got = quorum_probability(team, quorum, detection);
        assert!(
            (got - by_enumeration).abs() < 1e-12,
            "{got} {by_enumeration}"
        );
    }

    #[test]
    fn a_team_below_the_quorum_never_confirms() {
        assert_eq!(quorum_probability(2, 3, 1.0), 0.0);
        assert_eq!(quorum_probability(3, 3, 1.0), 1.0);
        assert_eq!(quorum_probability(3, 3, 0.0), 0.0);
    }
}
