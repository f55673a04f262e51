//! Line charts as SVG: panels in a grid, axes with round ticks, several lines, a legend. Light and dark follow the
//! reader's setting; the text is real text, and long signals are thinned to what shows.

pub(crate) mod chart;
mod polyline;
mod ticks;

use std::fmt::Write;

const WIDTH: f64 = 960.0;
const PANEL_HEIGHT: f64 = 190.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 26.0;
const HEADER: f64 = 66.0;
const AXIS_TITLE: f64 = 18.0;
const CAPTION_LINE: f64 = 16.0;

/// Look of all figures. Colours are direct values rather than variables, which many viewers do not know.
pub(crate) const STYLE: &str = "\
.ts-figure{font-family:system-ui,'DejaVu Sans',sans-serif;font-size:11px}
.ts-figure .paper{fill:#fff}.ts-figure text{fill:#1f2328}.ts-figure .soft{fill:#59636e}
.ts-figure .grid{stroke:#e3e6ea;fill:none}.ts-figure .frame{stroke:#b4bcc5;fill:none}
.ts-figure .line{fill:none;stroke-linejoin:round}
.ts-figure .points{stroke-width:2.2;stroke-linecap:round;stroke-opacity:.4}
.ts-figure .c0{stroke:#1f2328}.ts-figure .c1{stroke:#0072b2}.ts-figure .c2{stroke:#d55e00}
.ts-figure .c3{stroke:#009e73}.ts-figure .c4{stroke:#a6559d}.ts-figure .c5{stroke:#a3adb8}
@media (prefers-color-scheme:dark){
.ts-figure .paper{fill:#14171b}.ts-figure text{fill:#e6e8ea}.ts-figure .soft{fill:#9aa4b0}
.ts-figure .grid{stroke:#2b3138}.ts-figure .frame{stroke:#56606b}
.ts-figure .c0{stroke:#e6e8ea}.ts-figure .c1{stroke:#56b4e9}.ts-figure .c2{stroke:#ff8c42}
.ts-figure .c3{stroke:#3fcf9f}.ts-figure .c4{stroke:#dd9ad4}.ts-figure .c5{stroke:#66717d}}
";

/// Colours of lines; they are distinct in light and dark and for readers who see few colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Color {
    /// That of the text.
    Ink,
    /// Blue.
    Blue,
    /// Orange.
    Orange,
    /// Green.
    Green,
    /// Purple.
    Purple,
    /// Grey, for what stands behind.
    Grey,
}

/// How all lines of one kind look, and their name in the legend.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Series {
    /// Name in the legend.
    pub name: String,
    /// Colour.
    pub color: Color,
    /// Width in pixels.
    pub width: f64,
    /// Whether the line is dashed.
    pub dashed: bool,
}

/// One line of a panel.
#[derive(Debug, Clone)]
pub(crate) struct Curve<'a> {
    /// Which of the figure's series it belongs to.
    pub series: usize,
    /// Abscissae, ascending.
    pub x: &'a [f64],
    /// Ordinates; the line is broken where one is not finite.
    pub y: &'a [f64],
}

/// One pair of axes. Curves are drawn in their order, the last on top.
#[derive(Debug, Clone, Default)]
pub(crate) struct Panel<'a> {
    /// Heading at the left.
    pub title: String,
    /// Remark at the right of the heading.
    pub note: String,
    /// Lines.
    pub curves: Vec<Curve<'a>>,
}

/// A figure of panels that share the meaning of their axes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Figure<'a> {
    /// Heading.
    pub title: String,
    /// Lines of text below the panels.
    pub caption: Vec<String>,
    /// Quantity and unit along x: "time (s)".
    pub x_label: String,
    /// Quantity and unit along y.
    pub y_label: String,
    /// The kinds of lines, in the order of the legend.
    pub series: Vec<Series>,
    /// Panels, row by row.
    pub panels: Vec<Panel<'a>>,
    /// Panels in a row.
    pub columns: usize,
}

impl Figure<'_> {
    /// The figure as an SVG document, which may also stand inside an HTML page.
    pub(crate) fn to_svg(&self) -> String {
        let columns = self.columns.max(1);
        let rows = self.panels.len().div_ceil(columns);
        let panels_end = HEADER + rows as f64 * PANEL_HEIGHT + AXIS_TITLE;
        let height = panels_end + 10.0 + CAPTION_LINE * self.caption.len() as f64;
        let mut svg = String::new();
        let title = escape(&self.title);
        // Writing to a string cannot fail.
        let _ = write!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"ts-figure\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">\n\
             <title>{title}</title>\n<desc>{}</desc>\n<style>\n{STYLE}</style>\n\
             <rect class=\"paper\" width=\"{WIDTH}\" height=\"{height}\"/>\n\
             <text x=\"{LEFT}\" y=\"24\" font-size=\"16\" font-weight=\"600\">{title}</text>\n",
            escape(&self.caption.join(" ")),
        );
        self.legend(&mut svg);
        let width = WIDTH / columns as f64;
        for (index, panel) in self.panels.iter().enumerate() {
            let (column, row) = (index % columns, index / columns);
            let last_row = index + columns >= self.panels.len();
            let area = Area {
                left: column as f64 * width + LEFT,
                top: HEADER + row as f64 * PANEL_HEIGHT + TOP,
                width: width - LEFT - RIGHT,
                height: PANEL_HEIGHT - TOP - BOTTOM,
            };
            self.panel(&mut svg, panel, &area, column == 0, last_row);
        }
        for (line, text) in self.caption.iter().enumerate() {
            let y = panels_end + 8.0 + CAPTION_LINE * line as f64;
            let _ = writeln!(svg, "<text class=\"soft\" x=\"{LEFT}\" y=\"{y}\">{}</text>", escape(text));
        }
        svg += "</svg>\n";
        svg
    }

    fn legend(&self, svg: &mut String) {
        let mut x = LEFT;
        for series in &self.series {
            let _ = writeln!(
                svg,
                "<path class=\"line c{}\" {} d=\"M{x},46h28\"/><text x=\"{}\" y=\"50\" font-size=\"12\">{}</text>",
                series.color as usize,
                series.stroke(),
                x + 34.0,
                escape(&series.name)
            );
            x += 58.0 + 6.6 * series.name.chars().count() as f64;
        }
    }

    fn panel(&self, svg: &mut String, panel: &Panel, area: &Area, first_column: bool, last_row: bool) {
        let Area { left, top, width, height } = *area;
        let x = Scale::new(panel.curves.iter().flat_map(|curve| curve.x), 0.0, left, left + width);
        let y = Scale::new(panel.curves.iter().flat_map(|curve| curve.y), 0.06, top + height, top);
        let (right, bottom) = (left + width, top + height);
        let _ = writeln!(
            svg,
            "<text x=\"{left}\" y=\"{0}\" font-weight=\"600\">{1}</text>\
             <text class=\"soft\" x=\"{right}\" y=\"{0}\" text-anchor=\"end\">{2}</text>",
            top - 7.0,
            escape(&panel.title),
            escape(&panel.note)
        );
        let mut grid = String::new();
        let mut labels = String::new();
        for (value, label) in ticks::ticks(x.low, x.high, 6) {
            let at = short(x.at(value));
            let _ = write!(grid, "M{at},{}V{}", short(top), short(bottom));
            let _ =
                write!(labels, "<text x=\"{at}\" y=\"{}\" text-anchor=\"middle\">{label}</text>", short(bottom + 14.0));
        }
        for (value, label) in ticks::ticks(y.low, y.high, 4) {
            let at = y.at(value);
            let _ = write!(grid, "M{},{}H{}", short(left), short(at), short(right));
            let _ = write!(
                labels,
                "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{label}</text>",
                short(left - 6.0),
                short(at + 4.0)
            );
        }
        let _ = writeln!(svg, "<path class=\"grid\" d=\"{grid}\"/><g class=\"ticks\">{labels}</g>");
        for curve in &panel.curves {
            let Some(series) = self.series.get(curve.series) else { continue };
            let path = path(curve, &x, &y);
            if !path.is_empty() {
                let _ =
                    writeln!(svg, "<path class=\"line c{}\" {} d=\"{path}\"/>", series.color as usize, series.stroke());
            }
        }
        let _ = writeln!(svg, "<rect class=\"frame\" x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/>");
        if last_row {
            let (at, below) = (left + width / 2.0, bottom + 32.0);
            let _ =
                writeln!(svg, "<text x=\"{at}\" y=\"{below}\" text-anchor=\"middle\">{}</text>", escape(&self.x_label));
        }
        if first_column {
            let (at, middle) = (left - 46.0, top + height / 2.0);
            let _ = writeln!(
                svg,
                "<text x=\"{at}\" y=\"{middle}\" text-anchor=\"middle\" transform=\"rotate(-90 {at} {middle})\">{}</text>",
                escape(&self.y_label)
            );
        }
    }
}

impl Series {
    fn stroke(&self) -> String {
        let dashes = if self.dashed { " stroke-dasharray=\"5 3\"" } else { "" };
        format!("stroke-width=\"{}\"{dashes}", self.width)
    }
}

/// The rectangle between the axes, in pixels.
struct Area {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

/// A linear axis.
struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    /// Fits the finite ones of `values`, with a share of `margin` on both sides, between the pixels `from` and `to`.
    fn new<'a>(values: impl Iterator<Item = &'a f64>, margin: f64, from: f64, to: f64) -> Self {
        let (low, high) = values
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)));
        let (low, high) = match high - low {
            span if span > 0.0 => (low - margin * span, high + margin * span),
            0.0 => (low - 0.5, high + 0.5),
            _ => (0.0, 1.0),
        };
        Scale { low, high, from, to }
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }
}

