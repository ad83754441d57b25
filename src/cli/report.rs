//! The report of `check --render`: one self-contained HTML file, worst first.

use base64::{Engine as _, engine::general_purpose::STANDARD};

use super::{
    check::{Drawn, Finding},
    fault::Fault,
};
use crate::{measure::compare::difference_picture, preset_file};

const HEAD: &str = include_str!("report.html");

/// Table sorted by worst difference; per preset expected, actual and difference, to blink and to wipe.
pub fn html(findings: &[Finding], adapter: &str) -> Result<String, Fault> {
    let worst = |finding: &&Finding| finding.drawn.as_ref().map_or(0, |drawn| drawn.delta.max_delta);
    let mut sorted: Vec<&Finding> = findings.iter().collect();
    sorted.sort_by_key(|finding| (finding.faults.is_empty(), std::cmp::Reverse(worst(finding))));
    let rows: String = sorted.iter().map(|finding| row(finding)).collect();
    let preset_files = sorted.iter().map(|finding| section(finding)).collect::<Result<String, Fault>>()?;
    let failed = findings.iter().filter(|finding| !finding.faults.is_empty()).count();
    Ok(HEAD
        .replace("{{version}}", env!("CARGO_PKG_VERSION"))
        .replace("{{adapter}}", &escape(adapter))
        .replace("{{summary}}", &format!("{failed} of {} looks failed", findings.len()))
        .replace("{{rows}}", &rows)
        .replace("{{preset_files}}", &preset_files))
}

fn row(finding: &Finding) -> String {
    let id = escape(&finding.preset_file);
    let verdict = if finding.faults.is_empty() { "ok" } else { "FAIL" };
    let [delta, rms, beyond] = finding.drawn.as_ref().map_or(["not measured"; 3].map(str::to_owned), |Drawn { delta, .. }| {
        [delta.max_delta.to_string(), format!("{:.4}", delta.rms), delta.pixels_over_tolerance.to_string()]
    });
    format!("<tr class={verdict}><td><a href=\"#{id}\">{id}</a><td>{delta}<td>{rms}<td>{beyond}<td>{verdict}</tr>\n")
}

fn section(finding: &Finding) -> Result<String, Fault> {
    let faults: String = finding.faults.iter().map(|fault| format!("<p class=FAIL>{}</p>\n", escape(fault))).collect();
    let mut html = format!("<section id=\"{0}\"><h2>{0}</h2>\n{faults}", escape(&finding.preset_file));
    if let Some(drawn) = &finding.drawn {
        let Drawn { size, expected, actual, delta } = drawn;
        let [expected, actual, difference] =
            [expected, actual, &difference_picture(expected, actual, 16)].map(|color| picture(color, *size));
        let (expected, actual, difference) = (expected?, actual?, difference?);
        html += &format!(
            "<div class=pictures><figure><img src=\"{expected}\"><figcaption>expected</figcaption></figure>\n\
             <figure><img src=\"{actual}\"><figcaption>actual</figcaption></figure>\n\
             <figure><img src=\"{difference}\"><figcaption>difference &times; 16</figcaption></figure>\n\
             <figure class=wipe><div><img src=\"{expected}\"><img class=over src=\"{actual}\"></div>\
             <figcaption><input type=range min=0 max=100 value=50 aria-label=\"wipe\"> wipe <button>blink</button></figcaption></figure></div>\n"
        );
        for offender in delta.mismatches.iter().take(10) {
            let [x, y] = offender.place(size[0]);
            html += &format!("<code>pixel {x},{y}: expected {:?}, actual {:?}</code><br>\n", offender.a, offender.b);
        }
    }
    Ok(html + "</section>\n")
}

fn picture(color: &[[u8; 4]], size: [u32; 2]) -> Result<String, Fault> {
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(preset_file::png_bytes(color, size)?)))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
