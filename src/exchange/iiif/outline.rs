//! Outlines of regions: SVG and fragments of IIIF ↔ places.

use serde_json::Value;

use crate::manifest::hotspot::MAX_PLACES;

/// A polygon as SVG.
pub fn svg(places: &[[f64; 2]]) -> String {
    let rounded = |v: f64| (v * 100.0).round() / 100.0;
    let points: Vec<String> = places
        .iter()
        .map(|[x, y]| format!("{},{}", rounded(*x), rounded(*y)))
        .collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\"><polygon points=\"{}\"/></svg>",
        points.join(" ")
    )
}

/// The places around what an annotation is about, in pixels of a canvas of this size; `None` where
/// it is about the whole canvas, a point, or a form that is no polygon.
pub fn of_target(target: &Value, size: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    let places = match target {
        Value::String(id) => of_fragment(id.split_once('#')?.1, size)?,
        Value::Array(several) => return of_target(several.first()?, size),
        _ => match target.get("selector") {
            Some(Value::Array(several)) => several.iter().find_map(|one| of_selector(one, size))?,
            Some(one) => of_selector(one, size)?,
            None => {
                let id = target.get("id").and_then(Value::as_str)?;
                of_fragment(id.split_once('#')?.1, size)?
            }
        },
    };
    let numbers = places.as_flattened().iter().all(|v| v.is_finite());
    (numbers && (3..=MAX_PLACES).contains(&places.len())).then_some(places)
}

fn of_selector(selector: &Value, size: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    let value = selector.get("value").and_then(Value::as_str)?;
    match selector.get("type").and_then(Value::as_str)? {
        "SvgSelector" => of_svg(value),
        "FragmentSelector" => of_fragment(value, size),
        _ => None,
    }
}

/// `xywh=10,20,30,40`, in pixels or percent.
fn of_fragment(fragment: &str, size: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    let box_ = fragment
        .split('&')
        .find_map(|part| part.strip_prefix("xywh="))?;
    let (box_, factor) = match box_.strip_prefix("percent:") {
        Some(percent) => (percent, size.map(|side| side / 100.0)),
        None => (box_.strip_prefix("pixel:").unwrap_or(box_), [1.0; 2]),
    };
    let numbers = numbers(box_)?;
    let [x, y, width, height] = numbers.try_into().ok()?;
    let places = [
        [x, y],
        [x + width, y],
        [x + width, y + height],
        [x, y + height],
    ];
    Some(places.map(|[x, y]| [x * factor[0], y * factor[1]]).to_vec())
}

/// The first polygon, rectangle or straight path of an SVG.
fn of_svg(svg: &str) -> Option<Vec<[f64; 2]>> {
    let element = |name: &str| {
        let start = svg.find(&format!("<{name}"))?;
        let rest = &svg[start..];
        Some(&rest[..rest.find('>')?])
    };
    if let Some(polygon) = element("polygon").or_else(|| element("polyline")) {
        let numbers = numbers(attribute(polygon, "points")?)?;
        return Some(numbers.chunks_exact(2).map(|xy| [xy[0], xy[1]]).collect());
    }
    if let Some(rect) = element("rect") {
        let number = |name: &str| attribute(rect, name).map_or(Some(0.0), |text| text.parse().ok());
        let [x, y] = [number("x")?, number("y")?];
        let [width, height] = [number("width")?, number("height")?];
        return Some(vec![
            [x, y],
            [x + width, y],
            [x + width, y + height],
            [x, y + height],
        ]);
    }
    of_path(attribute(element("path")?, "d")?)
}

fn attribute<'e>(element: &'e str, name: &str) -> Option<&'e str> {
    for quote in ['"', '\''] {
        let start = format!("{name}={quote}");
        let found = element.match_indices(&start).find(|(at, _)| {
            let before = element[..*at].chars().next_back();
            before.is_some_and(char::is_whitespace)
        });
        if let Some((at, _)) = found {
            let rest = &element[at + start.len()..];
            return rest.split(quote).next();
        }
    }
    None
}

