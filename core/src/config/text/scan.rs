//! Walks over a text without changing or copying it. Both forms share their values: what differs is
//! how entries are parted, what counts as space, and how numbers may be written.

use super::value::{Pairs, number};
use super::{Excerpt, Form, TextError, TextValue};

pub(super) struct Scanner<'t> {
    text: &'t str,
    form: Form,
    at: usize,
    entries: u32,
    closed: bool,
}

impl<'t> Scanner<'t> {
    pub(super) const fn new(text: &'t str, form: Form) -> Self {
        Self {
            text,
            form,
            at: 0,
            entries: 0,
            closed: false,
        }
    }

    /// The next key and where its value begins; `None` at the end of the text.
    pub(super) fn entry(&mut self) -> Result<Option<(&'t str, usize)>, TextError> {
        if self.closed {
            return Ok(None);
        }
        let key = match self.form {
            Form::Toml => self.toml_key()?,
            Form::Json => self.json_key()?,
        };
        let Some(key) = key else {
            self.closed = true;
            return Ok(None);
        };
        self.entries += 1;
        let begin = self.at;
        self.value()?;
        if self.form == Form::Toml {
            self.line_end()?;
        }
        Ok(Some((key, begin)))
    }

    /// The value that begins somewhere, and how it is written.
    pub(super) fn value_at(&mut self, begin: usize) -> Result<(TextValue<'t>, &'t str), TextError> {
        self.at = begin;
        let value = self.value()?;
        Ok((value, &self.text[begin..self.at]))
    }

