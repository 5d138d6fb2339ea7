//! The package for Node.js: the playground's kernel behind two functions.

use super::archive::{self, Content, Tree};

const VERSION: &str = env!("CARGO_PKG_VERSION");

const TEXTS: [(&str, &str); 5] = [
    (
        "package.json",
        include_str!("../../../packaging/npm/package.json"),
    ),
    (
        "index.mjs",
        include_str!("../../../packaging/npm/index.mjs"),
    ),
    (
        "index.d.ts",
        include_str!("../../../packaging/npm/index.d.ts"),
    ),
    ("LICENSE-APACHE", include_str!("../../../LICENSE-APACHE")),
    ("LICENSE-MIT", include_str!("../../../LICENSE-MIT")),
];

/// The package as `npm install` takes it, with its name.
pub fn package(wasm: Vec<u8>, notices: &str, epoch: u32) -> std::io::Result<(String, Vec<u8>)> {
    let texts = TEXTS.map(|(path, text)| (path.to_owned(), Content::file(text)));
    let mut tree = Tree::from_iter(texts);
    tree.insert("jcas.wasm".to_owned(), Content::file(wasm));
    tree.insert("THIRD-PARTY".to_owned(), Content::file(notices));
    let bytes = archive::tar_gz("package", &tree, epoch)?;
    Ok((format!("jcas-{VERSION}.tgz"), bytes))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_package_has_every_file_that_its_code_names() {
        let (name, bytes) = package(b"\0asm".to_vec(), "notices", 1_700_000_000).unwrap();
        assert_eq!(name, format!("jcas-{VERSION}.tgz"));
        let mut tar = tar::Archive::new(flate2::read::GzDecoder::new(bytes.as_slice()));
        let entries = tar.entries().unwrap().map(|entry| {
            let entry = entry.unwrap();
            entry.path().unwrap().display().to_string()
        });
        let files: BTreeSet<String> = entries.collect();
        let manifest: serde_json::Value = serde_json::from_str(TEXTS[0].1).unwrap();
        let exported = manifest["exports"]["."].as_object().unwrap().values();
        let exported = exported.map(|file| file.as_str().unwrap().trim_start_matches("./"));
        let read = TEXTS[1].1.split("new URL('").nth(1).unwrap();
        let read = read.split('\'').next().unwrap();
        for file in exported.chain([read]) {
            assert!(
                files.contains(&format!("package/{file}")),
                "{file}: {files:?}"
            );
        }
    }
}
