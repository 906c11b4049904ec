//! Channels of an OpenEXR file that become the picture.
//!
//! Channels form groups: those of one part whose names agree up to the last point, such as `ViewLayer.Combined.R`. A group is a colour (R, G, B), a
//! vector (X, Y, Z), a luminance (Y), or other numbers. The use of the picture decides which is taken. Depth is no colour, and neither is a vector;
//! they are taken if they are asked for by name. A choice between equals is an error that lists all groups.

use exr::meta::attribute::SampleType;
use exr::meta::header::Header;

use super::statement::Purpose;

/// Channels of one part whose names agree up to the last point.
#[derive(Debug)]
pub(super) struct Group {
    /// Index of the part.
    part: usize,
    /// Name of the part, if there are several.
    part_name: String,
    /// Names of the channels up to the last point.
    prefix: String,
    /// Index of each channel within the part and its name behind the last point.
    channels: Vec<(usize, String)>,
}

/// Channels that become the picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Choice {
    /// Index of the part.
    pub(super) part: usize,
    /// Name of the layer; empty for the layer without a name.
    pub(super) layer: String,
    /// Indices of the channels for the first, second and third number of a pixel. Two are a normal without z.
    pub(super) channels: Vec<usize>,
}

/// Names of layers that hold the picture itself.
const MAIN_LAYERS: [&str; 8] = ["rgba", "rgb", "beauty", "combined", "color", "colour", "image", "composite"];
/// Names of layers that hold normals.
const NORMAL_LAYERS: [&str; 4] = ["normal", "normals", "n", "nrm"];
/// Names of layers and channels that hold heights.
const HEIGHT_LAYERS: [&str; 5] = ["height", "heights", "displacement", "disp", "bump"];
/// Most groups that a message lists.
const MAX_LISTED: usize = 40;

const RGB: [&[&str]; 3] = [&["r", "red"], &["g", "green"], &["b", "blue"]];
const XYZ: [&[&str]; 3] = [&["x"], &["y"], &["z"]];
const LUMINANCE: &[&str] = &["y", "l", "luminance", "grey", "gray"];
const ALPHA: &[&str] = &["a", "alpha"];
const DEPTH: &[&str] = &["z", "zback", "depth"];

fn is_one_of(name: &str, names: &[&str]) -> bool {
    names.iter().any(|known| name.eq_ignore_ascii_case(known))
}

/// Name behind the last point.
fn last_of(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}

impl Group {
    /// Groups of all parts, without integer channels.
    pub(super) fn all(headers: &[Header]) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        for (part, header) in headers.iter().enumerate() {
            let part_name = header.own_attributes.layer_name.as_ref().filter(|_| headers.len() > 1);
            let part_name = part_name.map(ToString::to_string).unwrap_or_default();
            for (index, channel) in header.channels.list.iter().enumerate() {
                if channel.sample_type == SampleType::U32 {
                    continue;
                }
                let name = channel.name.to_string();
                let (prefix, base) = name.rsplit_once('.').unwrap_or(("", &name));
                let member = (index, base.to_owned());
                match groups.iter_mut().find(|group| group.part == part && group.prefix == prefix) {
                    Some(group) => group.channels.push(member),
                    None => groups.push(Self {
                        part,
                        part_name: part_name.clone(),
                        prefix: prefix.to_owned(),
                        channels: vec![member],
                    }),
                }
            }
        }
        groups
    }

    /// Name of the layer: of the part, of the channels, or of both.
    fn label(&self) -> String {
        let Self { part_name, prefix, .. } = self;
        match (part_name.as_str(), prefix.as_str()) {
            ("", prefix) => prefix.to_owned(),
            (part, "") => part.to_owned(),
            (part, prefix) if prefix.starts_with(part) => prefix.to_owned(),
            (part, prefix) => format!("{part}.{prefix}"),
        }
    }

    fn channel(&self, names: &[&str]) -> Option<usize> {
        self.channels.iter().find(|(_, base)| is_one_of(base, names)).map(|(index, _)| *index)
    }

    fn triple(&self, names: &[&[&str]; 3]) -> Option<Vec<usize>> {
        names.iter().map(|names| self.channel(names)).collect()
    }

    /// The only channel besides alpha.
    fn single(&self) -> Option<(usize, &str)> {
        let mut others = self.channels.iter().filter(|(_, base)| !is_one_of(base, ALPHA));
        let (index, base) = others.next()?;
        others.next().is_none().then_some((*index, base))
    }

    /// The luminance of a group that has one; the Y of a vector is none, and neither is the Y of a colour with separate chroma.
    fn luminance(&self) -> Option<usize> {
        let other = self.channel(&["x"]).or(self.channel(&["z"])).or(self.channel(&["ry"])).or(self.channel(&["by"]));
        if other.is_some() { None } else { self.channel(LUMINANCE) }
    }

    fn is_named(&self, names: &[&str]) -> bool {
        let label = self.label();
        is_one_of(last_of(&label), names) || is_one_of(last_of(&self.part_name), names)
    }

    fn is_depth(&self, base: &str) -> bool {
        is_one_of(base, DEPTH)
            || base.to_ascii_lowercase().starts_with("depth")
            || self.is_named(&["depth", "z", "mist"])
    }

    fn choice(&self, channels: Vec<usize>) -> Choice {
        Choice { part: self.part, layer: self.label(), channels }
    }

    /// The channels of a group that is asked for by name.
    fn whole(&self) -> Option<Choice> {
        let channels = self.triple(&RGB).or_else(|| self.triple(&XYZ));
        let channels = channels.or_else(|| self.single().map(|(index, _)| vec![index]));
        channels.or_else(|| self.luminance().map(|index| vec![index])).map(|channels| self.choice(channels))
    }
}

