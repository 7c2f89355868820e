//! Tests of random points: distributions of the inputs, and statistical independence of the rows.

use std::ops::Range;

use bsm_batch::{PointSet, RandomInput, RandomPoints, RandomSource, Source};

fn random_points(of: &[&str]) -> RandomPoints {
    let of = of.iter().map(|text| RandomInput::parse(text).expect("a draw")).collect();
    RandomPoints::new(2026, 20_000, of).expect("draws")
}

fn input_values(draws: &RandomPoints, place: usize, rows: Range<u64>) -> Vec<f64> {
    let mut values = Vec::new();
    draws.append_values(place, rows, &mut values);
    values
}

/// A row must contain the same numbers if it is generated alone, in a chunk of any size, or after
/// any number of rows has been skipped.
#[test]
fn random_row_depends_only_on_seed_inputs_and_row_number() {
    let draws = random_points(&["axial_load_kN=uniform:2:8", "lead_mm=normal:20:0.01"]);
    for place in 0..2 {
        let all = input_values(&draws, place, 0..5000);
        for rows in [0..1, 4999..5000, 17..18, 1000..1300, 1..5000] {
            let [from, to] = [rows.start, rows.end].map(|row| usize::try_from(row).expect("few"));
            assert_eq!(input_values(&draws, place, rows), all[from..to]);
        }
    }
    let far = input_values(&draws, 1, u64::MAX / 2..u64::MAX / 2 + 2);
    assert_eq!(far[1..], input_values(&draws, 1, u64::MAX / 2 + 1..u64::MAX / 2 + 2));
    let mut source = RandomSource::new(draws.clone());
    source.skip(19_990).expect("never fails");
    let chunk = source.next(100).expect("never fails").expect("rows");
    assert_eq!((chunk.first, chunk.len), (19_991, 10));
    assert_eq!(chunk.inputs[0].values()[..], input_values(&draws, 0, 19_990..20_000));
    assert!(source.next(1).expect("never fails").is_none());
}

/// The expected numbers are constants in the code, because another build of the program may
/// continue a dataset and must then generate the same points.
#[test]
fn random_numbers_do_not_change_between_builds() {
    let draws =
        random_points(&["axial_load_N=uniform:1:2", "friction_coefficient=normal:0.5:0.25"]);
    let found = [input_values(&draws, 0, 7..9), input_values(&draws, 1, 7..9)].concat();
    let expected = "[1.596729512357534, 1.0897310778964324, 0.389121999909511, 0.6329336788937058]";
    assert_eq!(format!("{found:?}"), expected);
}

/// Mean and standard deviation of 20 000 random values must be within five standard errors of the
/// requested values. Five standard errors are 5 σ/√N for the mean. For the standard deviation, they
/// are 5 σ/√(2N) for a normal distribution, and less for a uniform distribution. The correlation of
/// two inputs must be less than 5/√N.
#[test]
fn random_inputs_have_the_requested_distributions() {
    let draws =
        random_points(&["axial_load_N=uniform:3:5", "friction_coefficient=normal:0.1:0.01"]);
    let columns = [input_values(&draws, 0, 0..20_000), input_values(&draws, 1, 0..20_000)];
    let mean = |values: &[f64]| values.iter().sum::<f64>() / 2e4;
    let standard = |values: &[f64]| {
        let middle = mean(values);
        let squares: Vec<_> = values.iter().map(|x| (x - middle).powi(2)).collect();
        let deviation = mean(&squares).sqrt();
        let scaled: Vec<_> = values.iter().map(|x| (x - middle) / deviation).collect();
        (middle, deviation, scaled)
    };
    let (uniform, spread, a) = standard(&columns[0]);
    let (normal, deviation, b) = standard(&columns[1]);
    assert!(columns[0].iter().all(|x| (3.0..5.0).contains(x)));
    assert!((uniform - 4.0).abs() < 0.02, "{uniform}");
    // The uniform distribution has a width of 2, so its standard deviation is 2/√12.
    assert!((spread - 0.577_35).abs() < 0.015, "{spread}");
    assert!((normal - 0.1).abs() < 3.6e-4 && (deviation - 0.01).abs() < 2.5e-4, "{normal}");
    let product: Vec<_> = a.iter().zip(&b).map(|(a, b)| a * b).collect();
    assert!(mean(&product).abs() < 0.036);
    // In a normal distribution, 68.3 % of all values are within one standard deviation of the mean.
    // The tolerance is 5 √(0.683·0.317/N).
    let within = b.iter().filter(|x| x.abs() < 1.0).map(|_| 1.0).sum::<f64>() / 2e4;
    assert!((within - 0.6827).abs() < 0.017, "{within}");
}

#[test]
fn distributions_round_trip_through_text() {
    for text in ["axial_load_N=uniform:2000:8000", "lead_mm=normal:20:0.01"] {
        assert_eq!(RandomInput::parse(text).expect("a draw").to_string(), text);
    }
    let kilo = RandomInput::parse("axial_load_kN = uniform : 2 : 8").expect("a draw");
    assert_eq!(kilo.to_string(), "axial_load_N=uniform:2000:8000");
    for (text, part) in [
        ("lead_mm", "name=uniform:low:high"),
        ("lead_mm=uniform:2", "name=uniform:low:high"),
        ("lead_mm=uniform:3:2", "low < high"),
        ("lead_mm=normal:3:0", "deviation > 0"),
        ("lead_mm=normal:nan:1", "finite"),
        ("lead_mm=cauchy:3:1", "name=uniform:low:high"),
        ("ball_diameter_mm=uniform:-1:1", "ball_diameter_mm"),
        ("leed_mm=uniform:1:2", "lead_mm"),
    ] {
        let said = RandomInput::parse(text).expect_err(text).to_string();
        assert!(said.contains(part), "{text}: {said}");
    }
    let twice = ["lead_mm=uniform:1:2", "lead_mm=normal:1:2"];
    let twice = twice.map(|text| RandomInput::parse(text).expect("a draw")).to_vec();
    assert!(RandomPoints::new(1, 1, twice).is_err());
}
