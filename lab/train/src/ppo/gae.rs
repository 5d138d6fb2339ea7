//! Generalised advantage estimation (Schulman et al., 2015).
//!
//! δ_t = r_t + γ·V(s_{t+1}) − V(s_t);  A_t = δ_t + γ·λ·A_{t+1}.
//!
//! A *terminated* episode has no next state: V(s_{t+1}) = 0. After a *truncated* one, V(s_{t+1}) is
//! V of its own last state, not of the next episode's first. In both cases the sum over A stops,
//! because the next row belongs to another episode.
//!
//! A control variate can free δ_t of the luck of confirmations. Where the reward counts time, V is
//! the negative time to the end. So x confirmations beyond expectation, as a share of the
//! unconfirmed hotspots, raise V(s_{t+1}) by about −β·V(s_t)·x. Least squares over the trajectories
//! give β, which is 1 where hovering takes all the time. β·V(s_t)·x is added to δ_t. The mean of x
//! over the drawn detections is 0, so for a given β the mean of A_t stays what it is. That β comes
//! from the same rows adds a bias, which falls with their number.

/// Trajectories of `environments` missions side by side, every slice time-major. Rewards and values
/// may each be the team's (T × M) or the UAVs' own (T × M·N).
pub struct Trajectories<'a> {
    /// Missions side by side (M).
    pub environments: usize,
    /// r_t.
    pub rewards: &'a [f32],
    /// V(s_t).
    pub values: &'a [f32],
    /// V of the state after the step, before a reset; the same shape as `values`.
    pub next_values: &'a [f32],
    /// Confirmations beyond expectation, as a share of the unconfirmed hotspots; T × M, or empty.
    pub surpluses: &'a [f32],
    /// The mission ended by itself in this step.
    pub terminated: &'a [bool],
    /// The mission was cut at the horizon in this step.
    pub truncated: &'a [bool],
}

/// Returns advantages A_t and value targets A_t + V(s_t). Advantages are (T × M·N) if rewards or
/// values are, else (T × M). Targets have the shape of the values; a team's target is the mean over
/// its UAVs.
pub fn advantages(trajectories: &Trajectories, discount: f32, lambda: f32) -> (Vec<f32>, Vec<f32>) {
    let &Trajectories {
        environments,
        rewards,
        values,
        next_values,
        surpluses,
        terminated,
        truncated,
    } = trajectories;
    let missions = terminated.len();
    let (per_reward, per_value) = (rewards.len() / missions, values.len() / missions);
    let streams = per_reward.max(per_value);
    // An entry of the team stands for each of its UAVs.
    let of = |entries: &[f32], per_mission: usize, row: usize, stream: usize| {
        entries[row * per_mission + stream % per_mission]
    };
    let mut deltas = vec![0.0; missions * streams];
    for (entry, delta) in deltas.iter_mut().enumerate() {
        let (row, stream) = (entry / streams, entry % streams);
        let next_value = if terminated[row] {
            0.0
        } else {
            of(next_values, per_value, row, stream)
        };
        let value = of(values, per_value, row, stream);
        *delta = of(rewards, per_reward, row, stream) + discount * next_value - value;
    }
    if !surpluses.is_empty() {
        let luck = |entry: usize| {
            let (row, stream) = (entry / streams, entry % streams);
            -of(values, per_value, row, stream) * surpluses[row]
        };
        take_out(&mut deltas, luck);
    }
    let mut advantages = vec![0.0; missions * streams];
    for environment in 0..environments {
        for stream in 0..streams {
            let mut following = 0.0;
            for row in (environment..missions).step_by(environments).rev() {
                if terminated[row] || truncated[row] {
                    following = 0.0;
                }
                following = deltas[row * streams + stream] + discount * lambda * following;
                advantages[row * streams + stream] = following;
            }
        }
    }
    let shared = streams / per_value;
    let targets = values
        .iter()
        .zip(advantages.chunks_exact(shared))
        .map(|(value, advantages)| value + advantages.iter().sum::<f32>() / shared as f32)
        .collect();
    (advantages, targets)
}

