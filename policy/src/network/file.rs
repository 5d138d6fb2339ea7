//! Arrays in a safetensors file, read in place.
//!
//! The file begins with eight bytes: the length of its header (little-endian). The header is a JSON
//! object with the type, shape and place of each array. The bytes of the arrays follow. Everything
//! is checked once, when the file is opened. Every loop consumes at least one byte of the header.

use half::f16;

use super::error::{ArrayName, LoadError};

/// The maximum length of a header, in bytes.
pub const HEADER_MAX: usize = 1 << 20;

/// The type of the elements of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Element {
    /// IEEE 754 binary16.
    Half,
    /// IEEE 754 binary32.
    Single,
}

impl Element {
    const fn width(self) -> usize {
        match self {
            Self::Half => 2,
            Self::Single => 4,
        }
    }
}

/// An array within the file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Array<'a> {
    pub(crate) name: &'a str,
    /// Rows and columns; one row where the array has one dimension.
    pub(crate) shape: [usize; 2],
    element: Element,
    bytes: &'a [u8],
}

impl Array<'_> {
    /// Returns the elements, row by row, widened to f32.
    pub(crate) fn values(&self) -> impl Iterator<Item = f32> {
        self.bytes
            .chunks_exact(self.element.width())
            .map(|bytes| match *bytes {
                [a, b] => f16::from_le_bytes([a, b]).to_f32(),
                [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
                _ => f32::NAN,
            })
    }
}

/// A file with a header that has been checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct File<'a> {
    header: &'a str,
    data: &'a [u8],
    /// The number of arrays in the header.
    pub(crate) count: usize,
    /// The entry `jcas` of the file's metadata; empty where there is none.
    pub(crate) metadata: &'a str,
}

/// Returns the range of an array in `data_len` bytes. It goes from `start` to `end`, and must hold
/// `elements` of `width` bytes each.
pub(crate) fn place(
    [start, end]: [usize; 2],
    elements: usize,
    width: usize,
    data_len: usize,
) -> Result<core::ops::Range<usize>, LoadError> {
    if start > end || end > data_len {
        return Err(LoadError::Truncated);
    }
    match elements.checked_mul(width) {
        Some(length) if length == end - start => Ok(start..end),
        _ => Err(LoadError::Header(
            "data_offsets and shape of an array disagree",
        )),
    }
}

/// Splits a file into its header and the data after it.
pub(crate) fn split(bytes: &[u8]) -> Result<(&[u8], &[u8]), LoadError> {
    let (length, rest) = bytes.split_first_chunk::<8>().ok_or(LoadError::Truncated)?;
    let length = u64::from_le_bytes(*length);
    if length > HEADER_MAX as u64 {
        return Err(LoadError::Header("is longer than 1 MiB"));
    }
    rest.split_at_checked(length as usize)
        .ok_or(LoadError::Truncated)
}

/// Appends a decimal digit to a number. Returns `None` on overflow.
pub(crate) fn with_digit(number: usize, digit: u8) -> Option<usize> {
    number.checked_mul(10)?.checked_add(usize::from(digit))
}

impl<'a> File<'a> {
    /// Checks a whole file.
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Self, LoadError> {
        let (header, data) = split(bytes)?;
        let header = core::str::from_utf8(header).map_err(|_| LoadError::Header("is not UTF-8"))?;
        let mut file = Self {
            header,
            data,
            count: 0,
            metadata: "",
        };
        let mut used = 0usize;
        let mut entries = Entries::new(file)?;
        while let Some(entry) = entries.next()? {
            match entry {
                Entry::Metadata(metadata) => file.metadata = metadata,
                Entry::Array(array) => {
                    file.count += 1;
                    used = used.saturating_add(array.bytes.len());
                }
            }
        }
        if used != data.len() {
            return Err(LoadError::Header("does not account for every byte of data"));
        }
        Ok(file)
    }

    /// Returns the array of a name, if the file has it.
    pub(crate) fn find(&self, name: ArrayName) -> Result<Option<Array<'a>>, LoadError> {
        let mut entries = Entries::new(*self)?;
        while let Some(entry) = entries.next()? {
            match entry {
                Entry::Array(array) if name.is(array.name) => return Ok(Some(array)),
                _ => {}
            }
        }
        Ok(None)
    }
}

enum Entry<'a> {
    Metadata(&'a str),
    Array(Array<'a>),
}

/// Reads the header's entries one after the other.
struct Entries<'a> {
    text: &'a str,
    data: &'a [u8],
    at: usize,
    first: bool,
}

impl<'a> Entries<'a> {
    fn new(file: File<'a>) -> Result<Self, LoadError> {
        let mut entries = Self {
            text: file.header,
            data: file.data,
            at: 0,
            first: true,
        };
        entries.expect(b'{')?;
        Ok(entries)
    }

