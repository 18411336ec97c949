//! Markdown tables, and how their numbers are written.

/// A table with its columns aligned; the first `left` columns to the left, the rest to the right.
pub fn markdown(head: &[&str], left: usize, rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.chain([head[column].chars().count(), 2]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let line = |cells: &[&str]| {
        let padded = cells.iter().zip(&widths).enumerate().map(|(i, (cell, width))| {
            if i < left { format!(" {cell:<width$} |") } else { format!(" {cell:>width$} |") }
        });
        format!("|{}\n", padded.collect::<String>())
    };
    let rule = widths.iter().enumerate().map(|(i, width)| {
        let dashes = "-".repeat(width + 1);
        if i < left { format!("{dashes}-|") } else { format!("{dashes}:|") }
    });
    let mut text = line(head) + &format!("|{}\n", rule.collect::<String>());
    for row in rows {
        text += &line(&row.iter().map(String::as_str).collect::<Vec<_>>());
    }
    text
}

/// Seconds.
pub fn seconds(value: f64) -> String {
    format!("{value:.3}")
}

/// Seconds, or a dash.
pub fn maybe_seconds(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), seconds)
}

/// Milliseconds.
pub fn milliseconds(value: f64) -> String {
    format!("{value:.1}")
}

/// Mebibytes.
pub fn mebibytes(bytes: u64) -> String {
    format!("{:.1}", bytes as f64 / f64::from(1 << 20))
}

/// Millions.
pub fn millions(count: u64) -> String {
    format!("{:.2} M", count as f64 * 1e-6)
}

/// A load or a number of cores, or a dash.
pub fn tenths(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), |value| format!("{value:.1}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let rows = [vec!["glove".into(), "0.5".into()], vec!["é".into(), "12.25".into()]];
        let text = markdown(&["model", "s"], 1, &rows);
        assert_eq!(text, "| model |     s |\n|-------|------:|\n| glove |   0.5 |\n| é     | 12.25 |\n");
    }
}
