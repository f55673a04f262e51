//! One pair of axes as a small SVG of its own, to be read on a phone as well: lines and clouds of points.
//!
//! It has no style of its own; a page that holds several gives [`super::STYLE`] once.

use super::{Area, Color, Scale, escape, polyline, short, ticks};
use std::fmt::Write;

const WIDTH: f64 = 430.0;
const HEIGHT: f64 = 232.0;
const AREA: Area = Area { left: 52.0, top: 26.0, width: 368.0, height: 160.0 };

/// Side of the squares of which one point is drawn, pixels.
const POINT_GRID: f64 = 1.5;

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Mark {
    /// A line of this width in pixels; x must ascend.
    Line(f64),
    /// A dashed line of this width.
    Dashed(f64),
    /// A cloud of points.
    Points,
}

/// One curve of a chart.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trace {
    /// How it is drawn.
    pub mark: Mark,
    /// Colour.
    pub color: Color,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates; the line is broken where one is not finite.
    pub y: Vec<f64>,
}

/// A pair of axes.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Chart {
    /// Heading at the left.
    pub title: String,
    /// Remark at the right of the heading.
    pub note: String,
    /// Quantity and unit along x.
    pub x_label: String,
    /// Curves, the last on top.
    pub traces: Vec<Trace>,
    /// Whether the ordinates are given as their decimal logarithms.
    pub log_y: bool,
}

impl Chart {
    /// The chart as an SVG element for an HTML page.
    pub(crate) fn to_svg(&self) -> String {
        let Area { left, top, width, height } = AREA;
        let (right, bottom) = (left + width, top + height);
        let x = Scale::new(self.traces.iter().flat_map(|trace| &trace.x), 0.0, left, right);
        let y = Scale::new(self.traces.iter().flat_map(|trace| &trace.y), 0.06, bottom, top);
        let mut svg = String::new();
        // Writing to a string cannot fail.
        let _ = write!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"ts-figure chart\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
             role=\"img\"><title>{0} {1}</title><text x=\"{left}\" y=\"17\" font-weight=\"600\">{0}</text>\
             <text class=\"soft\" x=\"{right}\" y=\"17\" text-anchor=\"end\">{1}</text>",
            escape(&self.title),
            escape(&self.note)
        );
        let (mut grid, mut labels) = (String::new(), String::new());
        for (value, label) in ticks::ticks(x.low, x.high, 6) {
            let at = short(x.at(value));
            let _ = write!(grid, "M{at},{top}V{bottom}");
            let _ = write!(labels, "<text x=\"{at}\" y=\"{}\" text-anchor=\"middle\">{label}</text>", bottom + 15.0);
        }
        for (value, label) in if self.log_y { decades(&y) } else { ticks::ticks(y.low, y.high, 4) } {
            let at = y.at(value);
            let _ = write!(grid, "M{left},{}H{right}", short(at));
            let _ = write!(
                labels,
                "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{label}</text>",
                left - 6.0,
                short(at + 4.0)
            );
        }
        let _ = write!(svg, "<path class=\"grid\" d=\"{grid}\"/><g class=\"ticks\">{labels}</g>");
        for trace in &self.traces {
            trace.draw(&mut svg, &x, &y);
        }
        let _ = write!(
            svg,
            "<rect class=\"frame\" x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/>\
             <text class=\"soft\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text></svg>",
            left + width / 2.0,
            bottom + 34.0,
            escape(&self.x_label)
        );
        svg
    }
}

