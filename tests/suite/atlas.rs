//! Promises of the error atlas: f32 stays as near to f64 as it says, the same values come back when ωi and ωe
//! are exchanged, and the input that is named as the worst gives the error that is named.

use crate::common::*;
use crate::promises::{RECIPROCITY, VALUE_F32, value_f32};
use gonio::bake::{Evaluator, Unobserved};
use gonio::lab::atlas;
use gonio::lab::atlas::Page;
use gonio::model::MODELS;
use std::sync::OnceLock;

/// A quarter of the default: enough for the tail to be within a tenth of that of 10⁸ values.
const BUDGET: u64 = 1_000_000;

fn pages(evaluator: &Evaluator) -> Vec<Page> {
    let models = MODELS.into_iter().filter(|model| !model.is_delta());
    let budget = if is_thorough() { BUDGET } else { BUDGET / 4 };
    models.map(|model| atlas::measure_model(evaluator, model, budget, &Unobserved).unwrap()).collect()
}

/// The device's, measured once.
fn device_pages() -> &'static [Page] {
    static PAGES: OnceLock<Vec<Page>> = OnceLock::new();
    PAGES.get_or_init(|| pages(device()))
}

/// 2e-6 for α ≥ 1e-4 and 1e-5 down to 1e-6, at all angles up to and including 90°.
///
/// Why 2e-6: B = S Fc of GGX has the most roundings. Each is at most u = 2⁻²⁴ and its sign is chance. By how often
/// one counts, to first order: in q of D, which is squared, 5 twice; α in it, twice (∂ ln D/∂ ln α is within
/// ±2); G2/(4 μi μe), 6; in x of Fc = x⁵, 4 five times, and 4 products; 3 with weights. Even at the variance of
/// a uniform ±u, u²/3, σ² = (5·4 + 4 + 6 + 4·25 + 4 + 3) u²/3, and 2e-6 = 34 u is 5 σ. A rounding is ±u only just
/// above a power of two and ±u/2 just below it, 0.58 of that variance on average, which makes it 6.5 σ: 1 value
/// in 10¹⁰. Below α = 1e-4 more is allowed, for devices whose divisions are off by 2.5 ULP.
#[test]
fn f32_is_as_near_to_f64_as_promised() {
    for page in device_pages() {
        for band in &page.decades {
            let worst = band.worst.as_ref().unwrap();
            println!("{} {:?}: median {:.1e}, max {:.1e}", page.subject, band.alpha, band.median, band.max);
            let promise = match page.subject.as_str() {
                // An exponential: what rounds its exponent grows with it.
                "beckmann" => 680.0 / f64::from(1 << 24),
                name if value_f32(model(name)) > VALUE_F32 => value_f32(model(name)),
                _ => band.alpha.map_or(2e-6, |[low, _]| if low >= 1e-4 { 2e-6 } else { 1e-5 }),
            };
            assert_eq!(band.promise, Some(promise));
            assert!(band.max <= promise, "{}: {:.2e} at {}", page.subject, band.max, worst.eval);
            assert_eq!(band.non_finite, 0, "{}: {}", page.subject, worst.eval);
            // Half an ULP is at best what a rounded result is off by at most; the median is below 4 of them. Charlie's
            // is an exponential where the others are products, and nowhere 0: measured 7.6.
            // Student's D and Λ are powers, whose exponents multiply the roundings of their bases: measured 17.
            let ulps = match page.subject.as_str() {
                "charlie" | "gtr" => 8.0,
                "student-t" => 20.0,
                _ => 4.0,
            };
            assert!(band.median <= ulps / (1 << 24) as f64, "{}: {}", page.subject, band.median);
        }
        assert!(page.is_kept());
    }
}

/// f64 stored as f32 is off by half an ULP; where both directions graze and α = 1e-6, by 2e-8 more, as
/// sin θi − sin θe comes from angles whose sum rounds near π.
#[test]
fn the_cpu_path_rounds_once() {
    for page in pages(&Evaluator::Cpu) {
        let worst = page.worst().unwrap();
        let half_ulp = 1.0 / f64::from(1 << 24);
        let [_, budget] = value_budgets(model(&page.subject));
        assert!(budget >= half_ulp && worst.max <= budget, "{}: {:?}", page.subject, worst.worst);
    }
}

/// Exchanging ωi and ωe exchanges operands of commutative sums and products: the same bits, unless the driver
/// contracts a·b + c. Then a sum of two products has one of them unrounded, and which one changes: 2⁻²⁴ each
/// in G2's sum and in h's, which D squares twice: 5 · 2⁻²⁴ = 3e-7.
#[test]
fn ggx_is_reciprocal_bit_by_bit_where_nothing_is_contracted() {
    let Evaluator::Device(opened) = device() else { unreachable!("common::device asserts it") };
    let contracts = opened.canary().unwrap().contracts;
    for page in device_pages() {
        for band in &page.decades {
            assert!(band.reciprocity <= RECIPROCITY, "{}: {:e}", page.subject, band.reciprocity);
            assert!(contracts || band.unequal == 0, "{}: {} values change", page.subject, band.unequal);
        }
    }
}