/// Takes a control variate out of δ, by the coefficient of least squares.
fn take_out(deltas: &mut [f32], luck: impl Fn(usize) -> f32) {
    let (mut product, mut square) = (0.0, 0.0);
    for (entry, &delta) in deltas.iter().enumerate() {
        let luck = f64::from(luck(entry));
        product += luck * f64::from(delta);
        square += luck * luck;
    }
    if square > 0.0 {
        let coefficient = (product / square) as f32;
        for (entry, delta) in deltas.iter_mut().enumerate() {
            *delta -= coefficient * luck(entry);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(got: &[f32], expected: &[f32]) {
        assert_eq!(got.len(), expected.len());
        for (got, expected) in got.iter().zip(expected) {
            assert!((got - expected).abs() < 1e-6, "{got} is not {expected}");
        }
    }

    // γ = ½, λ = ½. The expected values were computed by hand, from the end:
    //
    // δ_2 = 3 + ½·4 − 3 = 2, A_2 = 2;
    //
    // δ_1 = 2 + ½·3 − 2 = 1.5, A_1 = 1.5 + ¼·2 = 2;
    //
    // δ_0 = 1 + ½·2 − 1 = 1, A_0 = 1 + ¼·2 = 1.5.
    #[test]
    fn an_open_trajectory_bootstraps_from_its_last_state() {
        let (advantages, targets) = advantages(
            &Trajectories {
                environments: 1,
                rewards: &[1.0, 2.0, 3.0],
                values: &[1.0, 2.0, 3.0],
                next_values: &[2.0, 3.0, 4.0],
                surpluses: &[],
                terminated: &[false; 3],
                truncated: &[false; 3],
            },
            0.5,
            0.5,
        );
        close(&advantages, &[1.5, 2.0, 2.0]);
        close(&targets, &[2.5, 4.0, 5.0]);
    }

    // Terminated at row 1: δ_1 = 2 − 2 = 0 for any next_values; A_0 = 1 + ¼·0.
    // Row 2 begins a new mission, and its advantage must not leak into row 1.
    #[test]
    fn a_terminated_mission_has_no_next_value() {
        let (advantages, _) = advantages(
            &Trajectories {
                environments: 1,
                rewards: &[1.0, 2.0, 30.0],
                values: &[1.0, 2.0, 3.0],
                next_values: &[2.0, 99.0, 4.0],
                surpluses: &[],
                terminated: &[false, true, false],
                truncated: &[false; 3],
            },
            0.5,
            0.5,
        );
        close(&advantages, &[1.0, 0.0, 29.0]);
    }

    // Truncated at row 1 with V = 6 at its own end: δ_1 = 2 + ½·6 − 2 = 3, A_0 = 1 + ¼·3.
    #[test]
    fn a_truncated_mission_keeps_the_value_of_its_own_end() {
        let (advantages, _) = advantages(
            &Trajectories {
                environments: 1,
                rewards: &[1.0, 2.0, 30.0],
                values: &[1.0, 2.0, 3.0],
                next_values: &[2.0, 6.0, 4.0],
                surpluses: &[],
                terminated: &[false; 3],
                truncated: &[false, true, false],
            },
            0.5,
            0.5,
        );
        close(&advantages, &[1.75, 3.0, 29.0]);
    }

    // Two missions interleaved give what each gives alone.
    #[test]
    fn missions_side_by_side_do_not_mix() {
        let (advantages, _) = advantages(
            &Trajectories {
                environments: 2,
                rewards: &[1.0, 1.0, 2.0, 2.0, 3.0, 30.0],
                values: &[1.0, 1.0, 2.0, 2.0, 3.0, 3.0],
                next_values: &[2.0, 2.0, 3.0, 6.0, 4.0, 4.0],
                surpluses: &[],
                terminated: &[false; 6],
                truncated: &[false, false, false, true, false, false],
            },
            0.5,
            0.5,
        );
        close(&advantages, &[1.5, 1.75, 2.0, 3.0, 2.0, 29.0]);
    }

    // γ = ½, λ = ½, one episode of two UAVs, truncated after two steps. Both UAVs share the values
    // V = (1, 2), then 4. UAV 0 earns (1, 2): δ_1 = 2 + ½·4 − 2 = 2, δ_0 = 1 + ½·2 − 1 = 1, A =
    // (1.5, 2). UAV 1 earns (3, 6): δ_1 = 6, δ_0 = 3, A = (4.5, 6). The targets are V plus the
    // means, 3 and 4.
    #[test]
    fn uavs_paid_each_its_own_share_one_value() {
        let (advantages, targets) = advantages(
            &Trajectories {
                environments: 1,
                rewards: &[1.0, 3.0, 2.0, 6.0],
                values: &[1.0, 2.0],
                next_values: &[2.0, 4.0],
                surpluses: &[],
                terminated: &[false; 2],
                truncated: &[false, true],
            },
            0.5,
            0.5,
        );
        close(&advantages, &[1.5, 4.5, 2.0, 6.0]);
        close(&targets, &[4.0, 6.0]);
    }

    // With a value for each UAV, each gets the advantage that it would get alone. A team's reward
    // counts for both.
    #[test]
    fn uavs_with_values_of_their_own_do_not_mix() {
        let alone = |rewards: &[f32], values: &[f32], next_values: &[f32], environments: usize| {
            let (terminated, truncated) = ([false; 4], [false, true, false, true]);
            let missions = 2 * environments;
            advantages(
                &Trajectories {
                    environments,
                    rewards,
                    values,
                    next_values,
                    surpluses: &[],
                    terminated: &terminated[..missions],
                    truncated: &truncated[..missions],
                },
                0.5,
                0.5,
            )
        };
        let (a, a_targets) = alone(&[1.0, 2.0], &[1.0, 2.0], &[2.0, 4.0], 1);
        let (b, b_targets) = alone(&[3.0, 6.0], &[5.0, 1.0], &[1.0, 3.0], 1);
        let own = &[1.0, 3.0, 2.0, 6.0];
        let (both, targets) = alone(own, &[1.0, 5.0, 2.0, 1.0], &[2.0, 1.0, 4.0, 3.0], 1);
        close(&both, &[a[0], b[0], a[1], b[1]]);
        close(
            &targets,
            &[a_targets[0], b_targets[0], a_targets[1], b_targets[1]],
        );

        let (c, _) = alone(&[1.0, 2.0], &[5.0, 1.0], &[1.0, 3.0], 1);
        let (both, _) = alone(&[1.0, 2.0], &[1.0, 5.0, 2.0, 1.0], &[2.0, 1.0, 4.0, 3.0], 1);
        close(&both, &[a[0], c[0], a[1], c[1]]);
    }

    // γ = 1, λ = 1. An episode of one hotspot is confirmed with chance ½ in each step, so V = −2.
    // Confirmed at once, or one or two steps late, its advantages are luck alone.
    #[test]
    fn luck_alone_is_no_advantage() {
        let (advantages, targets) = advantages(
            &Trajectories {
                environments: 1,
                rewards: &[-1.0; 6],
                values: &[-2.0; 6],
                next_values: &[-2.0; 6],
                surpluses: &[0.5, -0.5, 0.5, -0.5, -0.5, 0.5],
                terminated: &[true, false, true, false, false, true],
                truncated: &[false; 6],
            },
            1.0,
            1.0,
        );
        close(&advantages, &[0.0; 6]);
        close(&targets, &[-2.0; 6]);
    }

    // δ = (0, -2) and −V·x = (1, -1), so least squares give β = (0·1 + 2·1)/2 = 1. Both steps are
    // then slower than their values by 1.
    #[test]
    fn what_luck_does_not_explain_stays() {
        let (advantages, _) = advantages(
            &Trajectories {
                environments: 2,
                rewards: &[-1.0, -1.0],
                values: &[-4.0, -4.0],
                next_values: &[-3.0, -5.0],
                surpluses: &[0.25, -0.25],
                terminated: &[false; 2],
                truncated: &[false; 2],
            },
            1.0,
            1.0,
        );
        close(&advantages, &[-1.0, -1.0]);
    }
}
