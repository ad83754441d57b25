//! The report of `check --render`: one self-contained HTML file, largest difference first.

use base64::{Engine as _, engine::general_purpose::STANDARD};

use super::{
    error::CliError,
    finding::{Drawn, Finding},
};
use crate::{measure::compare::difference_picture, preset_file};

const HEAD: &str = include_str!("report.html");

/// A table sorted by largest difference, then for each preset expected, actual and difference, to
/// blink and to wipe.
pub fn html(findings: &[Finding], adapter: &str) -> Result<String, CliError> {
    let worst = |finding: &&Finding| {
        finding
            .drawn
            .as_ref()
            .map_or(0, |drawn| drawn.delta.max_delta)
    };
    let mut sorted: Vec<&Finding> = findings.iter().collect();
    sorted.sort_by_key(|finding| {
        (
            finding.problems.is_empty(),
            std::cmp::Reverse(worst(finding)),
        )
    });
    let rows: String = sorted.iter().map(|finding| row(finding)).collect();
    let presets = sorted
        .iter()
        .map(|finding| section(finding))
        .collect::<Result<String, CliError>>()?;
    let failed = findings
        .iter()
        .filter(|finding| !finding.problems.is_empty())
        .count();
    Ok(HEAD
        .replace("{{version}}", env!("CARGO_PKG_VERSION"))
        .replace("{{adapter}}", &escape(adapter))
        .replace(
            "{{summary}}",
            &format!("{failed} of {} presets failed", findings.len()),
        )
        .replace("{{rows}}", &rows)
        .replace("{{presets}}", &presets))
}

fn row(finding: &Finding) -> String {
    let id = escape(&finding.preset);
    let verdict = if finding.problems.is_empty() {
        "ok"
    } else {
        "FAIL"
    };
    let [delta, rms, beyond] = finding.drawn.as_ref().map_or(
        ["not measured"; 3].map(str::to_owned),
        |Drawn { delta, .. }| {
            [
                delta.max_delta.to_string(),
                format!("{:.4}", delta.rms),
                delta.pixels_over_tolerance.to_string(),
            ]
        },
    );
    format!(
        "<tr class={verdict}><td><a href=\"#{id}\">{id}</a><td>{delta}<td>{rms}<td>{beyond}<td>{verdict}</tr>\n"
    )
}

fn section(finding: &Finding) -> Result<String, CliError> {
    let problems: String = finding
        .problems
        .iter()
        .map(|error| format!("<p class=FAIL>{}</p>\n", escape(error)))
        .collect();
    let mut html = format!(
        "<section id=\"{0}\"><h2>{0}</h2>\n{problems}",
        escape(&finding.preset)
    );
    if let Some(drawn) = &finding.drawn {
        let Drawn {
            size,
            expected,
            actual,
            delta,
        } = drawn;
        let [expected, actual, difference] =
            [expected, actual, &difference_picture(expected, actual, 16)]
                .map(|color| picture(color, *size));
        let (expected, actual, difference) = (expected?, actual?, difference?);
        html += &format!(
            "<div class=pictures><figure><img src=\"{expected}\"><figcaption>expected</figcaption></figure>\n\
             <figure><img src=\"{actual}\"><figcaption>actual</figcaption></figure>\n\
             <figure><img src=\"{difference}\"><figcaption>difference &times; 16</figcaption></figure>\n\
             <figure class=wipe><div><img src=\"{expected}\"><img class=over src=\"{actual}\"></div>\
             <figcaption><input type=range min=0 max=100 value=50 aria-label=\"wipe\"> wipe <button>blink</button></figcaption></figure></div>\n"
        );
        for offender in delta.mismatches.iter().take(10) {
            let [x, y] = offender.pixel(size[0]);
            html += &format!(
                "<code>pixel {x},{y}: expected {:?}, actual {:?}</code><br>\n",
                offender.a, offender.b
            );
        }
    }
    Ok(html + "</section>\n")
}

fn picture(color: &[[u8; 4]], size: [u32; 2]) -> Result<String, CliError> {
    Ok(format!(
        "data:image/png;base64,{}",
        STANDARD.encode(preset_file::png_bytes(color, size)?)
    ))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
