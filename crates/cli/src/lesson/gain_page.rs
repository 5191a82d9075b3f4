//! The gains of a class as one HTML file without external resources: a picture of the scores before and after, and tables.

use std::fmt::Write;

use anyhow::Result;
use tilescope_figures::chart::{Bar, BarChart, BarGroup, Figure, Panel, figure_scene};
use tilescope_figures::{Font, Palette, escape, font_faces, to_svg};
use tilescope_lessons::Concept;
use tilescope_lessons::gain::{Gain, Gains};

use crate::analyze::page::with_own_ids;

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;color:#1a1d21;margin:2rem auto;max-width:1000px;padding:0 1rem}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums;margin:1rem 0}\
th,td{padding:.2rem .8rem;border-bottom:1px solid #d5dae0;text-align:right}\
th:first-child,td:first-child{text-align:left}thead th{border-bottom:2px solid #5b6470}svg{max-width:100%;height:auto}";

const MEANING: &str = "<p>The normalized gain is the share of what was not known before that is known after: (mean after - mean \
before) / (1 - mean before). Lectures alone reach about 0.23, interactive teaching about 0.48 (Hake, 1998). The interval \
holds the gain with probability 0.95 if the learners are a random sample; it is computed by drawing them again 2000 \
times. The first answer to each question counts.</p>\n";

/// Returns a page with a picture and tables of gains.
pub fn html(gains: &Gains) -> Result<String> {
    let title = "Before and after";
    let fonts = font_faces(&[Font::Regular, Font::SemiBold]);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <style>{STYLE}{fonts}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{MEANING}"
    );

    for (index, (name, count, rows)) in [
        ("Class", "learners", &gains.class),
        ("Votes of the class", "votes after", &gains.votes),
        ("Learners", "questions", &gains.learners),
    ]
    .into_iter()
    .enumerate()
    {
        // A class without votes, for instance, has no heading for them either.
        if rows.is_empty() {
            continue;
        }

        let _ = writeln!(out, "<h2>{name}</h2>");
        // The rows of learners, which alone count questions, have no picture: it would be as long as the class is
        // large.
        if count != "questions" {
            let _ = writeln!(out, "{}", with_own_ids(&picture(name, rows)?, index));
        }
        table(&mut out, count, rows);
    }

    out.push_str("</body>\n</html>\n");
    Ok(out)
}

/// Returns what a row is about, in words.
fn subject(gain: &Gain) -> &str {
    let concept = Concept::ALL.into_iter().find(|one| one.name() == gain.name);
    match concept {
        Some(concept) => concept.meaning(),
        None if gain.name == "all" => "all questions",
        None => &gain.name,
    }
}

/// Returns a picture with the mean scores before and after of each row, and the gain.
fn picture(name: &str, rows: &[Gain]) -> Result<String> {
    let group = |gain: &Gain| {
        let gain_text = match gain.interval {
            Some([low, high]) => format!("gain {} ({low:.2} to {high:.2})", gain.shown()),
            None => format!("gain {}", gain.shown()),
        };
        // Places in the list of colours of bars: the first stands out, and shows the later score.
        let (color_before, color_after) = (1, 0);
        let bar = |name: &str, value: f64, text: String, color: usize| Bar {
            name: name.to_owned(),
            value: 100.0 * value,
            whisker: None,
            text,
            color,
        };

        BarGroup {
            heading: subject(gain).to_owned(),
            bars: vec![
                bar(
                    "before",
                    gain.before,
                    format!("{:.0}%", 100.0 * gain.before),
                    color_before,
                ),
                bar(
                    "after",
                    gain.after,
                    format!("{:.0}%, {gain_text}", 100.0 * gain.after),
                    color_after,
                ),
            ],
        }
    };

    let chart = BarChart {
        label: "mean score in percent".to_owned(),
        groups: rows.iter().map(group).collect(),
    };

    let figure = Figure {
        title: format!("{name}: scores before and after"),
        rows: vec![vec![Panel::Bars(chart)]],
    };
    Ok(to_svg(&figure_scene(&figure, &Palette::LIGHT)?)?)
}

/// Appends a table of gains, whose column of numbers is headed `count`.
fn table(out: &mut String, count: &str, rows: &[Gain]) {
    let _ = writeln!(
        out,
        "<table>\n<thead><tr><th></th><th>{count}</th><th>before</th><th>after</th><th>gain</th><th>from</th><th>to</th></tr></thead>\n<tbody>"
    );
    for gain in rows {
        let [low, high] = gain.ends();
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{:.2}</td><td>{:.2}</td><td>{}</td><td>{low}</td><td>{high}</td></tr>",
            escape(subject(gain)),
            gain.count,
            gain.before,
            gain.after,
            gain.shown(),
        );
    }
    out.push_str("</tbody>\n</table>\n");
}
