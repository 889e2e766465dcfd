//! Each of these declares a part of the manifest once, and gives plain data, decoding with
//! faults, and the JSON Schema.

/// Numbers with a range: `Name = min ..= max, "unit";`, and a reason where the range is one of
/// physics: `Name = min ..= max, "unit", "reason";`.
macro_rules! number {
    ($($(#[doc = $doc:literal])+ $name:ident = $min:literal ..= $max:literal, $unit:literal $(, $reason:literal)?;)*) => {$(
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd, serde::Serialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl $name {
            /// What it may be, ends included.
            #[allow(dead_code, reason = "few are asked for it outside of a file")]
            pub const RANGE: std::ops::RangeInclusive<f64> = $min..=$max;
        }

        impl $crate::manifest::decode::Decode for $name {
            fn allowed() -> String {
                $crate::manifest::raw::values::number_allowed($min, $max, $unit)
            }

            fn decode(
                node: &$crate::manifest::decode::Node<'_>,
                report: &mut $crate::manifest::decode::Report<'_>,
            ) -> Option<Self> {
                $crate::manifest::raw::values::decode_number(
                    node,
                    $crate::manifest::raw::values::Range {
                        min: $min,
                        max: $max,
                        unit: $unit,
                        reason: concat!($($reason)?),
                    },
                    report,
                )
                .map(Self)
            }
        }

        impl schemars::JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({ "type": "number", "minimum": $min, "maximum": $max })
            }
        }
    )*};
}

/// The words for the values of an existing enum: `Type { Variant = "word", … }`.
macro_rules! choice {
    ($($name:ident { $($variant:ident = $word:literal,)+ })*) => {$(
        impl $crate::manifest::raw::values::Choice for $name {
            const WORDS: &'static [(&'static str, Self)] = &[$(($word, $name::$variant),)+];
        }

        impl $crate::manifest::decode::Decode for $name {
            fn allowed() -> String {
                $crate::manifest::raw::values::choice_allowed::<Self>()
            }

            fn decode(
                node: &$crate::manifest::decode::Node<'_>,
                report: &mut $crate::manifest::decode::Report<'_>,
            ) -> Option<Self> {
                $crate::manifest::raw::values::decode_choice(node, report)
            }
        }

        impl schemars::JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({ "enum": [$($word),+] })
            }
        }
    )*};
}

/// Texts of a fixed form: `Name = "regex", check, "allowed", "remedy";`.
macro_rules! pattern {
    ($($(#[doc = $doc:literal])+
       $name:ident = $regex:literal, $check:path, $allowed:literal, $remedy:literal;)*) => {$(
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
        #[serde(transparent)]
        pub struct $name(String);

        impl $crate::manifest::decode::Pattern for $name {
            const PATTERN: &'static str = $regex;
            const ALLOWED: &'static str = $allowed;
            const REMEDY: &'static str = $remedy;

            fn from_text(text: &str) -> Option<Self> {
                $check(text).then(|| Self(text.to_owned()))
            }

            fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl $crate::manifest::decode::Decode for $name {
            fn allowed() -> String {
                $allowed.to_owned()
            }

            fn decode(
                node: &$crate::manifest::decode::Node<'_>,
                report: &mut $crate::manifest::decode::Report<'_>,
            ) -> Option<Self> {
                $crate::manifest::raw::values::decode_pattern(node, report)
            }
        }

        impl schemars::JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({ "type": "string", "pattern": $regex })
            }
        }
    )*};
}

