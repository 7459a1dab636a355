//! Choices: enums whose values have a word each, for files, menus and the command line.

use crate::raster::Light;

/// A choice among words.
pub trait Words: Copy + PartialEq + 'static {
    /// Every value, in the order of menus.
    const ALL: &'static [Self];
    /// Their kebab-case words, in the same order.
    const WORDS: &'static [&'static str];
    /// Its place in both.
    fn number(self) -> usize {
        Self::ALL.iter().position(|v| *v == self).unwrap_or_default()
    }
    /// Its word.
    fn word(self) -> &'static str {
        Self::WORDS[self.number()]
    }
}

impl Words for Light {
    const ALL: &'static [Self] = &[Self::Headlight, Self::Fixed];
    const WORDS: &'static [&'static str] = &["headlight", "fixed"];
}

/// Declares an enum with a word for each value; the first is the default.
macro_rules! words {
    ($(#[$about:meta])* $visible:vis enum $name:ident {
        $(#[$first_about:meta])* $first:ident = $first_word:literal,
        $($(#[$value_about:meta])* $value:ident = $word:literal,)*
    }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        $visible enum $name {
            $(#[$first_about])*
            #[default]
            $first,
            $($(#[$value_about])* $value,)*
        }
        impl $crate::method::Words for $name {
            const ALL: &'static [Self] = &[Self::$first, $(Self::$value,)*];
            const WORDS: &'static [&'static str] = &[$first_word, $($word,)*];
        }
    };
}
pub(crate) use words;
