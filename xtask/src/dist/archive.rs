//! Archives whose bytes follow from their entries: sorted, with one time and no owner.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};

use flate2::{Compression, GzBuilder};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// What an archive holds, by path. The map keeps the paths sorted.
pub type Tree = BTreeMap<String, Content>;

pub enum Content {
    File {
        bytes: Vec<u8>,
        executable: bool,
    },
    /// A symbolic link to a neighbour.
    Link(String),
}

impl Content {
    pub fn file(bytes: impl Into<Vec<u8>>) -> Self {
        let bytes = bytes.into();
        Self::File {
            bytes,
            executable: false,
        }
    }
}

/// A tar archive under gzip. All entries lie in the folder `root` and have the time `epoch`,
/// in seconds since 1970.
pub fn tar_gz(root: &str, tree: &Tree, epoch: u32) -> std::io::Result<Vec<u8>> {
    // The compressor writes no system into the header, which would differ between hosts.
    let gzip = GzBuilder::new()
        .mtime(epoch)
        .operating_system(255)
        .write(Vec::new(), Compression::best());
    let mut tar = tar::Builder::new(gzip);
    for (path, entry) in tree {
        let path = format!("{root}/{path}");
        let mut header = tar::Header::new_gnu();
        header.set_mtime(epoch.into());
        header.set_uid(0);
        header.set_gid(0);
        match entry {
            Content::File { bytes, executable } => {
                header.set_mode(mode(*executable));
                header.set_size(bytes.len() as u64);
                tar.append_data(&mut header, path, bytes.as_slice())?;
            }
            Content::Link(to) => {
                header.set_entry_type(tar::EntryType::Symlink);
                header.set_mode(0o777);
                header.set_size(0);
                tar.append_link(&mut header, path, to)?;
            }
        }
    }
    tar.into_inner()?.finish()
}

/// A zip archive of the same kind, for Windows, where nothing is linked. Its times are those of
/// the format's first day, since the format knows no time zone.
pub fn zip(root: &str, tree: &Tree) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (path, entry) in tree {
        let Content::File { bytes, executable } = entry else {
            return Err(format!("{path}: an archive for Windows has no links").into());
        };
        let options = SimpleFileOptions::default()
            .last_modified_time(zip::DateTime::default())
            .unix_permissions(mode(*executable));
        zip.start_file(format!("{root}/{path}"), options)?;
        zip.write_all(bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}

fn mode(executable: bool) -> u32 {
    if executable { 0o755 } else { 0o644 }
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    fn tree() -> Tree {
        Tree::from([
            (
                "lib/libjcas.so".to_owned(),
                Content::Link("libjcas.so.0.1".to_owned()),
            ),
            (
                "bin/jcas".to_owned(),
                Content::File {
                    bytes: b"program".to_vec(),
                    executable: true,
                },
            ),
            ("LICENSE-MIT".to_owned(), Content::file("text")),
        ])
    }

    #[test]
    fn a_tar_archive_is_sorted_and_has_no_owner_and_one_time() {
        let bytes = tar_gz("jcas-1", &tree(), 1_700_000_000).unwrap();
        // RFC 1952: bytes 4 to 7 are the time, byte 9 is the system, 255 for unknown.
        assert_eq!(bytes[4..8], 1_700_000_000_u32.to_le_bytes());
        assert_eq!(bytes[9], 255);
        let mut tar = tar::Archive::new(flate2::read::GzDecoder::new(bytes.as_slice()));
        let mut seen = Vec::new();
        for entry in tar.entries().unwrap() {
            let header = entry.unwrap().header().clone();
            assert_eq!(header.mtime().unwrap(), 1_700_000_000);
            assert_eq!((header.uid().unwrap(), header.gid().unwrap()), (0, 0));
            let link = header
                .link_name()
                .unwrap()
                .map(|to| to.display().to_string());
            let path = header.path().unwrap().display().to_string();
            seen.push((path, header.mode().unwrap(), link));
        }
        let expected = [
            ("jcas-1/LICENSE-MIT", 0o644, None),
            ("jcas-1/bin/jcas", 0o755, None),
            (
                "jcas-1/lib/libjcas.so",
                0o777,
                Some("libjcas.so.0.1".to_owned()),
            ),
        ];
        assert_eq!(
            seen,
            expected.map(|(path, mode, link)| (path.to_owned(), mode, link))
        );
    }

    #[test]
    fn a_zip_archive_holds_the_files_and_refuses_links() {
        assert!(zip("jcas-1", &tree()).is_err());
        let mut tree = tree();
        tree.remove("lib/libjcas.so");
        let bytes = zip("jcas-1", &tree).unwrap();
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        let names: Vec<_> = archive.file_names().map(str::to_owned).collect();
        assert_eq!(names, ["jcas-1/LICENSE-MIT", "jcas-1/bin/jcas"]);
        let mut text = String::new();
        let mut file = archive.by_name("jcas-1/LICENSE-MIT").unwrap();
        file.read_to_string(&mut text).unwrap();
        assert_eq!(text, "text");
        assert_eq!(file.last_modified().unwrap().year(), 1980);
    }
}
