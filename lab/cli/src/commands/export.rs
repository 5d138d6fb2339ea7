//! `jcas-lab export`: a policy for other runtimes.

use std::path::PathBuf;

use clap::Args;
use jcas_cli::error::{CliError, Outcome};
use jcas_cli::files;
use jcas_core::{Config, Model};
use jcas_train::policy::{files as policies, onnx, shape_of};

use super::failed;

const EXAMPLES: &str = "\
Examples:
  jcas-lab export policies/fleet -o fleet.onnx
  jcas-lab export policies/fleet --uavs 15 --hotspots 7 -o fleet-15x7.onnx";

/// Write a trained policy as an ONNX graph
///
/// Input `observations` has a row for each UAV. Output `distribution` has the raw outputs of the
/// action head, and `actions` the deterministic pairs (u_dir, u_pilot). The number of rows is free;
/// a graph holds for one number of hotspots and one length of the neighbour list.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Export {
    /// Folder of a trained policy
    policy: PathBuf,
    /// UAVs in the fleet [default: as on the card]
    #[arg(long, value_name = "N")]
    uavs: Option<u32>,
    /// Hotspots [default: as on the card]
    #[arg(long, value_name = "n")]
    hotspots: Option<u32>,
    /// File to write
    #[arg(long, short, value_name = "FILE", default_value = "policy.onnx")]
    out: PathBuf,
}

impl Export {
    /// Writes the graph.
    pub fn run(self) -> Result<Outcome, CliError> {
        let (card, actor) = policies::load(&self.policy).map_err(failed)?;
        if actor.network.reads_choices() {
            return Err(CliError::input(format!(
                "{}: its UAVs read the choices of their neighbours, and an ONNX graph has no turns",
                self.policy.display()
            )));
        }
        let config = Config {
            uav_count: self.uavs.unwrap_or(card.config.uav_count),
            hotspot_count: self.hotspots.unwrap_or(card.config.hotspot_count),
            ..card.config
        };
        let model = Model::new(config)?;
        jcas_episode::card::load(&self.policy)?.check(&model)?;
        let graph = onnx::encode(&actor, &shape_of(&model));
        files::write_bytes(&self.out, &graph)?;
        files::print(&format!(
            "{}: {} bytes, for {} UAVs and {} hotspots\n",
            self.out.display(),
            graph.len(),
            config.uav_count,
            config.hotspot_count
        ))?;
        Ok(Outcome::Done)
    }
}
