//! Checks of whole figures.

use super::*;

fn figure<'a>(scale: Scale, x: &'a [f64], y: &'a [f64], limits: &[f64]) -> Figure<'a> {
    let series = vec![Series { label: "a < b".into(), x, y, style: 9, ..Series::default() }];
    let limits = limits.iter().map(|v| Limit { value: *v, label: "limit".into() }).collect();
    let panel = Panel {
        title: "t & u".into(),
        x_label: "time (s)".into(),
        y_label: "error (m)".into(),
        scale,
        series,
        limits,
        ..Panel::default()
    };
    Figure { title: "Title".into(), description: "\"d\"".into(), panels: vec![panel] }
}

/// Parses the document, so that a test fails when it is not well-formed.
fn checked(figure: &Figure<'_>) -> String {
    let svg = figure.svg();
    assert!(resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).is_ok(), "{svg}");
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    assert_eq!(svg, figure.svg());
    svg
}

#[test]
fn a_figure_is_well_formed_and_names_itself() {
    let svg = checked(&figure(Scale::Linear, &[0.0, 1.0, 2.0], &[1.0, 3.0, 2.0], &[2.5]));
    assert!(svg.contains("aria-label=\"&quot;d&quot;\"") && svg.contains("a &lt; b"));
    assert!(svg.contains("stroke-dasharray=\"6 4\""));
}

#[test]
fn odd_input_is_drawn_too() {
    let odd = [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e308, -1e308, 1e-320, 5.0];
    let x = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    for scale in [Scale::Linear, Scale::Log] {
        checked(&figure(scale, &x, &odd, &[f64::NAN, 0.0, 1e9]));
        checked(&figure(scale, &odd, &odd, &[]));
        checked(&figure(scale, &x, &[3.0; 8], &[]));
        checked(&figure(scale, &x, &[1e-300, 1e300], &[]));
        checked(&figure(scale, &[1.0], &[2.0], &[2.0]));
        assert!(checked(&figure(scale, &[], &[], &[])).contains("no data"));
    }
    checked(&Figure::default());
}

#[test]
fn a_gap_breaks_the_line() {
    let y = [1.0, 2.0, f64::NAN, 2.0, 1.0];
    let svg = checked(&figure(Scale::Linear, &[0.0, 1.0, 2.0, 3.0, 4.0], &y, &[]));
    let curve = svg.lines().find(|l| l.contains("stroke-linejoin")).unwrap_or_default();
    assert_eq!(curve.matches('M').count(), 2);
}

#[test]
fn a_far_limit_does_not_flatten_the_curve() {
    let svg = checked(&figure(Scale::Linear, &[0.0, 1.0], &[0.0, 0.1], &[100.0]));
    assert!(svg.contains("\u{2191} limit (100)"));
    assert!(!svg.contains("stroke-dasharray=\"6 4\""));
}

#[test]
fn a_long_series_stays_small() {
    let x: Vec<f64> = (0..200_000).map(f64::from).collect();
    let y: Vec<f64> = (0..200_000).map(|i| f64::from(i * 37 % 101)).collect();
    assert!(figure(Scale::Linear, &x, &y, &[]).svg().len() < 20_000);
}

#[test]
fn a_histogram_is_drawn_from_zero() {
    let column = |from, to, height| Column { from, to, height };
    let panel = Panel {
        x_scale: Scale::Log,
        columns: vec![column(0.1, 1.0, 3.0), column(1.0, 10.0, 0.0), column(10.0, 100.0, 6.0)],
        x_limits: vec![
            Limit { value: 20.0, label: "median 20".into() },
            Limit { value: 1e9, label: "far".into() },
        ],
        ..Panel::default()
    };
    let svg = checked(&Figure { panels: vec![panel], ..Figure::default() });
    assert_eq!(svg.matches("fill-opacity").count(), 2);
    assert!(svg.contains(">median 20<") && !svg.contains(">far<") && !svg.contains("no data"));
}

#[test]
fn symbols_keep_off_the_frame_and_crosses_may_lie_at_the_upper_edge() {
    let (x, y) = ([1.0, 2.0, 3.0], [1.0, f64::INFINITY, f64::NAN]);
    let of = |mark| {
        let series = Series { x: &x, y: &y, mark, ..Series::default() };
        let panel = Panel { series: vec![series], ..Panel::default() };
        checked(&Figure { panels: vec![panel], ..Figure::default() })
    };
    assert_eq!(of(Mark::Crosses).matches("l6 6").count(), 2);
    assert_eq!(of(Mark::Dots).matches("h0").count(), 1);
}

#[test]
fn bars_at_the_points_widen_the_range() {
    let spans = [(0.2, 0.8), (0.5, 0.95)];
    let series = Series { x: &[1.0, 2.0], y: &[0.5, 0.9], spans: &spans, ..Series::default() };
    let mut panel = Panel { series: vec![series], ..Panel::default() };
    let svg =
        |panel: &Panel<'_>| checked(&Figure { panels: vec![panel.clone()], ..Figure::default() });
    assert!(svg(&panel).contains(">0.2<") && !svg(&panel).contains(">0.0<"));
    panel.y_range = Some((0.0, 1.0));
    assert!(svg(&panel).contains(">0.0<") && svg(&panel).contains(">1.0<"));
}