fn path(curve: &Curve, x: &Scale, y: &Scale) -> String {
    let points: Vec<[f64; 2]> = curve.x.iter().zip(curve.y).map(|(&a, &b)| [x.at(a), y.at(b)]).collect();
    let mut path = String::new();
    for run in points.split(|point| !(point[0].is_finite() && point[1].is_finite())) {
        for (index, [px, py]) in polyline::reduce(run).into_iter().enumerate() {
            let _ = write!(path, "{}{},{}", if index == 0 { "M" } else { " " }, short(px), short(py));
        }
    }
    path
}

/// Pixels to a tenth.
fn short(value: f64) -> String {
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure<'a>(x: &'a [f64], y: &'a [f64]) -> Figure<'a> {
        Figure {
            title: "Speed & <time>".to_owned(),
            caption: vec!["One line.".to_owned()],
            x_label: "time (s)".to_owned(),
            y_label: "speed (rad/s)".to_owned(),
            series: vec![Series { name: "measured".to_owned(), color: Color::Blue, width: 1.0, dashed: true }],
            panels: vec![Panel {
                title: "joint 1".to_owned(),
                note: String::new(),
                curves: vec![Curve { series: 0, x, y }],
            }],
            columns: 1,
        }
    }

    /// The points of the first line that is drawn inside the panel.
    fn points(svg: &str) -> Vec<String> {
        let document = roxmltree::Document::parse(svg).unwrap();
        let lines: Vec<_> = document
            .descendants()
            .filter(|node| node.attribute("class").is_some_and(|class| class.starts_with("line")))
            .collect();
        lines.iter().skip(1).map(|line| line.attribute("d").unwrap().to_owned()).collect()
    }

    #[test]
    fn the_line_goes_from_corner_to_corner() {
        let svg = figure(&[0.0, 10.0], &[0.0, 1.0]).to_svg();
        // x: 62 .. 946; y: the panel from 96 to 230, with a margin of 6 % of the range at both ends.
        let margin = 134.0 * 0.06 / 1.12;
        let expected = format!("M62,{} 946,{}", short(230.0 - margin), short(96.0 + margin));
        assert_eq!(points(&svg), [expected]);
        for text in ["Speed &amp; &lt;time&gt;", "time (s)", "speed (rad/s)", "measured", "One line."] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn a_gap_breaks_the_line_and_a_constant_has_an_axis() {
        let svg = figure(&[0.0, 1.0, 2.0, 3.0, 4.0], &[1.0, 1.0, f64::NAN, 1.0, 1.0]).to_svg();
        assert_eq!(points(&svg)[0].matches('M').count(), 2);
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn nothing_to_draw_is_still_a_figure() {
        let svg = figure(&[], &[]).to_svg();
        assert!(points(&svg).is_empty());
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn long_noise_stays_small() {
        let x: Vec<f64> = (0..100_000).map(|k| f64::from(k) * 1e-3).collect();
        let y: Vec<f64> = (0..100_000_u32).map(|k| f64::from(k.wrapping_mul(2_654_435_761) >> 16)).collect();
        let svg = figure(&x, &y).to_svg();
        assert!(svg.len() < 60_000, "{}", svg.len());
    }
}
