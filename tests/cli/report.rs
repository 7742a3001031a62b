//! `inspect` beside Earth: the printed numbers, reports of one world and of many, and worlds that have nothing to measure.

use upthrust::measure::METRICS;

use super::Place;

/// Whether every element of an XML-like text that is opened is closed in order; HTML's void elements aside.
fn well_formed(text: &str) -> bool {
    let mut open: Vec<&str> = Vec::new();
    for piece in text.split('<').skip(1) {
        let Some((tag, _)) = piece.split_once('>') else { return false };
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap_or_default();
        if tag.starts_with('!') || ["meta", "br"].contains(&name) || tag.ends_with('/') {
            continue;
        }
        if !tag.starts_with('/') {
            open.push(name);
        } else if open.pop() != Some(name) {
            return false;
        }
    }
    open.is_empty()
}

/// A preset and a size that have something for every plot.
const WHOLE: (&str, &str) = ("rmp-ridge", "256");
const SMALL: (&str, &str) = ("fbm-rough", "96");

fn grown(place: &Place, (preset, size): (&str, &str), seeds: &[&str]) {
    for seed in seeds {
        let out = format!("w{seed}");
        let all = ["grow", preset, "--size", size, "--seed", seed, "--out", &out];
        assert_eq!(place.run(&all).code, 0);
    }
}

#[test]
fn a_page_holds_every_metric_and_is_whole() {
    let place = Place::new();
    grown(&place, WHOLE, &["1"]);
    let said = place.run(&["inspect", "w1", "--report", "r.html"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let page = std::fs::read_to_string(place.path("r.html")).unwrap();
    for metric in METRICS {
        assert!(said.out.contains(metric.title), "{} in\n{}", metric.title, said.out);
        assert!(page.matches(&format!(">{}</td>", metric.title)).count() == 2, "{}", metric.title);
    }
    assert!(said.out.contains("metrics that can be compared lie in Earth's band"), "{}", said.out);
    assert!(well_formed(&page) && !well_formed("<p><b></p>"));
    assert!(page.matches("<svg class=\"plot\"").count() >= 10, "plots");
    for nothing in ["NaN", "inf,", "src=", "<script", "@import", "url(http"] {
        assert!(!page.contains(nothing), "{nothing}");
    }
    assert_eq!(place.entries(), ["r.html", "w1"]);
}

#[test]
fn a_text_names_plots_that_are_there() {
    let place = Place::new();
    grown(&place, WHOLE, &["1"]);
    assert_eq!(place.run(&["inspect", "w1", "--report", "r.md"]).code, 0);
    let text = std::fs::read_to_string(place.path("r.md")).unwrap();
    assert!(METRICS.iter().all(|metric| text.contains(&format!("| {} |", metric.title))));
    let plots: Vec<&str> = text.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect();
    assert!(plots.len() >= 10, "{plots:?}");
    for plot in &plots {
        let svg = std::fs::read_to_string(place.path(plot)).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("<style>") && well_formed(&svg), "{plot}");
    }
    let files: Vec<String> = place.files().into_iter().filter(|name| name.starts_with("r_plots/")).collect();
    assert_eq!(files.len(), plots.len());
}

#[test]
fn json_has_all_and_several_worlds_spread() {
    let place = Place::new();
    grown(&place, SMALL, &["1", "2", "3"]);
    let one: serde_json::Value = serde_json::from_str(&place.run(&["inspect", "w1", "--json"]).out).unwrap();
    let metrics = one["metrics"].as_array().unwrap();
    assert_eq!(metrics.len(), METRICS.len());
    assert!(one["layers"][0]["layer"] == "height" && metrics[0]["name"] == METRICS[0].name);
    assert!(metrics.iter().all(|m| m["value"].is_f64() || m["missing"].is_string()), "{metrics:?}");
    let said = place.run(&["inspect", "w1", "w2", "w3", "--report", "all.html"]);
    assert!(said.out.starts_with("3 worlds "), "{}", said.out);
    assert!(well_formed(&std::fs::read_to_string(place.path("all.html")).unwrap()));
    let many = place.run(&["inspect", "w1", "w2", "w3", "--json"]);
    let many: serde_json::Value = serde_json::from_str(&many.out).unwrap();
    assert_eq!(many["worlds"][2]["world"], "w3");
    assert_eq!(many["metrics"][0]["worlds"], 3);
    assert_eq!(many["worlds"][0]["metrics"], one["metrics"]);
}

#[test]
fn worlds_with_nothing_to_measure_say_so() {
    let place = Place::new();
    let recipe =
        |base_m: i32| format!("[world]\nsize = 64\n[[stage]]\nkind = \"fbm\"\nheight_m = 0.0\nbase_m = {base_m}\n");
    for (name, base_m, why) in [("flat", 10, "the ground is flat"), ("sea", -10, "no land above the sea")] {
        place.write(&format!("{name}.toml"), recipe(base_m));
        assert_eq!(place.run(&["grow", &format!("{name}.toml"), "--out", name]).code, 0);
        let said = place.run(&["inspect", name, "--report", &format!("{name}.html")]);
        assert!(said.code == 0 && said.out.contains(why), "{} {}", said.out, said.err);
        let page = std::fs::read_to_string(place.path(&format!("{name}.html"))).unwrap();
        assert!(page.contains(why) && well_formed(&page) && !page.contains("NaN"));
    }
}

#[test]
fn reports_that_cannot_be_written_are_refused_first() {
    let place = Place::new();
    std::fs::create_dir(place.path("folder")).unwrap();
    for (file, line) in
        [("no/r.html", "error: no/r.html: there is no folder 'no'\n"), ("folder", "error: folder: this is a folder\n")]
    {
        let said = place.run(&["inspect", "w", "--report", file]);
        assert_eq!((said.code, said.err.as_str()), (2, line));
    }
    assert_eq!(place.run(&["inspect", "w", "w"]).err, "error: w: there is no such world\n");
}

#[test]
fn the_page_on_realism_has_the_metrics_of_this_program() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/realism.md")).unwrap();
    let table = upthrust::measure::report::metrics_table();
    assert!(page.contains(&table), "renew it: cargo run --release --example realism; the table is now\n{table}");
}
