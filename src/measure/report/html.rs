//! A report as one HTML file: no script, no font, nothing from elsewhere; light, dark and on paper.

use std::fmt::Write as _;

use super::{
    CAVEATS, METRICS, Subject, facts,
    figures::figures,
    headline,
    plot::{STYLE, escaped},
    rows, title,
};

const PAGE: &str = "\
*{box-sizing:border-box}body{margin:0;background:var(--paper);color:var(--ink);\
font:15px/1.5 system-ui,-apple-system,'Segoe UI',sans-serif}
main{max-width:62rem;margin:0 auto;padding:2.5rem 1.25rem 4rem}
h1{font-size:1.7rem;line-height:1.2;margin:0 0 .3rem}h2{font-size:1.15rem;margin:2.4rem 0 .6rem}
p{margin:.3rem 0}.soft,figcaption,.aside{color:var(--soft)}
.legend{display:inline-block;width:.9em;height:.9em;border-radius:2px;background:var(--earth);vertical-align:-.08em}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th{text-align:left;font-weight:600;border-bottom:1px solid var(--soft)}
td{border-bottom:1px solid var(--rule);vertical-align:middle}th,td{padding:.28rem .7rem .28rem 0}
.number{text-align:right}.number,.band,.name{white-space:nowrap}
td.inside{color:var(--earth-ink)}td.outside{color:var(--world);font-weight:600}
svg.strip{display:block;width:150px;height:14px}.strip .rule{stroke:var(--rule)}.strip .earth{fill:var(--earth)}
.strip .dot{fill:var(--world)}.strip .faint{fill:var(--world);opacity:.4}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(24rem,1fr));gap:1.6rem 1.4rem}
figure{margin:0;break-inside:avoid}figure h3{font-size:1rem;margin:0 0 .2rem}figure svg{width:100%;height:auto;display:block}
figcaption{font-size:.85rem;line-height:1.4}.methods td{font-size:.85rem;vertical-align:top}
.scroll{overflow-x:auto}
@media(max-width:28rem){.plots{grid-template-columns:1fr}}
@media print{main{max-width:none;padding:0}body{font-size:10pt}.plots{grid-template-columns:1fr 1fr}tr{break-inside:avoid}}
";

/// The report as an HTML document.
pub fn html(subjects: &[Subject]) -> String {
    let heading = escaped(&title(subjects));
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{heading}</title>\n\
         <style>\n{STYLE}{PAGE}</style>\n</head>\n<body>\n<main>\n<h1>{heading}</h1>\n<p>{}.</p>\n",
        escaped(&headline(subjects)),
    );
    for subject in subjects {
        let name = if subjects.len() > 1 { format!("{}: ", escaped(&subject.name)) } else { String::new() };
        let _ = writeln!(page, "<p class=\"soft\">{name}{}</p>", escaped(&facts(subject)));
    }
    table(&mut page, subjects);
    plots(&mut page, subjects);
    page.push_str("<h2>How to read this</h2>\n<ul>\n");
    CAVEATS.iter().for_each(|caveat| page.push_str(&format!("<li>{}</li>\n", escaped(caveat))));
    page.push_str("</ul>\n");
    methods(&mut page);
    page.push_str("</main>\n</body>\n</html>\n");
    page
}

fn table(page: &mut String, subjects: &[Subject]) {
    let many = subjects.len() > 1;
    let columns: &[&str] = if many {
        &["metric", "median", "5 to 95 %", "on Earth", "", "inside"]
    } else {
        &["metric", "value", "on Earth", "", ""]
    };
    page.push_str("<h2>Metrics</h2>\n<p class=\"soft\"><span class=\"legend\"></span> the band of Earth</p>\n");
    page.push_str("<div class=\"scroll\"><table>\n<tr>");
    for name in columns {
        let class = if ["value", "median", "5 to 95 %"].contains(name) { " class=\"number\"" } else { "" };
        let _ = write!(page, "<th{class}>{name}</th>");
    }
    page.push_str("</tr>\n");
    for row in rows(subjects) {
        let range = if many { format!("<td class=\"number\">{}</td>", escaped(&row.range)) } else { String::new() };
        let _ = writeln!(
            page,
            "<tr><td class=\"name\">{}</td><td class=\"number\">{}</td>{range}<td class=\"band\">{}</td><td>{}</td>\
             <td class=\"{}\">{}</td></tr>",
            escaped(row.title),
            escaped(&row.value),
            escaped(&row.band),
            row.strip,
            row.class,
            escaped(&row.standing),
        );
    }
    page.push_str("</table></div>\n");
}

fn plots(page: &mut String, subjects: &[Subject]) {
    page.push_str("<h2>Plots</h2>\n<div class=\"plots\">\n");
    for figure in figures(subjects) {
        let svg = figure.plot.svg(figure.name, figure.title);
        let (title, caption) = (escaped(figure.title), escaped(&figure.caption));
        let _ = writeln!(page, "<figure>\n<h3>{title}</h3>\n{svg}<figcaption>{caption}</figcaption>\n</figure>");
    }
    page.push_str("</div>\n");
}

fn methods(page: &mut String) {
    page.push_str("<h2>Methods and sources</h2>\n<div class=\"scroll\"><table class=\"methods\">\n");
    page.push_str("<tr><th>metric</th><th>how it is computed</th><th>band, and who says so</th></tr>\n");
    for metric in METRICS {
        let band = metric.band.map_or("no band".to_owned(), |band| band.to_string());
        let cells = metric.cells_m.map_or(String::new(), |cells| format!(", cells of {cells} m"));
        let (method, source) = (escaped(metric.method), escaped(metric.source));
        let title = escaped(metric.title);
        let _ = writeln!(page, "<tr><td>{title}</td><td>{method}</td><td>{band}{cells}: {source}</td></tr>");
    }
    page.push_str("</table></div>\n");
}