/// Outcome of a rule: nothing fits, one choice, or several equals.
enum Outcome {
    Nothing,
    One(Choice),
    Several,
}

impl Outcome {
    fn from_all(choices: Vec<Choice>) -> Self {
        match <[Choice; 1]>::try_from(choices) {
            Ok([one]) => Self::One(one),
            Err(choices) if choices.is_empty() => Self::Nothing,
            Err(_) => Self::Several,
        }
    }
}

/// The groups that give a choice, the best named first: no layer name, then a name of the main picture, then any.
fn by_rank(groups: &[Group], give: impl Fn(&Group) -> Option<Vec<usize>>) -> Outcome {
    let found: Vec<(&Group, Choice)> =
        groups.iter().filter_map(|group| Some((group, group.choice(give(group)?)))).collect();
    let with = |fits: &dyn Fn(&Group) -> bool| {
        Outcome::from_all(found.iter().filter(|(group, _)| fits(group)).map(|(_, choice)| choice.clone()).collect())
    };
    let ranks: [&dyn Fn(&Group) -> bool; 3] =
        [&|group| group.label().is_empty(), &|group| group.is_named(&MAIN_LAYERS), &|_| true];
    ranks.into_iter().map(with).find(|outcome| !matches!(outcome, Outcome::Nothing)).unwrap_or(Outcome::Nothing)
}

/// Channels for a use of the picture, or for the layer or channel of that name.
///
/// Errors: a sentence that continues the name of the file, and lists all groups.
pub(super) fn choose(headers: &[Header], purpose: Purpose, layer: Option<&str>) -> Result<Choice, String> {
    let groups = Group::all(headers);
    let listed = || list(&groups);
    if let Some(wanted) = layer {
        return match by_name(&groups, headers, wanted) {
            Outcome::One(choice) => Ok(choice),
            Outcome::Several => Err(format!("has several layers `{wanted}`; its channels are: {}", listed())),
            Outcome::Nothing => {
                Err(format!("has no layer or channel `{wanted}` to read; its channels are: {}", listed()))
            }
        };
    }
    let rules: &[fn(&[Group]) -> Outcome] = match purpose {
        Purpose::Colours | Purpose::Environment => &[colour, luminance, lone_number],
        Purpose::Normals => &[named_normal, vector, colour, lone_vector, pair, luminance, lone_number],
        Purpose::Heights => &[named_height, luminance, lone_channel, colour, depth],
        Purpose::Data => &[colour, luminance, lone_channel],
    };
    let what = match purpose {
        Purpose::Colours | Purpose::Environment => "R, G, B or Y",
        Purpose::Normals => "X, Y, Z or R, G, B",
        Purpose::Heights => "heights: Y, Z or a single channel",
        Purpose::Data => "R, G, B, Y or a single channel",
    };
    for rule in rules {
        match rule(&groups) {
            Outcome::One(choice) => return Ok(choice),
            Outcome::Several => {
                return Err(format!("has several layers with {what} of equal rank; its channels are: {}", listed()));
            }
            Outcome::Nothing => {}
        }
    }
    Err(format!("has no channels {what}; its channels are: {}", listed()))
}