/// What the field's forms lose inside a lobe, in orders of magnitude. 1 − NoH² has lost α² to 2⁻²⁴ where
/// α = 2.4e-4, and is worth nothing there; |n×h|² and the components of h lose no more than the rounding
/// of the directions, 1e-7 rad of a lobe of width α; angles lose neither.
#[test]
fn published_forms_lose_what_they_cancel() {
    let pages = atlas::study(device(), 200_000, &Unobserved).unwrap();
    let median = |name: &str, k: usize| {
        let page = pages.iter().find(|page| page.subject == name).unwrap_or_else(|| panic!("no {name}"));
        page.decades[k].median
    };
    for cancels in ["NoH²(α²−1)+1", "(NoH α²−NoH)NoH+1", "1−NoH²", "tan²θm = (1−cos²)/cos²", "acos(n·h)"]
    {
        // Decades 1e-5 … 1e-4 and 1e-3 … 1e-2.
        assert!(median(cancels, 1) > 0.5 && median(cancels, 3) > 1e-3, "{cancels}");
    }
    for (k, decade) in [1e-6, 1e-5, 1e-4, 1e-3].into_iter().enumerate() {
        let rounded = median(atlas::ROUNDED, k);
        for sound in ["|n×h|²", "h.x, h.y, h.z"] {
            assert!((median(sound, k) / rounded - 1.0).abs() < 0.1, "{sound} from α = {decade}");
        }
        assert!(rounded > 1e-9 / decade && median(atlas::OWN, k) < 2e-7, "from α = {decade}");
    }
}

#[cfg(feature = "cli")]
mod command {
    use serde_json::Value;
    use std::path::Path;
    use std::process::{Command, Output};

    fn gonio(arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_gonio")).args(arguments).output().unwrap()
    }

    fn read(dir: &Path, name: &str) -> String {
        std::fs::read_to_string(dir.join(name)).unwrap()
    }

    /// The files say the same, and the worst input goes into `gonio eval` as it is and gives the same value.
    #[test]
    fn the_worst_input_can_be_pasted() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().to_str().unwrap();
        let run = gonio(&["atlas", "--model", "ggx", "--budget", "300000", "--out", path, "--json"]);
        assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
        let json: Value = serde_json::from_slice(&run.stdout).unwrap();
        assert_eq!(json, serde_json::from_str::<Value>(&read(dir.path(), "atlas.json")).unwrap());
        let csv = read(dir.path(), "atlas.csv");
        let decades = json["pages"][0]["decades"].as_array().unwrap();
        assert_eq!(decades.len(), 6);
        for (decade, line) in decades.iter().zip(csv.lines().skip(1)) {
            let worst = &decade["worst"];
            let eval = worst["eval"].as_str().unwrap();
            assert!(line.starts_with("ggx,") && line.ends_with(eval), "{line}");
            let mut arguments = vec!["eval", "--json"];
            arguments.extend(eval.split(' '));
            let value: Value = serde_json::from_slice(&gonio(&arguments).stdout).unwrap();
            let (device, reference) =
                (value["value"][0].as_f64().unwrap(), value["reference"][0].as_f64().unwrap());
            // eval takes α through roughness = √α, which f64 squares back to 1e-16.
            assert_eq!(device as f32, worst["value"].as_f64().unwrap() as f32, "{eval}");
            assert!((reference / worst["reference"].as_f64().unwrap() - 1.0).abs() < 1e-14, "{eval}");
        }
        let picture = image::open(dir.path().join("atlas_ggx.png")).unwrap();
        assert!(picture.width() > 1000);
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 3, "nothing else is left");
    }

    #[test]
    fn a_study_has_its_files() {
        let dir = tempfile::tempdir().unwrap();
        let run = gonio(&["atlas", "--study", "--budget", "5000", "--out", dir.path().to_str().unwrap()]);
        assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
        assert!(read(dir.path(), "study.csv").contains("\n\"h.x, h.y, h.z\",1e-6,1e-5,"));
        assert!(dir.path().join("study.png").exists() && dir.path().join("study.json").exists());
    }

    #[test]
    fn bad_input_is_refused() {
        for (arguments, code, words) in [
            (vec!["--model", "gxg"], 2, "no model \"gxg\""),
            (vec!["--model", "mirror"], 2, "mirror is a delta and has no values"),
            (vec!["--study", "--device", "cpu"], 3, "needs a Vulkan device"),
            (vec!["--budget", "0"], 2, "0 is not in 1..="),
            (
                vec!["--model", "lambert", "--budget", "1", "--out", "/dev/null/x"],
                2,
                "cannot create the folder",
            ),
        ] {
            let run = gonio(&[vec!["atlas"], arguments.clone()].concat());
            let said = String::from_utf8_lossy(&run.stderr);
            assert!(run.status.code() == Some(code) && said.contains(words), "{arguments:?}: {said}");
        }
    }
}