    fn next(&mut self) -> Result<Option<Entry<'a>>, LoadError> {
        if !self.follows(self.first, b'}')? {
            self.skip_space();
            return if self.at == self.text.len() {
                Ok(None)
            } else {
                Err(LoadError::Header("goes on after its object"))
            };
        }
        self.first = false;
        let name = self.string()?;
        self.expect(b':')?;
        if name == "__metadata__" {
            return self
                .metadata()
                .map(|metadata| Some(Entry::Metadata(metadata)));
        }
        self.array(name).map(|array| Some(Entry::Array(array)))
    }

    /// Reads an object of strings and returns the value of `jcas`.
    fn metadata(&mut self) -> Result<&'a str, LoadError> {
        self.expect(b'{')?;
        let (mut first, mut metadata) = (true, "");
        while self.follows(first, b'}')? {
            first = false;
            let key = self.string()?;
            self.expect(b':')?;
            let value = self.string()?;
            if key == "jcas" {
                metadata = value;
            }
        }
        Ok(metadata)
    }

    fn array(&mut self, name: &'a str) -> Result<Array<'a>, LoadError> {
        self.expect(b'{')?;
        let (mut element, mut shape, mut offsets) = (None, None, None);
        let mut first = true;
        while self.follows(first, b'}')? {
            first = false;
            let key = self.string()?;
            self.expect(b':')?;
            match key {
                "dtype" => {
                    element = Some(match self.string()? {
                        "F16" => Element::Half,
                        "F32" => Element::Single,
                        _ => {
                            return Err(LoadError::Header(
                                "has an array that is neither F16 nor F32",
                            ));
                        }
                    });
                }
                "shape" => shape = Some(self.numbers()?),
                "data_offsets" => offsets = Some(self.numbers()?),
                _ => return Err(LoadError::Header("has an array with an unknown entry")),
            }
        }
        let (Some(element), Some(shape), Some(([start, end], 2))) = (element, shape, offsets)
        else {
            return Err(LoadError::Header(
                "has an array without dtype, shape or data_offsets",
            ));
        };
        let shape = match shape {
            ([columns, _], 1) => [1, columns],
            (shape, 2) => shape,
            _ => {
                return Err(LoadError::Header(
                    "has an array of other than one or two dimensions",
                ));
            }
        };
        let elements = shape[0]
            .checked_mul(shape[1])
            .ok_or(LoadError::Header("has an array that is too large"))?;
        let range = place([start, end], elements, element.width(), self.data.len())?;
        let bytes = self.data.get(range).ok_or(LoadError::Truncated)?;
        Ok(Array {
            name,
            shape,
            element,
            bytes,
        })
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn skip_space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    fn expect(&mut self, byte: u8) -> Result<(), LoadError> {
        self.skip_space();
        if self.peek() == Some(byte) {
            self.at += 1;
            Ok(())
        } else {
            Err(LoadError::Header("is not JSON of the expected form"))
        }
    }

    /// Returns whether another element follows in a list. Consumes the comma before it, or the
    /// closing byte.
    fn follows(&mut self, first: bool, close: u8) -> Result<bool, LoadError> {
        self.skip_space();
        if self.peek() == Some(close) {
            self.at += 1;
            return Ok(false);
        }
        if !first {
            self.expect(b',')?;
        }
        Ok(true)
    }

    /// Reads a string verbatim, without resolving escapes.
    fn string(&mut self) -> Result<&'a str, LoadError> {
        self.expect(b'"')?;
        let start = self.at;
        while let Some(byte) = self.peek() {
            self.at += 1;
            match byte {
                b'"' => {
                    return self
                        .text
                        .get(start..self.at - 1)
                        .ok_or(LoadError::Header("is not UTF-8"));
                }
                b'\\' => self.at += 1,
                _ => {}
            }
        }
        Err(LoadError::Header("ends within a string"))
    }

    /// Reads a list of at most two numbers, and returns their count with them.
    fn numbers(&mut self) -> Result<([usize; 2], usize), LoadError> {
        self.expect(b'[')?;
        let (mut numbers, mut count) = ([0; 2], 0);
        while self.follows(count == 0, b']')? {
            let number = self.number()?;
            let place = numbers
                .get_mut(count)
                .ok_or(LoadError::Header("has a list of more than two numbers"))?;
            *place = number;
            count += 1;
        }
        Ok((numbers, count))
    }

    fn number(&mut self) -> Result<usize, LoadError> {
        self.skip_space();
        let start = self.at;
        let mut number = 0usize;
        while let Some(digit @ b'0'..=b'9') = self.peek() {
            number = with_digit(number, digit - b'0')
                .ok_or(LoadError::Header("has a number that is too large"))?;
            self.at += 1;
        }
        if self.at == start {
            return Err(LoadError::Header("is not JSON of the expected form"));
        }
        Ok(number)
    }
}
