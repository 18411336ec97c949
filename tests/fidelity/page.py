"""The page and its tables."""

import html
from collections.abc import Iterable, Sequence
from pathlib import Path

import measures
import numpy as np
from compare import Pair, Result
from flicker import Flicker
from PIL import Image

GOALS = """Goals: single scattering: mean colour within 2 %, FLIP at most 0.05 near and 0.03 far; with multiple
scattering: mean colour within 4 %, FLIP at most 0.08; far pictures within 2 % of the mean of full-fiber ones."""

COLUMNS = (
    "case",
    "mean %",
    "± %",
    "RMSE",
    "noise",
    "FLIP",
    "noise",
    "coverage %",
    "detail %",
    "every fiber %",
    "its FLIP",
    "fine tables %",
    "fine shadows %",
    "table occlusion %",
    "multiple: mean %",
    "± %",
    "RMSE",
    "noise",
    "FLIP",
    "noise",
)

HOT_SPOT_COLUMNS = ("angle °", "yarn: mean %", "± %", "one fiber: mean %", "± %")

FLICKER_COLUMNS = (
    "sequence",
    "most motion px",
    "reference, motion and all %",
    "reference %",
    "renderer %",
    "beyond the reference %",
    "lengths anew in each frame %",
)

GOAL_COLUMNS = ("goal", "cases", "met", "root mean square", "worst")

Row = Sequence[str]


def percent(value: float | None) -> str:
    """With a sign; a dash where there is none."""
    return "–" if value is None else f"{100 * value:+.1f}"


def _measures(pair: Pair) -> list[str]:
    numbers = (pair.rmse, pair.rmse_noise, pair.flip, pair.flip_noise)
    return [percent(pair.mean_error), f"{100 * pair.mean_noise:.1f}", *(f"{number:.3f}" for number in numbers)]


def row(result: Result) -> Row:
    """Of `COLUMNS`."""
    drawn = (result.coverage, result.detail, result.every_fiber)
    finer = (result.fine_tables, result.fine_shadows, result.table_occlusion)
    ablations = [*map(percent, drawn), f"{result.every_fiber_flip:.3f}", *map(percent, finer)]
    return [str(result.case), *_measures(result.single), *ablations, *_measures(result.multiple)]


def hot_spot_row(angle: int, yarn: float, noise: float, one: float, one_noise: float) -> Row:
    """Of `HOT_SPOT_COLUMNS`."""
    return [str(angle), percent(yarn), f"{100 * noise:.1f}", percent(one), f"{100 * one_noise:.1f}"]


def flicker_row(found: Flicker) -> Row:
    """Of `FLICKER_COLUMNS`."""
    numbers = (found.still, found.reference, found.renderer)
    return [
        found.sequence,
        f"{found.moved_pixels:.2f}",
        *(f"{100 * number:.2f}" for number in numbers),
        percent(found.renderer / found.reference - 1),
        f"{100 * found.anew:.2f}",
    ]


def goal_rows(results: list[Result], flickers: list[Flicker]) -> list[Row]:
    """Of `GOAL_COLUMNS`: how many cases meet each goal."""

    def row(name: str, found: list[float], most: float, scale: float = 1.0, unit: str = "") -> Row:
        values = np.array(found)
        if not found:
            return [name, "0", "–", "–", "–"]
        worst = values[np.argmax(np.abs(values))]
        root = np.sqrt(np.mean(values**2))
        numbers = (f"{scale * root:.3g}{unit}", f"{scale * worst:.3g}{unit}")
        return [name, str(len(found)), str(int((np.abs(values) <= most).sum())), *numbers]

    def percents(name: str, found: list[float], most: float) -> Row:
        return row(name, found, most, 100.0, " %")

    near = [r.single.flip for r in results if r.case.view == "near"]
    far = [r.single.flip for r in results if r.case.view == "far"]
    return [
        percents("scattered once: mean colour within 2 %", [r.single.mean_error for r in results], 0.02),
        row("scattered once: FLIP at most 0.05 near", near, 0.05),
        row("scattered once: FLIP at most 0.03 far", far, 0.03),
        percents("all orders: mean colour within 4 %", [r.multiple.mean_error for r in results], 0.04),
        row("all orders: FLIP at most 0.08", [r.multiple.flip for r in results], 0.08),
        percents("far pictures within 2 % of every fiber's", [r.detail for r in results if r.case.view == "far"], 0.02),
        percents("flicker at most 10 % beyond the reference's", [f.renderer / f.reference - 1 for f in flickers], 0.1),
    ]


