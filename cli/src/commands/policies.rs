//! `jcas policies`: lists the policies that go by a name.

use clap::Args;
use jcas_core::{Config, Preset};
use jcas_policy::{BaselineKind, NamedPolicy, named_policies};

use crate::error::{CliError, Outcome};
use crate::files;

const EXAMPLES: &str = "\
Examples:
  jcas policies
  jcas simulate --preset search --policy line";

/// List the policies that go by a name, with what each does
///
/// A policy is also plan:FILE, for a file of `jcas plan`, or the folder of a trained policy. A
/// policy that reads positions cannot fly where target_visibility = hidden.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Policies {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// A policy in the list.
#[derive(serde::Serialize)]
struct Row {
    name: &'static str,
    summary: &'static str,
    reads_positions: bool,
    /// The presets that it flies unless another one is named.
    default_of: Vec<&'static str>,
}

impl Row {
    fn of(NamedPolicy { name, summary }: NamedPolicy) -> Self {
        let kind = BaselineKind::named(name).ok();
        let presets = Preset::ALL.iter().filter(|preset| {
            let default = BaselineKind::default_for(&Config::preset(**preset));
            kind == Some(default)
        });
        Self {
            name,
            summary,
            reads_positions: kind.is_some_and(BaselineKind::reads_positions),
            default_of: presets.map(|preset| preset.name()).collect(),
        }
    }

    fn text(&self) -> String {
        let mut text = format!("{:<10}{}", self.name, self.summary);
        if self.reads_positions {
            text += "; reads positions";
        }
        if !self.default_of.is_empty() {
            text += &format!(" (flies {} by default)", self.default_of.join(" and "));
        }
        text + "\n"
    }
}

impl Policies {
    /// Prints the list.
    pub fn run(self) -> Result<Outcome, CliError> {
        let rows: Vec<Row> = named_policies().map(Row::of).collect();
        if self.json {
            files::print_json(&rows)?;
        } else {
            files::print(&rows.iter().map(Row::text).collect::<String>())?;
        }
        Ok(Outcome::Done)
    }
}