    /// The value that is the whole text.
    pub(super) fn lone_value(&mut self) -> Result<TextValue<'t>, TextError> {
        let value = self.value()?;
        if self.at == self.text.len() {
            Ok(value)
        } else {
            Err(self.expected("one value"))
        }
    }

    fn toml_key(&mut self) -> Result<Option<&'t str>, TextError> {
        self.skip_space(true);
        let begin = self.at;
        let key = match self.peek() {
            None => return Ok(None),
            Some(b'"' | b'\'') => self.string()?,
            Some(b'[') => {
                return Err(self.expected("a line FIELD = VALUE; a configuration has no tables"));
            }
            _ => self.bare("a key")?,
        };
        self.skip_space(false);
        if self.peek() == Some(b'.') {
            self.at = begin;
            return Err(self.unknown_line());
        }
        self.take(b'=', "an = after the key")?;
        self.skip_space(false);
        Ok(Some(key))
    }

    fn json_key(&mut self) -> Result<Option<&'t str>, TextError> {
        self.skip_space(true);
        if self.entries == 0 {
            self.take(b'{', "an object in braces")?;
            self.skip_space(true);
        }
        if self.peek() == Some(b'}') {
            self.at += 1;
            self.skip_space(true);
            return if self.at == self.text.len() {
                Ok(None)
            } else {
                Err(self.expected("the end of the text"))
            };
        }
        if self.entries > 0 {
            self.take(b',', "a comma or a closing brace")?;
            self.skip_space(true);
        }
        if self.peek() != Some(b'"') {
            return Err(self.expected("a key in quotes"));
        }
        let key = self.string()?;
        self.skip_space(true);
        self.take(b':', "a colon after the key")?;
        self.skip_space(true);
        Ok(Some(key))
    }

    fn value(&mut self) -> Result<TextValue<'t>, TextError> {
        match self.peek() {
            Some(b'"') => Ok(TextValue::Name(self.string()?)),
            Some(b'\'') if self.form == Form::Toml => Ok(TextValue::Name(self.string()?)),
            Some(b'[') => self.list(),
            Some(b'{') => Ok(self.rest()),
            _ => self.plain(),
        }
    }

    /// A number or a word.
    fn plain(&mut self) -> Result<TextValue<'t>, TextError> {
        let begin = self.at;
        let word = self.bare("a value")?;
        let toml = self.form == Form::Toml;
        if let Some(number) = number(word, toml) {
            return Ok(number);
        }
        match word {
            "true" | "false" => Ok(TextValue::Other),
            "null" if !toml => Ok(TextValue::Null),
            _ => {
                self.at = begin;
                Err(self.expected("a number, a text in quotes or a list of pairs"))
            }
        }
    }

    /// A list, of pairs of numbers or of anything else.
    fn list(&mut self) -> Result<TextValue<'t>, TextError> {
        let begin = self.at;
        if self.pairs(|_, _| ())? {
            return Ok(TextValue::Pairs(Pairs::new(
                &self.text[begin..self.at],
                self.form,
            )));
        }
        // Nothing that a field takes.
        self.at = begin;
        Ok(self.rest())
    }

    /// Passes on each pair of a list; `false` where something else is in it.
    pub(super) fn pairs(
        &mut self,
        mut each: impl FnMut(TextValue<'t>, TextValue<'t>),
    ) -> Result<bool, TextError> {
        self.at += 1;
        loop {
            self.skip_space(true);
            match self.peek() {
                Some(b']') => {
                    self.at += 1;
                    return Ok(true);
                }
                Some(b'[') => {
                    self.at += 1;
                    let first = self.coordinate(b',')?;
                    let second = self.coordinate(b']')?;
                    each(first, second);
                }
                None => return Err(self.expected("a closing bracket")),
                Some(_) => return Ok(false),
            }
            self.skip_space(true);
            match self.peek() {
                Some(b',') => {
                    self.at += 1;
                    self.skip_space(true);
                    if self.peek() == Some(b']') && self.form == Form::Json {
                        return Err(self.expected("a pair after the comma"));
                    }
                }
                Some(b']') => {}
                _ => return Err(self.expected("a comma or a closing bracket")),
            }
        }
    }

    /// A number within a pair, with what follows it.
    fn coordinate(&mut self, after: u8) -> Result<TextValue<'t>, TextError> {
        self.skip_space(true);
        let value = self.plain()?;
        self.skip_space(true);
        self.take(after, "a pair [x, y]")?;
        Ok(value)
    }

    /// What no field takes: the rest of the line stands for it in the message.
    fn rest(&mut self) -> TextValue<'t> {
        let line = self.text[self.at..].find('\n');
        self.at = line.map_or(self.text.len(), |end| self.at + end);
        TextValue::Other
    }

    /// A text in quotes, without them.
    fn string(&mut self) -> Result<&'t str, TextError> {
        let quote = self.text.as_bytes()[self.at];
        let begin = self.at + 1;
        let mut end = begin;
        let bytes = self.text.as_bytes();
        loop {
            match bytes.get(end) {
                Some(byte) if *byte == quote => break,
                Some(b'\\') if quote == b'"' => end += 2,
                Some(byte) if *byte >= b' ' || *byte == b'\t' => end += 1,
                _ => return Err(self.expected("a text that ends with a quote on its line")),
            }
        }
        self.at = end + 1;
        Ok(&self.text[begin..end])
    }

    /// A run of the characters of keys, numbers and words.
    fn bare(&mut self, expected: &'static str) -> Result<&'t str, TextError> {
        let begin = self.at;
        while self
            .peek()
            .is_some_and(|byte| byte.is_ascii_alphanumeric() || b"_-+.".contains(&byte))
        {
            // A dot is part of a number, never of a key.
            if self.peek() == Some(b'.') && expected == "a key" {
                break;
            }
            self.at += 1;
        }
        if self.at == begin {
            return Err(self.expected(expected));
        }
        Ok(&self.text[begin..self.at])
    }

    /// A key that leads into a table; configurations are flat.
    fn unknown_line(&self) -> TextError {
        let line = self.text[self.at..].lines().next().unwrap_or_default();
        let key = line.split('=').next().unwrap_or_default().trim_end();
        TextError::Unknown(Excerpt::of(key), None)
    }

    fn line_end(&mut self) -> Result<(), TextError> {
        self.skip_space(false);
        match self.peek() {
            None | Some(b'\n' | b'#') => Ok(()),
            Some(b'\r') if self.text.as_bytes().get(self.at + 1) == Some(&b'\n') => Ok(()),
            _ => Err(self.expected("the end of the line")),
        }
    }

    /// Skips blanks and, where `lines`, line ends; with them TOML's comments.
    fn skip_space(&mut self, lines: bool) {
        while let Some(byte) = self.peek() {
            match byte {
                b' ' | b'\t' => self.at += 1,
                b'\n' | b'\r' if lines => self.at += 1,
                b'#' if lines && self.form == Form::Toml => {
                    self.rest();
                }
                _ => return,
            }
        }
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn take(&mut self, byte: u8, expected: &'static str) -> Result<(), TextError> {
        if self.peek() == Some(byte) {
            self.at += 1;
            Ok(())
        } else {
            Err(self.expected(expected))
        }
    }

    fn expected(&self, expected: &'static str) -> TextError {
        let before = &self.text.as_bytes()[..self.at.min(self.text.len())];
        let line_begin = before
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |at| at + 1);
        TextError::Syntax {
            line: before.iter().filter(|byte| **byte == b'\n').count() as u32 + 1,
            column: (before.len() - line_begin) as u32 + 1,
            expected,
        }
    }
}
