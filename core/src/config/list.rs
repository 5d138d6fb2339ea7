//! A list with a fixed capacity, which a configuration holds without an allocation.

/// A type that a [`List`] can hold.
pub trait Element: Copy + PartialEq {
    /// What fills the unused places.
    const BLANK: Self;
    /// What a file has for the elements.
    const NAMES: &'static str;
}

/// A list of up to `N` elements.
#[derive(Clone, Copy, Debug)]
pub struct List<T, const N: usize> {
    elements: [T; N],
    count: usize,
}

impl<T: Element, const N: usize> PartialEq for List<T, N> {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl<T: Element, const N: usize> List<T, N> {
    /// No element.
    pub const EMPTY: Self = Self {
        elements: [T::BLANK; N],
        count: 0,
    };

    /// The given elements; `None` if there are more than `N`.
    #[must_use]
    pub fn from_slice(elements: &[T]) -> Option<Self> {
        let mut list = Self::EMPTY;
        for element in elements {
            list.push(*element)?;
        }
        Some(list)
    }

    /// Adds an element; `None` if the list is full.
    pub(super) fn push(&mut self, element: T) -> Option<()> {
        *self.elements.get_mut(self.count)? = element;
        self.count += 1;
        Some(())
    }

    /// The elements.
    #[must_use]
    pub fn as_slice(&self) -> &[T] {
        &self.elements[..self.count]
    }

    /// Number of elements.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }
}

#[cfg(feature = "serde")]
mod serde_impl {
    use super::{Element, List};
    use core::fmt;
    use core::marker::PhantomData;
    use serde::de::{Error, SeqAccess, Visitor};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    impl<T: Element + Serialize, const N: usize> Serialize for List<T, N> {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            serializer.collect_seq(self.as_slice())
        }
    }

    struct Elements<T, const N: usize>(PhantomData<T>);

    impl<'de, T: Element + Deserialize<'de>, const N: usize> Visitor<'de> for Elements<T, N> {
        type Value = List<T, N>;

        fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(out, "a list of at most {N} {}", T::NAMES)
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
            let mut list = List::EMPTY;
            while let Some(element) = sequence.next_element()? {
                list.push(element)
                    .ok_or_else(|| A::Error::invalid_length(N + 1, &self))?;
            }
            Ok(list)
        }
    }

    impl<'de, T: Element + Deserialize<'de>, const N: usize> Deserialize<'de> for List<T, N> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            deserializer.deserialize_seq(Elements(PhantomData))
        }
    }
}
