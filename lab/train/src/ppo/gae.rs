//! Generalised advantage estimation (Schulman et al., 2015).
//!
//! δ_t = r_t + γ·V(s_{t+1}) − V(s_t);  A_t = δ_t + γ·λ·A_{t+1}.
//!
//! A *terminated* episode has no next state: V(s_{t+1}) = 0. After a *truncated* one, V(s_{t+1}) is
//! V of its own last state, not of the next episode's first. In both cases the sum over A stops,
//! because the next row belongs to another episode.

/// Trajectories of `environments` missions side by side, every slice time-major. Rewards may be the
/// team's (T × M) or the UAVs' own (T × M·N).
pub struct Trajectories<'a> {
    /// Missions side by side (M).
    pub environments: usize,
    /// r_t.
    pub rewards: &'a [f32],
    /// V(s_t).
    pub values: &'a [f32],
    /// V of the state after the step, before a reset; the same shape as `values`.
    pub next_values: &'a [f32],
    /// The mission ended by itself in this step.
    pub terminated: &'a [bool],
    /// The mission was cut at the horizon in this step.
    pub truncated: &'a [bool],
}

/// Returns advantages A_t, as many as rewards, and value targets A_t + V(s_t), as many as values. A
/// target is the mean over the UAVs of the team.
pub fn advantages(trajectories: &Trajectories, discount: f32, lambda: f32) -> (Vec<f32>, Vec<f32>) {
    let &Trajectories {
        environments,
        rewards,
        values,
        next_values,
        terminated,
        truncated,
    } = trajectories;
    let missions = terminated.len();
    let streams = rewards.len() / missions;
    let mut deltas = vec![0.0; rewards.len()];
    for (entry, delta) in deltas.iter_mut().enumerate() {
        let row = entry / streams;
        let next_value = if terminated[row] {
            0.0
        } else {
            next_values[row]
        };
        *delta = rewards[entry] + discount * next_value - values[row];
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
    let targets = values
        .iter()
        .zip(advantages.chunks_exact(streams))
        .map(|(value, advantages)| value + advantages.iter().sum::<f32>() / streams as f32)
        .collect();
    (advantages, targets)
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
                terminated: &[false; 2],
                truncated: &[false, true],
            },
            0.5,
            0.5,
        );
        close(&advantages, &[1.5, 4.5, 2.0, 6.0]);
        close(&targets, &[4.0, 6.0]);
    }
}
