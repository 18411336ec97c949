//! Prints the curves of [Sadeghi2012, Fig. 8, bottom row] as an SVG: light scattered in the plane of incidence by the twisted and the flat thread
//! of polyester satin charmeuse, for light from 0°, 30° and 60°.
//!
//! `cargo run -p lisle-core --example thread_curves > docs/images/thread-curves.svg`

use lisle_core::scattering::{FiberAngles, Thread, fabric_threads, thread_terms};

const LIGHT_DEG: [f64; 3] = [0.0, 30.0, 60.0];
/// Width and height of one plot, and the radius of its half circle, SVG units.
const PLOT: [f64; 2] = [200.0, 128.0];
const RADIUS: f64 = 84.0;

/// Total f_s (mean of the channels) and its surface term for light and viewer on one side of the thread.
fn scattered(thread: &Thread, light_deg: f64, viewer_deg: f64) -> [f64; 2] {
    let angles = FiberAngles::from_radians(light_deg.to_radians(), viewer_deg.to_radians(), 0.0);
    let [surface, volume] = thread_terms(thread, &angles);
    [surface + thread.color.element_sum() / 3.0 * volume, surface]
}

/// The end of a ray at an angle from the thread's normal, positive to the right, with the thread horizontal.
fn point(angle_deg: f64, length: f64) -> String {
    let angle = angle_deg.to_radians();
    format!("{:.1},{:.1}", length * angle.sin(), -length * angle.cos())
}

fn plot(thread: &Thread, light_deg: f64) -> String {
    let viewers = || (-89..=89).map(f64::from);
    let greatest = viewers().map(|viewer| scattered(thread, light_deg, viewer)[0]).fold(0.0, f64::max);
    let curve = |term: usize| {
        let points = viewers().map(|v| point(v, RADIUS * scattered(thread, light_deg, v)[term] / greatest));
        points.collect::<Vec<_>>().join(" ")
    };
    let ring = |share: f64| {
        let r = share * RADIUS;
        format!(
            "<path fill=\"none\" stroke=\"#bbb\" d=\"M{} A{r:.1} {r:.1} 0 0 1 {}\"/>",
            point(-90.0, r),
            point(90.0, r)
        )
    };
    [
        ring(0.5),
        ring(1.0),
        format!("<path fill=\"none\" stroke=\"#bbb\" d=\"M{} L{}\"/>", point(-90.0, RADIUS), point(90.0, RADIUS)),
        format!("<path stroke=\"#e08000\" stroke-width=\"2\" d=\"M0,0 L{}\"/>", point(light_deg, RADIUS)),
        format!("<polygon fill=\"none\" stroke=\"#1a5fb4\" stroke-width=\"1.5\" points=\"{}\"/>", curve(0)),
        format!("<polygon fill=\"none\" stroke=\"#777\" stroke-dasharray=\"3 2\" points=\"{}\"/>", curve(1)),
        format!("<text x=\"0\" y=\"16\">light {light_deg:.0}°, full scale {greatest:.2}</text>"),
    ]
    .join("\n")
}

fn main() {
    let threads = ["twisted", "flat"].map(|kind| {
        let name = format!("polyester-satin-charmeuse {kind}");
        fabric_threads().into_iter().find(|(found, _)| *found == name).expect("a thread of the table")
    });
    let [width, height] = [PLOT[0] * 3.0, (PLOT[1] + 20.0) * 2.0];
    println!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         font-family=\"sans-serif\" font-size=\"11\" text-anchor=\"middle\">"
    );
    println!("<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>");
    for (row, (name, thread)) in threads.iter().enumerate() {
        let top = (PLOT[1] + 20.0) * row as f64;
        println!("<text x=\"{:.0}\" y=\"{:.0}\">{name}</text>", 0.5 * width, top + 14.0);
        for (column, light_deg) in LIGHT_DEG.into_iter().enumerate() {
            let [x, y] = [PLOT[0] * (column as f64 + 0.5), top + 20.0 + RADIUS + 4.0];
            println!("<g transform=\"translate({x:.0} {y:.0})\">\n{}\n</g>", plot(thread, light_deg));
        }
    }
    println!("</svg>");
}
