"""The report of a batch: the same bytes whoever ran it, and when; times stand beside it.

report.csv, index.html    how each mesh ended, figures and pictures
times.csv, times.js       seconds and memory, which the page reads where they are there
"""

from __future__ import annotations

import csv
import io
import json
import statistics
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

from devseg.batch_store import Record, Store
from devseg.batch_task import ENDINGS, MISSING, PATTERN

COLUMNS = (
    "mesh",
    "ending",
    "faces",
    "charts",
    "disks",
    "l2",
    "linf",
    "worst_chart_l2",
    "seam_length",
    "flipped",
    "overlapping",
    "packing",
    "warnings",
    "reason",
)
TIMES = ("mesh", "seconds", "cpu_seconds", "memory_mb")
# Columns of the page and their titles.
_SHOWN = {
    "mesh": "mesh",
    "ending": "ending",
    "faces": "faces",
    "charts": "charts",
    "l2": "L2 stretch",
    "linf": "L∞ stretch",
    "seam_length": "seams",
    "packing": "packing",
    "time": "s",
    "words": "reason, warnings",
}


def write_report(store: Store) -> list[Record | None]:
    """Writes the report of all inputs of the manifest; the records that it shows.

    Several ranks may end at the same time, and each writes what it sees. Each looks again
    afterwards, so that the last report has all records.
    """
    records = _records(store)
    while True:
        store.write("report.csv", _csv(records, COLUMNS))
        store.write("times.csv", _csv(records, TIMES))
        store.write("times.js", _times_script(records))
        store.write("index.html", _page(store, records))
        again = _records(store)
        if again == records:
            return [None if r["ending"] == MISSING else r for r in records]
        records = again


def _records(store: Store) -> list[Record]:
    """Of all inputs; those that another batch has left count as missing."""
    manifest = store.read_manifest()
    names: list[str] = manifest["inputs"]
    found = store.records(names)
    return [
        record
        if record is not None and record["batch"] == manifest["batch"]
        else {"mesh": name, "ending": MISSING, "reason": "", "warnings": []}
        for name, record in zip(names, found, strict=True)
    ]


def summary(records: Sequence[Record]) -> str:
    """One line about all meshes."""
    counts = {e: sum(r["ending"] == e for r in records) for e in ENDINGS}
    words = [f"{n} {e}{'s' if e == PATTERN and n != 1 else ''}" for e, n in counts.items() if n]
    done = [r for r in records if r["ending"] == PATTERN]
    if done:
        words.append(f"median charts {statistics.median(r['charts'] for r in done):g}")
        stretch = [r["l2"] for r in done if r["l2"] is not None]
        words.append(f"median L2 {statistics.median(stretch or [0]):.4f}")
    return f"{len(records)} meshes: {', '.join(words)}"


def _csv(records: Sequence[Record], columns: Sequence[str]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    for record in records:
        writer.writerow({**record, "warnings": "; ".join(record["warnings"])})
    return text.getvalue()


def _times_script(records: Sequence[Record]) -> str:
    times = {r["mesh"]: r["seconds"] for r in records if "seconds" in r}
    return f"window.devsegTimes = {json.dumps(times, indent=0)};\n"


def _page(store: Store, records: Sequence[Record]) -> str:
    template = (Path(__file__).parent / "batch_report.html").read_text(encoding="utf-8")
    heads = "".join(f'<th data-key="{key}">{title}</th>' for key, title in _SHOWN.items())
    options = "".join(f"<option>{ending}</option>" for ending in ENDINGS)
    rows = "".join(_row(store, record) for record in records)
    parts = {"SUMMARY": escape(summary(records)), "HEADS": heads, "OPTIONS": options, "ROWS": rows}
    for name, text in parts.items():
        template = template.replace(f"<!--{name}-->", text)
    return template


def _row(store: Store, record: Record) -> str:
    name = record["mesh"]
    picture = ""
    if store.picture(name).is_file():
        picture = f'<img loading="lazy" src="pictures/{quote(name)}.png" alt="">'
    files = f"meshes/{quote(name)}/"
    shown = escape(name)
    if store.files(name).is_dir():
        shown = f'<a href="{files}">{shown}</a>'
    words = "<br>".join(escape(text) for text in [record["reason"], *record["warnings"]] if text)
    cells = [f'<td class="mesh">{picture}{shown}</td>', f"<td>{record['ending']}</td>"]
    values = {key: record.get(key) for key in _SHOWN}
    cells += [
        f"<td>{_shown_number(values[key])}</td>"
        for key in ("faces", "charts", "l2", "linf", "seam_length", "packing")
    ]
    cells += ['<td class="time"></td>', f'<td class="words">{words}</td>']
    data = {key: value for key, value in values.items() if value is not None}
    return f'<tr data-row="{escape(json.dumps(data))}">{"".join(cells)}</tr>\n'


def _shown_number(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:,}" if isinstance(value, int) else f"{value:.5g}"