impl Trace {
    fn draw(&self, svg: &mut String, x: &Scale, y: &Scale) {
        let color = self.color as usize;
        let pixels = self.x.iter().zip(&self.y).map(|(&a, &b)| [x.at(a), y.at(b)]);
        let finite = |p: &[f64; 2]| p[0].is_finite() && p[1].is_finite();
        let mut path = String::new();
        let look = match self.mark {
            Mark::Points => {
                let cell = |p: [f64; 2]| p.map(|v| (v / POINT_GRID).round() as i64);
                let mut cells: Vec<[i64; 2]> = pixels.filter(finite).map(cell).collect();
                cells.sort_unstable();
                cells.dedup();
                for point in cells {
                    let [a, b] = point.map(|v| short(v as f64 * POINT_GRID));
                    let _ = write!(path, "M{a},{b}h0");
                }
                "class=\"line points".to_owned()
            }
            Mark::Line(width) | Mark::Dashed(width) => {
                let pixels: Vec<[f64; 2]> = pixels.collect();
                for run in pixels.split(|point| !finite(point)) {
                    for (index, [px, py]) in polyline::reduce(run).into_iter().enumerate() {
                        let _ = write!(path, "{}{},{}", if index == 0 { "M" } else { " " }, short(px), short(py));
                    }
                }
                let dashes = if matches!(self.mark, Mark::Dashed(_)) { " stroke-dasharray=\"5 3\"" } else { "" };
                format!("stroke-width=\"{width}\"{dashes} class=\"line")
            }
        };
        if !path.is_empty() {
            let _ = write!(svg, "<path {look} c{color}\" d=\"{path}\"/>");
        }
    }
}

/// Powers of ten on a logarithmic axis; where there are not two of them, 1, 2 and 5 times them.
fn decades(y: &Scale) -> Vec<(f64, String)> {
    if !(y.low.is_finite() && y.high - y.low < 600.0) {
        return Vec::new();
    }
    let (first, last) = (y.low.ceil() as i32, y.high.floor() as i32);
    let step = ((last - first) / 5 + 1).max(1) as usize;
    let digits: &[i32] = if last > first { &[1] } else { &[1, 2, 5] };
    let label = |digit: i32, e: i32| match e {
        -3..=0 => format!("{:.*}", -e as usize, f64::from(digit) * 10f64.powi(e)),
        1..=4 => format!("{}", f64::from(digit) * 10f64.powi(e)),
        _ => format!("{digit}e{e}"),
    };
    let all = (first - 1..=last).step_by(step).flat_map(|e| digits.iter().map(move |&digit| (digit, e)));
    let places = all.map(|(digit, e)| (f64::from(digit).log10() + f64::from(e), label(digit, e)));
    places.filter(|(at, _)| (y.low..=y.high).contains(at)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(mark: Mark, x: Vec<f64>, y: Vec<f64>) -> Chart {
        let trace = Trace { mark, color: Color::Blue, x, y };
        Chart { title: "a & b".into(), x_label: "time (s)".into(), traces: vec![trace], ..Default::default() }
    }

    fn paths(svg: &str) -> Vec<String> {
        let document = roxmltree::Document::parse(svg).unwrap();
        let drawn = document.descendants().filter(|n| n.attribute("class").is_some_and(|c| c.starts_with("line")));
        drawn.map(|node| node.attribute("d").unwrap().to_owned()).collect()
    }

    #[test]
    fn a_line_goes_from_corner_to_corner() {
        let svg = chart(Mark::Line(1.0), vec![0.0, 10.0], vec![0.0, 1.0]).to_svg();
        let margin = 160.0 * 0.06 / 1.12;
        assert_eq!(paths(&svg), [format!("M52,{} 420,{}", short(186.0 - margin), short(26.0 + margin))]);
        assert!(svg.contains("a &amp; b") && svg.contains("time (s)"));
    }

    #[test]
    fn points_on_one_spot_are_drawn_once() {
        let svg = chart(Mark::Points, vec![0.0, 1.0, 1.0, f64::NAN], vec![0.0, 2.0, 2.0, 1.0]).to_svg();
        assert_eq!(paths(&svg)[0].matches("h0").count(), 2);
    }

    #[test]
    fn nothing_is_still_a_chart() {
        let svg = chart(Mark::Dashed(1.0), Vec::new(), Vec::new()).to_svg();
        assert!(paths(&svg).is_empty() && !svg.contains("NaN"));
    }

    #[test]
    fn decades_have_plain_labels() {
        let axis = Scale { low: -2.3, high: 1.2, from: 0.0, to: 1.0 };
        let labels: Vec<String> = decades(&axis).into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["0.01", "0.1", "1", "10"]);
        let narrow = Scale { low: -2.2, high: -1.6, from: 0.0, to: 1.0 };
        let labels: Vec<String> = decades(&narrow).into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["0.01", "0.02"]);
    }
}
