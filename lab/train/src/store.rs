//! Files that are whole or absent, and numbers in safetensors.

use crate::error::{FormatError, TrainError};
use safetensors::tensor::{Dtype, TensorView};
use std::borrow::Cow;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

/// Key of the one metadata entry that holds everything that is no array, as JSON.
const NOTES: &str = "jcas";

/// Rows as CSV, with a line of names or without; `path` is what errors name.
pub fn csv_bytes<T: serde::Serialize>(
    rows: &[T],
    names: bool,
    path: &Path,
) -> Result<Vec<u8>, TrainError> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(names)
        .from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(TrainError::format(path))?;
    }
    let bytes = writer.into_inner();
    bytes.map_err(|error| TrainError::format(path)(FormatError::CsvWriter(error.to_string())))
}

/// Writes under a temporary name beside `path`, flushes to disk and renames. A crash at any moment
/// leaves the old file or the new one.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), TrainError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let temporary = path.with_file_name(name);
    let write = || -> std::io::Result<()> {
        let mut file = File::create(&temporary)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&temporary, path)
    };
    write().map_err(TrainError::file(path))
}

/// An array under its name.
pub struct Array {
    name: String,
    dtype: Dtype,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Array {
    /// Of f32.
    pub fn f32(name: &str, shape: &[usize], values: &[f32]) -> Array {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        Array {
            name: name.to_owned(),
            dtype: Dtype::F32,
            shape: shape.to_vec(),
            bytes,
        }
    }

    /// Of f32 values rounded to half precision.
    pub fn f16(name: &str, shape: &[usize], values: &[f32]) -> Array {
        let bytes = values
            .iter()
            .flat_map(|&x| half::f16::from_f32(x).to_le_bytes())
            .collect();
        Array {
            name: name.to_owned(),
            dtype: Dtype::F16,
            shape: shape.to_vec(),
            bytes,
        }
    }

    /// Of f64.
    pub fn f64(name: &str, values: &[f64]) -> Array {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        Array {
            name: name.to_owned(),
            dtype: Dtype::F64,
            shape: vec![values.len()],
            bytes,
        }
    }

    /// Of bytes.
    pub fn bytes(name: &str, bytes: Vec<u8>) -> Array {
        Array {
            name: name.to_owned(),
            dtype: Dtype::U8,
            shape: vec![bytes.len()],
            bytes,
        }
    }
}

/// One safetensors file: arrays and a JSON note. Equal content gives equal bytes.
pub fn encode(arrays: &[Array], notes: &str) -> Result<Vec<u8>, FormatError> {
    let views: Vec<(&str, TensorView)> = arrays
        .iter()
        .map(|array| {
            TensorView::new(array.dtype, array.shape.clone(), &array.bytes)
                .map(|view| (array.name.as_str(), view))
        })
        .collect::<Result<_, safetensors::SafeTensorError>>()?;
    let notes = HashMap::from([(NOTES.to_owned(), notes.to_owned())]);
    Ok(safetensors::serialize(views, Some(notes))?)
}

/// Arrays of a file that was read.
pub struct Arrays<'a> {
    tensors: safetensors::SafeTensors<'a>,
    /// The JSON note; files of other programs have none.
    pub notes: Option<String>,
}

impl<'a> Arrays<'a> {
    /// Reads a file's bytes.
    pub fn decode(bytes: &'a [u8]) -> Result<Arrays<'a>, FormatError> {
        let (_, metadata) = safetensors::SafeTensors::read_metadata(bytes)?;
        let notes = metadata
            .metadata()
            .as_ref()
            .and_then(|notes| notes.get(NOTES).cloned());
        Ok(Arrays {
            tensors: safetensors::SafeTensors::deserialize(bytes)?,
            notes,
        })
    }

    fn raw(&self, name: &str) -> Result<(Dtype, Cow<'a, [u8]>), FormatError> {
        let view = self
            .tensors
            .tensor(name)
            .map_err(|_| FormatError::Missing(name.to_owned()))?;
        Ok((view.dtype(), Cow::Borrowed(view.data())))
    }

    /// An array of f32 (or of f16, widened) of exactly `length` entries.
    pub fn f32(&self, name: &str, length: usize) -> Result<Vec<f32>, FormatError> {
        let (dtype, bytes) = self.raw(name)?;
        let values: Vec<f32> = match dtype {
            Dtype::F32 => bytes
                .chunks_exact(4)
                .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                .collect(),
            Dtype::F16 => bytes
                .chunks_exact(2)
                .map(|b| half::f16::from_le_bytes([b[0], b[1]]).to_f32())
                .collect(),
            other => return Err(wrong_type(name, other, "F32, F16")),
        };
        check_length(name, values.len(), length)?;
        Ok(values)
    }

    /// An array of f64 of exactly `length` entries.
    pub fn f64(&self, name: &str, length: usize) -> Result<Vec<f64>, FormatError> {
        let (dtype, bytes) = self.raw(name)?;
        if dtype != Dtype::F64 {
            return Err(wrong_type(name, dtype, "F64"));
        }
        let eight = |b: &[u8]| f64::from_le_bytes(b.try_into().expect("chunks of eight"));
        let values: Vec<f64> = bytes.chunks_exact(8).map(eight).collect();
        check_length(name, values.len(), length)?;
        Ok(values)
    }

    /// Bytes.
    pub fn bytes(&self, name: &str) -> Result<Cow<'a, [u8]>, FormatError> {
        self.raw(name).map(|(_, bytes)| bytes)
    }
}

fn check_length(name: &str, got: usize, expected: usize) -> Result<(), FormatError> {
    if got == expected {
        Ok(())
    } else {
        Err(FormatError::Length {
            name: name.to_owned(),
            got,
            expected,
        })
    }
}

fn wrong_type(name: &str, got: Dtype, allowed: &'static str) -> FormatError {
    FormatError::Type {
        name: name.to_owned(),
        got: format!("{got:?}"),
        allowed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_another_program_is_read_without_a_note() {
        let weight = Array::f32("0.weight", &[1, 2], &[0.5, -1.0]);
        let ours = encode(&[weight], "{}").unwrap();
        assert_eq!(Arrays::decode(&ours).unwrap().notes.as_deref(), Some("{}"));

        let data: Vec<u8> = [0.5f32, -1.0]
            .iter()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        let view = safetensors::tensor::TensorView::new(Dtype::F32, vec![1, 2], &data).unwrap();
        let theirs = safetensors::serialize([("0.weight", view)], None).unwrap();
        let arrays = Arrays::decode(&theirs).unwrap();
        assert_eq!(arrays.notes, None);
        assert_eq!(arrays.f32("0.weight", 2).unwrap(), [0.5, -1.0]);
    }
}
