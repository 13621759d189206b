//! Keys of files, each declared once: name, type, what a file without it gets, unit, what is
//! allowed, a sentence. The macro `keys` makes of that the struct, its reader, its check and the rows of
//! `docs/keys.md`.

pub mod allowed;
pub mod numbers;
pub mod words;

use self::numbers::Span;

/// What a declaration says of a key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// As in the file.
    pub name: &'static str,
    /// Unit; empty of what has none.
    pub unit: &'static str,
    /// What may stand there.
    pub allowed: fn() -> String,
    /// The numbers that may stand there, where nothing but these numbers counts.
    pub span: fn() -> Option<Span>,
    /// What a file without the key gets.
    pub absent: fn() -> Absent,
    /// What it is.
    pub meaning: &'static str,
}

/// What a file without a key gets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Absent {
    /// An error.
    Refused,
    /// The same as with this value, as TOML.
    Value(String),
    /// What the words say.
    Said(&'static str),
}

/// A struct that is a table of a file.
///
/// A line is `/// sentence`, `name: Type`, ` as "key"` where the key has another name, ` = value`
/// for a file without the key with ` => "what that means"` where the value does not say it, unit,
/// and an [`Allowed`](allowed::Allowed) that `check_keys` holds the value against.
macro_rules! keys {
    (
        $(#[$about:meta])*
        $visible:vis struct $table:ident {$(
            $(#[doc = $meaning:literal])+
            $seen:vis $field:ident $(as $key:literal)? : $type:ty
                $(= $default:expr $(=> $said:expr)?)?, $unit:tt, $allowed:expr;
        )+}
    ) => {
        $(#[$about])*
        $visible struct $table {$(
            $(#[doc = $meaning])+
            #[doc = $crate::keys::keys!(@unit $unit)]
            $seen $field: $type,
        )+}

        impl $table {
            /// Its keys.
            pub(crate) const KEYS: &'static [$crate::keys::Key] = &[$(
                $crate::keys::Key {
                    name: $crate::keys::keys!(@key $field $($key)?),
                    unit: $unit,
                    allowed: || $crate::keys::allowed::Allowed::<$type>::text(&$allowed),
                    span: || $crate::keys::allowed::Allowed::<$type>::span(&$allowed),
                    absent: || $crate::keys::keys!(@absent [$type] $($default $(, $said)?)?),
                    meaning: concat!($($meaning),+),
                },
            )+];

            /// Checks each value by itself.
            ///
            /// # Errors
            /// The first key whose value is not allowed.
            fn check_keys(&self) -> Result<(), $crate::invalid::Invalid> {
                $($crate::keys::allowed::Allowed::<$type>::check(
                    &$allowed,
                    $crate::keys::keys!(@key $field $($key)?),
                    &self.$field,
                )?;)+
                Ok(())
            }
        }

        impl<'de> serde::Deserialize<'de> for $table {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                #[derive(serde::Deserialize)]
                #[serde(deny_unknown_fields)]
                struct Written {$(
                    $(#[serde(rename = $key)])?
                    $field: Option<$type>,
                )+}
                let written = Written::deserialize(deserializer)?;
                Ok(Self {$(
                    $field: match written.$field {
                        Some(value) => value,
                        None => $crate::keys::keys!(
                            @without $crate::keys::keys!(@key $field $($key)?), $($default)?
                        ),
                    },
                )+})
            }
        }
    };

    (@unit "") => { "" };
    (@unit $unit:literal) => { concat!("\\[", $unit, "\\]") };

    (@key $field:ident) => { stringify!($field) };
    (@key $field:ident $key:literal) => { $key };

    (@absent [$type:ty]) => { $crate::keys::Absent::Refused };
    (@absent [$type:ty] $default:expr, $said:expr) => { $crate::keys::Absent::Said($said) };
    (@absent [$type:ty] $default:expr) => {{
        let default: $type = $default;
        $crate::keys::Absent::Value($crate::keys::words::Toml::toml(&default))
    }};

    (@without $key:expr,) => {
        return Err(serde::de::Error::missing_field($key))
    };
    (@without $key:expr, $default:expr) => { $default };
}

pub(crate) use keys;
