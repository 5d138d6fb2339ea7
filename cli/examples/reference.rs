//! Writes the reference pages of the documentation site: all fields, all commands, all policies.
//!
//! ```console
//! $ cargo run -p jcas-cli --example reference -- FOLDER
//! ```

use std::fmt::Write as _;
use std::path::PathBuf;

use jcas_cli::Command as Commands;
use jcas_cli::fields::by_subject;
use jcas_core::config::FieldValue;
use jcas_core::{Config, Preset};
use jcas_policy::{BaselineKind, named_policies};

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap_or_else(|| ".".into()));
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join("fields.md"), fields())?;
    std::fs::write(folder.join("commands.md"), commands())?;
    std::fs::write(folder.join("policies.md"), policies())
}

fn fields() -> String {
    let mut page = "# Fields of the configuration\n\n\
        The default is that of the preset `mission`; the last column has the presets with another \
        value. `jcas config show` prints the effective values, and [the model](../docs/model.md) \
        says what each field does.\n"
        .to_owned();
    let mission = Config::default();
    let default = mission.values();
    let presets: Vec<Config> = Preset::ALL.iter().map(|of| Config::preset(*of)).collect();
    for (subject, fields) in by_subject() {
        page += &format!(
            "\n## {subject}\n\n| field | unit | range | default | meaning | presets |\n\
             | --- | --- | --- | --- | --- | --- |\n"
        );
        for index in fields {
            let info = &Config::FIELDS[index];
            let range = match default[index] {
                FieldValue::Choice(..) => info.unit.replace(" | ", ", "),
                _ => format!("{} to {}", info.low, info.high),
            };
            let unit = match default[index] {
                FieldValue::Choice(..) => "choice",
                _ => info.unit,
            };
            let values = presets.iter().map(|config| config.values()[index]);
            let others: Vec<String> = Preset::ALL
                .iter()
                .zip(values)
                .filter(|(_, value)| *value != default[index])
                .map(|(preset, value)| format!("{}: {}", preset.name(), shown(&value)))
                .collect();
            let _written = writeln!(
                page,
                "| `{}` | {unit} | {range} | {} | {} | {} |",
                info.name,
                shown(&default[index]),
                cell(info.doc),
                others.join(", ")
            );
        }
    }
    page
}

fn shown(value: &FieldValue<'_>) -> String {
    if value.is_derived() {
        return "derived".to_owned();
    }
    cell(&value.to_string())
}

/// A text that is one cell of a table.
fn cell(text: &str) -> String {
    text.split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
        .replace('|', "\\|")
}

fn commands() -> String {
    use clap::Subcommand;
    let mut all = Commands::augment_subcommands(clap::Command::new("jcas")).term_width(96);
    all.build();
    let mut page = "# Commands\n\nEach section is what `--help` prints.\n".to_owned();
    describe(&mut all, &mut page);
    page
}

fn describe(command: &mut clap::Command, page: &mut String) {
    for part in command.get_subcommands_mut() {
        if part.get_name() == "help" {
            continue;
        }
        let name = part.get_bin_name().unwrap_or_default().to_owned();
        let help = part.render_long_help().to_string();
        *page += &format!("\n## {name}\n\n```text\n{}\n```\n", help.trim_end());
        describe(part, page);
    }
}

fn policies() -> String {
    let mut page = "# Policies\n\n\
        A policy that reads positions cannot fly where `target_visibility = hidden`. A policy is \
        also `plan:FILE`, for a file of `jcas plan`, or the folder of a \
        [trained policy](../policies/README.md).\n\n\
        | name | what it does | reads positions | default of |\n| --- | --- | --- | --- |\n"
        .to_owned();
    for policy in named_policies() {
        let kind = BaselineKind::named(policy.name).ok();
        let reads = kind.is_some_and(BaselineKind::reads_positions);
        let presets: Vec<&str> = Preset::ALL
            .iter()
            .filter(|preset| kind == Some(BaselineKind::default_for(&Config::preset(**preset))))
            .map(|preset| preset.name())
            .collect();
        let _written = writeln!(
            page,
            "| `{}` | {} | {} | {} |",
            policy.name,
            cell(policy.summary),
            if reads { "yes" } else { "no" },
            presets.join(", ")
        );
    }
    page
}