/// A table with known keys: those that are required, those that are optional, and what they
/// demand of each other.
macro_rules! record {
    (
        $(#[doc = $doc:literal])+
        pub struct $name:ident {
            required { $($(#[doc = $rdoc:literal])+ $r:ident: $rty:ty,)* }
            optional { $($(#[doc = $odoc:literal])+ $o:ident: $oty:ty,)* }
            rules [$($rule:expr),* $(,)?]
        }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        pub struct $name {
            $($(#[doc = $rdoc])+ pub $r: $rty,)*
            $(
                $(#[doc = $odoc])+
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $o: Option<$oty>,
            )*
        }

        impl $crate::manifest::decode::Record for $name {
            const KEYS: &'static [&'static str] = &[$(stringify!($r),)* $(stringify!($o),)*];
            const REQUIRED: usize = [$(stringify!($r),)* ""].len() - 1;
            const RULES: &'static [$crate::manifest::decode::Rule] = &[$($rule),*];

            #[allow(unused_variables, reason = "a record may have no keys of one sort")]
            fn decode_fields(
                node: &$crate::manifest::decode::Node<'_>,
                report: &mut $crate::manifest::decode::Report<'_>,
            ) -> Option<Self> {
                // Every field is decoded before the first fault ends it.
                $(let $r = $crate::manifest::decode::required(node, stringify!($r), report);)*
                $(let $o = $crate::manifest::decode::optional(node, stringify!($o), report);)*
                Some(Self { $($r: $r?,)* $($o,)* })
            }

            #[allow(unused_variables, reason = "a record may have no keys of one sort")]
            fn describe_fields(
                object: &mut $crate::manifest::decode::ObjectSchema,
                generator: &mut schemars::SchemaGenerator,
            ) {
                $(object.field::<$rty>(stringify!($r), &[$($rdoc),+], true, generator);)*
                $(object.field::<$oty>(stringify!($o), &[$($odoc),+], false, generator);)*
            }
        }

        impl $crate::manifest::decode::Decode for $name {
            fn allowed() -> String {
                "a table".to_owned()
            }

            fn decode(
                node: &$crate::manifest::decode::Node<'_>,
                report: &mut $crate::manifest::decode::Report<'_>,
            ) -> Option<Self> {
                $crate::manifest::decode::decode_record(node, report)
            }

            fn to_add(trail: &$crate::manifest::document::Trail, _key: &str) -> String {
                $crate::manifest::decode::table_to_add::<Self>(trail)
            }
        }

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).trim_start_matches("Raw").into()
            }

            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                $crate::manifest::decode::record_schema::<Self>(&[$($doc),+], generator)
            }
        }
    };
}

/// A record of one or several pictures, with the keys that say where they lie, and where they come
/// from, added; `placed by` brings the words for these.
macro_rules! placed_record {
    (
        $(#[doc = $doc:literal])+
        pub struct $name:ident {
            required { $($required:tt)* }
            optional { $($optional:tt)* }
            placed by {
                $(#[doc = $register:literal])+
                register,
                $(#[doc = $points:literal])+
                control_points,
                $(#[doc = $source:literal])+
                source,
            }
        }
    ) => {
        record! {
            $(#[doc = $doc])+
            pub struct $name {
                required { $($required)* }
                optional {
                    $($optional)*
                    $(#[doc = $register])+
                    register: RawRegister,
                    $(#[doc = $points])+
                    control_points: List<RawControlPoint, 1, 1000>,
                    /// What the points do: shift, similarity, affine or thin-plate. Without it: by
                    /// their number, and never bend.
                    fit: FitKind,
                    $(#[doc = $source])+
                    source: Source,
                }
                rules [
                    Rule::AtMostOne(&["register", "control_points"]),
                    Rule::Needs("fit", "control_points"),
                ]
            }
        }
    };
}

/// The kinds of something, each with a record of its own: `Variant(Record) = "word",`.
macro_rules! kinds {
    (
        $(#[doc = $doc:literal])+
        pub enum $name:ident { $($(#[doc = $vdoc:literal])+ $variant:ident($record:ty) = $word:literal,)+ }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        #[serde(tag = "kind")]
        pub enum $name {
            $($(#[doc = $vdoc])+ #[serde(rename = $word)] $variant($record),)+
        }

        impl $crate::manifest::decode::Kinds for $name {
            const WORDS: &'static [(&'static str, &'static [&'static str])] =
                &[$(($word, &[$($vdoc),+]),)+];

            fn keys(word: &str) -> &'static [&'static str] {
                match word {
                    $($word => <$record as $crate::manifest::decode::Record>::KEYS,)+
                    _ => &[],
                }
            }

            fn rules(word: &str) -> &'static [$crate::manifest::decode::Rule] {
                match word {
                    $($word => <$record as $crate::manifest::decode::Record>::RULES,)+
                    _ => &[],
                }
            }

            fn decode_fields(
                word: &str,
                node: &$crate::manifest::decode::Node<'_>,
                report: &mut $crate::manifest::decode::Report<'_>,
            ) -> Option<Self> {
                match word {
                    $($word => <$record as $crate::manifest::decode::Record>::decode_fields(node, report)
                        .map(Self::$variant),)+
                    _ => None,
                }
            }

            fn describe_fields(
                word: &str,
                object: &mut $crate::manifest::decode::ObjectSchema,
                generator: &mut schemars::SchemaGenerator,
            ) {
                match word {
                    $($word => <$record as $crate::manifest::decode::Record>::describe_fields(
                        object, generator,
                    ),)+
                    _ => {}
                }
            }
        }
    };
}

pub(crate) use {choice, kinds, number, pattern, placed_record, record};
