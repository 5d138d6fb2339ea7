//! TensorBoard event files: length-framed protobuf records with masked CRC-32C checksums.
//!
//! The messages are the few fields of `tensorflow/core/util/event.proto` and `summary.proto` that
//! a scalar needs.

use crate::error::TrainError;
use prost::Message;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

#[derive(Clone, PartialEq, Message)]
struct Event {
    #[prost(double, tag = "1")]
    wall_time: f64,
    #[prost(int64, tag = "2")]
    step: i64,
    #[prost(string, optional, tag = "3")]
    file_version: Option<String>,
    #[prost(message, optional, tag = "5")]
    summary: Option<Summary>,
}

#[derive(Clone, PartialEq, Message)]
struct Summary {
    #[prost(message, repeated, tag = "1")]
    value: Vec<Value>,
}

#[derive(Clone, PartialEq, Message)]
struct Value {
    #[prost(string, tag = "1")]
    tag: String,
    #[prost(float, optional, tag = "2")]
    simple_value: Option<f32>,
}

/// CRC-32C as the record format masks it (TensorFlow, `crc32c.h`).
fn masked_crc(bytes: &[u8]) -> u32 {
    crc32c::crc32c(bytes)
        .rotate_right(15)
        .wrapping_add(0xa282_ead8)
}

/// A record: length, its checksum, data, its checksum.
fn frame(data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u64).to_le_bytes();
    let mut record = length.to_vec();
    record.extend(masked_crc(&length).to_le_bytes());
    record.extend(data);
    record.extend(masked_crc(data).to_le_bytes());
    record
}

/// An event file being written.
pub struct EventFile {
    path: PathBuf,
    file: File,
}

impl EventFile {
    /// A new file in `folder`; TensorBoard reads all files of a folder as one run, so a resumed run
    /// simply begins another.
    pub fn create(folder: &Path) -> Result<EventFile, TrainError> {
        let now = now();
        let name = format!(
            "events.out.tfevents.{:010}.{}.jcas",
            now as u64,
            std::process::id()
        );
        let path = folder.join(name);
        let file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .map_err(TrainError::file(&path))?;
        let mut events = EventFile { path, file };
        events.record(&Event {
            wall_time: now,
            file_version: Some("brain.Event:2".to_owned()),
            ..Event::default()
        })?;
        Ok(events)
    }

    /// Scalars of one step.
    pub fn scalars(&mut self, step: u64, scalars: &[(&str, f64)]) -> Result<(), TrainError> {
        let value = scalars
            .iter()
            .map(|&(tag, value)| Value {
                tag: tag.to_owned(),
                simple_value: Some(value as f32),
            })
            .collect();
        self.record(&Event {
            wall_time: now(),
            step: step as i64,
            file_version: None,
            summary: Some(Summary { value }),
        })
    }

    fn record(&mut self, event: &Event) -> Result<(), TrainError> {
        let record = frame(&event.encode_to_vec());
        self.file
            .write_all(&record)
            .map_err(TrainError::file(&self.path))
    }
}

fn now() -> f64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0.0, |time| time.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    // RFC 3720, B.4: CRC-32C of 32 zero bytes is 0x8a9136aa.
    #[test]
    fn the_checksum_is_the_masked_castagnoli_one() {
        let crc = 0x8a91_36aa_u32;
        let masked = crc.rotate_right(15).wrapping_add(0xa282_ead8);
        assert_eq!(masked_crc(&[0; 32]), masked);
    }

    #[test]
    fn records_read_back() {
        let folder = std::env::temp_dir().join(format!("jcas-events-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mut events = EventFile::create(&folder).unwrap();
        events.scalars(7, &[("a", 1.5), ("b", -2.0)]).unwrap();
        let bytes = std::fs::read(&events.path).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();

        let mut rest = &bytes[..];
        let mut read = Vec::new();
        while !rest.is_empty() {
            let length = u64::from_le_bytes(rest[..8].try_into().unwrap()) as usize;
            assert_eq!(frame(&rest[12..12 + length]), rest[..16 + length]);
            read.push(Event::decode(&rest[12..12 + length]).unwrap());
            rest = &rest[16 + length..];
        }
        assert_eq!(read[0].file_version.as_deref(), Some("brain.Event:2"));
        assert_eq!(read[1].step, 7);
        let values = &read[1].summary.as_ref().unwrap().value;
        assert_eq!(
            (values[1].tag.as_str(), values[1].simple_value),
            ("b", Some(-2.0))
        );
    }
}
