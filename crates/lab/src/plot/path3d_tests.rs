//! Checks of whole scenes.

use super::*;

fn checked(x: &[f64], y: &[f64], z: &[f64]) -> String {
    let path = Path { label: "flown & planned".into(), x, y, z, style: 1, bare: false };
    let scene = Scene { title: "Path".into(), description: "<d>".into(), paths: vec![path] };
    let svg = scene.svg();
    assert!(resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).is_ok(), "{svg}");
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    assert_eq!(svg, scene.svg());
    svg
}

#[test]
fn a_scene_names_its_axes() {
    let svg = checked(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0], &[0.0, 1.0, 1.0]);
    assert!(["x (m)", "y (m)", "z (m)", "flown &amp; planned"].iter().all(|t| svg.contains(t)));
    assert!(!svg.contains("same scale"));
}

#[test]
fn odd_paths_are_drawn_too() {
    checked(&[], &[], &[]);
    checked(&[1.0], &[2.0], &[3.0]);
    checked(&[f64::NAN; 3], &[1.0; 3], &[1e308; 3]);
    checked(&[0.0, f64::NAN, 2.0, 3.0], &[0.0; 4], &[1e9; 4]);
}

#[test]
fn comparable_ranges_share_a_scale() {
    let range = |hi| Some(Range { lo: 0.0, hi });
    let (ranges, lengths, equal) = proportions([range(10.0), range(5.0), range(2.0)]);
    assert!(equal);
    for (range, length) in ranges.iter().zip(lengths) {
        assert!((range.span() / length - 11.0).abs() < 1e-9);
    }
    // A level path keeps the scale in a flat box, a much smaller range gets its own.
    assert!(proportions([range(10.0), range(5.0), range(0.0)]).2);
    assert!(!proportions([range(10.0), range(5.0), range(0.5)]).2);
}

#[test]
fn a_gap_breaks_path_and_shadow() {
    let svg = checked(&[0.0, 1.0, 2.0, 3.0, 4.0], &[0.0; 5], &[0.0, 1.0, f64::NAN, 1.0, 0.0]);
    let curves = svg.lines().filter(|l| l.contains("stroke-linejoin"));
    assert!(curves.map(|l| l.matches('M').count()).eq([2, 2]));
}
