//! The playground's page: the player of recorded episodes with controls, and a kernel inside or
//! behind it.

use jcas_episode::replay::{Parts, assemble};

const CONTROLS: &str = include_str!("../page/controls.html");
const STYLE: &str = include_str!("../page/controls.css");
const SCRIPTS: [&str; 2] = [
    include_str!("../page/kernel.js"),
    include_str!("../page/playground.js"),
];

/// The page that sends its requests to the program which served it.
#[must_use]
pub fn served() -> String {
    page("script-src 'unsafe-inline'; connect-src 'self'", CONTROLS)
}

/// The page with the kernel inside, as WebAssembly in base64: one file for any host.
#[must_use]
pub fn whole(wasm_base64: &str) -> String {
    let kernel = format!(
        "{CONTROLS}<script type=\"application/wasm+base64\" id=\"kernel\">{wasm_base64}</script>\n"
    );
    page(
        "script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; worker-src blob:",
        &kernel,
    )
}

fn page(sources: &str, controls: &str) -> String {
    assemble(&Parts {
        title: "jcas playground",
        sources,
        style: STYLE,
        controls,
        script: &SCRIPTS.join("\n"),
        ..Parts::default()
    })
}
