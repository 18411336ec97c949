"""Pictures by the renderer beside those by the path tracer: how right the renderer is."""

import argparse
import datetime
import os
import platform
import time
from pathlib import Path

import compare
import flicker
import lisle
import models
import page

FLICKER_SAMPLES = 8
"""Of each picture by which flicker is measured: a product of two seeds has no bias from noise."""


def main() -> None:
    """Draws, measures, and writes the page anew after each case, so that a run that is stopped leaves what it has."""
    parser = argparse.ArgumentParser(prog="cargo xtask fidelity", description=__doc__)
    parser.add_argument("--full", action="store_true", help="the whole product of the set: many hours")
    parser.add_argument("--samples", type=int, default=256, help="of each picture (default 256)")
    parser.add_argument("--filter", default="", help="only cases whose line has this text")
    parser.add_argument("--out", type=Path, default=models.REPOSITORY / "out" / "fidelity")
    arguments = parser.parse_args()
    if arguments.samples < 2:
        parser.error("--samples: the noise of one sample is unknown")
    available = models.models()
    cases = (compare.everything if arguments.full else compare.few)(available)
    cases = [case for case in cases if arguments.filter in str(case)]
    if not cases:
        parser.error(f"--filter: no case has {arguments.filter!r}")

    renderer = lisle.Renderer()
    notes = (
        f"{datetime.date.today()}; {os.cpu_count()} cores, {platform.machine()}; {renderer.adapter.name}; "
        f"{arguments.samples} samples by each. Models: {', '.join(available)}."
    )
    print(notes, flush=True)
    start = time.monotonic()
    hot_spot = compare.hot_spot(renderer, arguments.samples)
    print(page.markdown(page.HOT_SPOT_COLUMNS, [page.hot_spot_row(*each) for each in hot_spot]), flush=True)
    results: list[compare.Result] = []
    made: dict[str, lisle.Yarns] = {}
    for case in cases:
        if case.model not in made:
            made[case.model] = models.MODELS[case.model]()
        result = compare.compare(renderer, case, made[case.model], arguments.samples)
        results.append(result)
        single, multiple = result.single, result.multiple
        print(
            f"[{len(results)}/{len(cases)}, {time.monotonic() - start:.0f} s] {case}: single "
            f"{page.percent(single.mean_error)} %, FLIP {single.flip:.3f}; multiple "
            f"{page.percent(multiple.mean_error)} %, FLIP {multiple.flip:.3f}",
            flush=True,
        )
        page.write(arguments.out, notes, results, hot_spot, [])
    flickers = []
    for found in flicker.flicker(renderer, FLICKER_SAMPLES):
        flickers.append(found)
        print(page.markdown(page.FLICKER_COLUMNS, [page.flicker_row(found)]), flush=True)
        page.write(arguments.out, notes, results, hot_spot, flickers)
    print(page.markdown(page.GOAL_COLUMNS, page.goal_rows(results, flickers)))
    print(f"{time.monotonic() - start:.0f} s")
    print(arguments.out / "index.html")


if __name__ == "__main__":
    main()