fn colour(groups: &[Group]) -> Outcome {
    by_rank(groups, |group| group.triple(&RGB))
}

fn luminance(groups: &[Group]) -> Outcome {
    by_rank(groups, |group| group.luminance().map(|index| vec![index]))
}

/// The only channel of the file, of any name but depth.
fn lone_number(groups: &[Group]) -> Outcome {
    let [group] = groups else { return Outcome::Nothing };
    match group.single() {
        Some((index, base)) if !group.is_depth(base) => Outcome::One(group.choice(vec![index])),
        _ => Outcome::Nothing,
    }
}

/// The only channel of the file.
fn lone_channel(groups: &[Group]) -> Outcome {
    let [group] = groups else { return Outcome::Nothing };
    group.single().map_or(Outcome::Nothing, |(index, _)| Outcome::One(group.choice(vec![index])))
}

fn named_normal(groups: &[Group]) -> Outcome {
    let fits = |group: &Group| {
        let named = group.is_named(&NORMAL_LAYERS);
        named.then(|| group.triple(&XYZ).or_else(|| group.triple(&RGB))).flatten()
    };
    by_rank(groups, fits)
}

/// A vector without a layer name.
fn vector(groups: &[Group]) -> Outcome {
    by_rank(groups, |group| if group.prefix.is_empty() { group.triple(&XYZ) } else { None })
}

fn lone_vector(groups: &[Group]) -> Outcome {
    by_rank(groups, |group| group.triple(&XYZ))
}

/// Two channels of a normal whose z is left out.
fn pair(groups: &[Group]) -> Outcome {
    by_rank(groups, |group| {
        let two = |names: &[&[&str]; 3]| Some(vec![group.channel(names[0])?, group.channel(names[1])?]);
        two(&RGB).or_else(|| two(&XYZ))
    })
}

fn named_height(groups: &[Group]) -> Outcome {
    by_rank(groups, |group| {
        let own = group.channel(&HEIGHT_LAYERS);
        let layer = || group.single().filter(|_| group.is_named(&HEIGHT_LAYERS)).map(|(index, _)| index);
        own.or_else(layer).map(|index| vec![index])
    })
}

fn depth(groups: &[Group]) -> Outcome {
    by_rank(groups, |group| group.single().filter(|(_, base)| group.is_depth(base)).map(|(index, _)| vec![index]))
}

/// The layer, part or channel of that name.
fn by_name(groups: &[Group], headers: &[Header], wanted: &str) -> Outcome {
    let of_layers = |fits: &dyn Fn(&Group) -> bool| {
        Outcome::from_all(groups.iter().filter(|group| fits(group)).filter_map(Group::whole).collect())
    };
    let mut of_channels = Vec::new();
    for group in groups {
        for (index, base) in &group.channels {
            let full = headers[group.part].channels.list[*index].name.to_string();
            if full == wanted || format!("{}.{base}", group.label()) == wanted {
                of_channels.push(group.choice(vec![*index]));
            }
        }
    }
    let outcomes = [
        of_layers(&|group| group.label() == wanted),
        of_layers(&|group| group.part_name == wanted || group.prefix == wanted),
        Outcome::from_all(of_channels),
        of_layers(&|group| last_of(&group.label()).eq_ignore_ascii_case(wanted)),
    ];
    outcomes.into_iter().find(|outcome| !matches!(outcome, Outcome::Nothing)).unwrap_or(Outcome::Nothing)
}

/// Layers with their channels, for messages.
fn list(groups: &[Group]) -> String {
    let mut listed: Vec<String> = groups
        .iter()
        .take(MAX_LISTED)
        .map(|group| {
            let names: Vec<&str> = group.channels.iter().map(|(_, base)| base.as_str()).collect();
            let names = names.join(", ");
            match group.label() {
                label if label.is_empty() => format!("{names} (no layer)"),
                label => format!("{names} (layer `{label}`)"),
            }
        })
        .collect();
    if let Some(more) = groups.len().checked_sub(MAX_LISTED + 1) {
        listed.push(format!("and {} more layers", more + 1));
    }
    if listed.is_empty() { "integers alone".to_owned() } else { listed.join("; ") }
}