def markdown(columns: Row, rows: Iterable[Row]) -> str:
    """A table."""
    lines = [columns, ["---", *["---:"] * (len(columns) - 1)], *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _table(columns: Row, rows: Iterable[Row]) -> str:
    def line(tag: str, cells: Row) -> str:
        return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    return "<table>" + line("th", columns) + "".join(line("td", each) for each in rows) + "</table>"


def strip(pair: Pair) -> np.ndarray:
    """Reference, picture, their difference, and FLIP side by side, (h, 4w, 3) bytes.

    In the difference, red is what the picture has too much of, blue too little; full colour is as much as `GREY`.
    FLIP is white at 1.
    """
    factor = measures.exposure(pair.reference, pair.covered)
    difference = factor * (pair.test - pair.reference).mean(axis=2) / measures.GREY
    signed = np.stack([1 + np.minimum(difference, 0), 1 - np.abs(difference), 1 - np.maximum(difference, 0)], axis=2)
    parts = [measures.to_srgb(factor * picture) for picture in (pair.reference, pair.test)]
    parts += [np.clip(signed, 0, 1), np.repeat(pair.flip_map[..., None], 3, axis=2)]
    return np.round(255 * np.clip(np.concatenate(parts, axis=1), 0, 1)).astype(np.uint8)


STYLE = """body { font: 14px sans-serif; margin: 2em } table { border-collapse: collapse; font-size: 12px }
td, th { padding: 2px 7px; text-align: right; border-bottom: 1px solid #ccc } td:first-child { text-align: left }
img { image-rendering: pixelated; width: 1024px; display: block; background: black }
figure { margin: 1em 0 } pre { white-space: pre-wrap }"""


def write(
    folder: Path,
    notes: str,
    results: list[Result],
    hot_spot: list[tuple[int, float, float, float, float]],
    flickers: list[Flicker],
) -> None:
    """Writes `index.html` with its pictures, and `tables.md`."""
    folder.mkdir(parents=True, exist_ok=True)
    figures = []
    for index, result in enumerate(results):
        for kind, pair in (("single", result.single), ("multiple", result.multiple)):
            name = f"{index:03}-{kind}.png"
            Image.fromarray(strip(pair)).save(folder / name)
            caption = f"{result.case}: {kind} scattering, mean {percent(pair.mean_error)} %, FLIP {pair.flip:.3f}"
            figures.append(f'<figure><figcaption>{caption}</figcaption><img src="{name}" alt=""></figure>')
    rows = [row(result) for result in results]
    sun_rows = [hot_spot_row(*each) for each in hot_spot]
    flicker_rows = [flicker_row(found) for found in flickers]
    goals = goal_rows(results, flickers)
    body = f"""<!doctype html><html lang="en"><meta charset="utf-8"><title>Fidelity</title><style>{STYLE}</style>
<h1>Fidelity</h1><pre>{html.escape(notes)}</pre><p>{GOALS}</p>{_table(GOAL_COLUMNS, goals)}{_table(COLUMNS, rows)}
<h2>Self-shadow against the angle between light and view</h2>{_table(HOT_SPOT_COLUMNS, sun_rows)}
<h2>Change from frame to frame</h2>{_table(FLICKER_COLUMNS, flicker_rows)}
<h2>Pictures</h2><p>Reference; picture; difference, red too bright, blue too dark; FLIP.</p>{"".join(figures)}</html>"""
    (folder / "index.html").write_text(body, encoding="utf-8")
    split = COLUMNS.index("multiple: mean %")
    once, all_orders = COLUMNS[:split], ("case", "mean %", *COLUMNS[split + 1 :])
    tables = [
        ("Goals", GOAL_COLUMNS, goals),
        ("Scattered once", once, [each[:split] for each in rows]),
        ("All orders of light", all_orders, [[each[0], *each[split:]] for each in rows]),
        ("By the angle between sun and camera", HOT_SPOT_COLUMNS, sun_rows),
        ("Flicker", FLICKER_COLUMNS, flicker_rows),
    ]
    text = "\n".join([f"{notes}\n", *(f"### {title}\n\n{markdown(*table)}" for title, *table in tables)])
    (folder / "tables.md").write_text(text, encoding="utf-8")