fn numbers(text: &str) -> Option<Vec<f64>> {
    let parts = text.split(|c: char| c == ',' || c.is_whitespace());
    parts
        .filter(|part| !part.is_empty())
        .map(|part| part.parse().ok())
        .collect()
}

/// A path of straight lines, up to where it closes or moves on.
fn of_path(d: &str) -> Option<Vec<[f64; 2]>> {
    let mut places: Vec<[f64; 2]> = Vec::new();
    let mut rest = d.trim_start();
    while let Some(command) = rest.chars().next() {
        let own = rest.strip_prefix(command)?;
        let end = own.find(|c: char| c.is_ascii_alphabetic() && !matches!(c, 'e' | 'E'));
        let (text, next) = own.split_at(end.unwrap_or(own.len()));
        rest = next;
        // Minus signs may stand for commas.
        let values = numbers(&text.replace('-', " -").replace("e -", "e-"))?;
        let from = places.last().copied().unwrap_or_default();
        let is_relative = command.is_ascii_lowercase();
        let mut at = from;
        let origin = |at: [f64; 2]| if is_relative { at } else { [0.0; 2] };
        match command.to_ascii_uppercase() {
            'M' if !places.is_empty() => break,
            'M' | 'L' => {
                for xy in values.chunks_exact(2) {
                    let o = origin(at);
                    at = [o[0] + xy[0], o[1] + xy[1]];
                    places.push(at);
                }
            }
            'H' => {
                for x in values {
                    at = [origin(at)[0] + x, at[1]];
                    places.push(at);
                }
            }
            'V' => {
                for y in values {
                    at = [at[0], origin(at)[1] + y];
                    places.push(at);
                }
            }
            'Z' => break,
            _ => return None,
        }
        if places.len() > MAX_PLACES {
            return None;
        }
    }
    // Closed by hand.
    if places.len() > 3 && places.first() == places.last() {
        places.pop();
    }
    Some(places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const SIZE: [f64; 2] = [200.0, 100.0];

    #[test]
    fn outlines_come_back_and_other_forms_are_none() {
        let places = vec![[1.5, 2.0], [30.25, 4.0], [10.0, 50.0]];
        let selector = json!({ "selector": { "type": "SvgSelector", "value": svg(&places) } });
        assert_eq!(of_target(&selector, SIZE), Some(places));
        let square = vec![[10.0, 20.0], [40.0, 20.0], [40.0, 60.0], [10.0, 60.0]];
        let is_square =
            |target: Value| assert_eq!(of_target(&target, SIZE), Some(square.clone()), "{target}");
        is_square(json!("http://x/canvas#xywh=10,20,30,40"));
        is_square(json!("http://x/canvas#t=1&xywh=percent:5,20,15,40"));
        let path = |d: &str| {
            let value = format!("<svg><g><path class='a' d=\"{d}\"/></g></svg>");
            json!({ "selector": [{ "type": "PointSelector" }, { "type": "SvgSelector", "value": value }] })
        };
        is_square(path("M10,20 L40,20 40,60 L10 60z"));
        is_square(path("m10 20 h30 v40 h-30 v-40 Z"));
        is_square(path("M10 20l30 0l0 40l-30 0"));
        assert_eq!(of_target(&path("M0 0C1 1 2 2 3 3"), SIZE), None);
        for whole in [
            json!("http://x/canvas"),
            json!({ "id": "http://x" }),
            json!(7),
            json!([]),
        ] {
            assert_eq!(of_target(&whole, SIZE), None);
        }
        assert_eq!(of_target(&json!("c#xywh=1,2,3"), SIZE), None);
        assert_eq!(of_target(&json!("c#xywh=1,2,NaN,4"), SIZE), None);
    }
}
