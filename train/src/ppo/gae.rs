//! Generalised advantage estimation (Schulman et al., 2015).
//!
//! δ_t = r_t + γ·V(s_{t+1}) − V(s_t);  A_t = δ_t + γ·λ·A_{t+1}.
//! A *terminated* mission has no next state: V(s_{t+1}) = 0. A *truncated* one has, only nobody
//! flew on: V of its own last state stands there, not that of the mission that began after it.
//! Either way the sum over A stops, since the next row belongs to another mission.

/// Trajectories of `environments` missions side by side; every slice is time-major (T × M).
pub struct Trajectories<'a> {
    /// Missions side by side (M).
    pub environments: usize,
    /// r_t.
    pub rewards: &'a [f32],
    /// V(s_t).
    pub values: &'a [f32],
    /// V of the state that the step really led to, before any new start.
    pub next_values: &'a [f32],
    /// The mission ended by itself in this step.
    pub terminated: &'a [bool],
    /// The mission was cut at the horizon in this step.
    pub truncated: &'a [bool],
}

/// Advantages A_t and value targets A_t + V(s_t), both time-major.
pub fn advantages(trajectories: &Trajectories, discount: f32, lambda: f32) -> (Vec<f32>, Vec<f32>) {
    let &Trajectories {
        environments,
        rewards,
        values,
        next_values,
        terminated,
        truncated,
    } = trajectories;
    let mut advantages = vec![0.0; rewards.len()];
    for environment in 0..environments {
        let mut following = 0.0;
        for row in (environment..rewards.len()).step_by(environments).rev() {
            let next_value = if terminated[row] {
                0.0
            } else {
                next_values[row]
            };
            let delta = rewards[row] + discount * next_value - values[row];
            if terminated[row] || truncated[row] {
                following = 0.0;
            }
            following = delta + discount * lambda * following;
            advantages[row] = following;
        }
    }
    let targets = advantages.iter().zip(values).map(|(a, v)| a + v).collect();
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

    // γ = ½, λ = ½. By hand, from the end: δ_2 = 3 + ½·4 − 3 = 2, A_2 = 2;
    // δ_1 = 2 + ½·3 − 2 = 1.5, A_1 = 1.5 + ¼·2 = 2; δ_0 = 1 + ½·2 − 1 = 1, A_0 = 1 + ¼·2 = 1.5.
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

    // Terminated at row 1: δ_1 = 2 − 2 = 0 whatever stands in next_values; A_0 = 1 + ¼·0.
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
}
