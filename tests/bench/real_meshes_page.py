"""The page of real_meshes.py: what failed and why, then all meshes with their pictures."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any
from urllib.parse import quote

_STYLE = """
body { font: 14px sans-serif; margin: 2em; color: #222 }
table { border-collapse: collapse } td, th { padding: 2px 10px; text-align: left }
tr:nth-child(even) { background: #f4f4f4 }
.meshes { display: grid; grid-template-columns: repeat(auto-fill, 420px); gap: 16px }
figure { margin: 0 } figcaption { font-size: 12px } figure img { width: 400px }
.bad { color: #b00 }
"""
_LARGE_L2 = 1.02


def page(records: Sequence[dict[str, Any]], summary: str, endings: Sequence[str]) -> str:
    """The whole HTML text; the first of the endings is success."""
    failed = [r for ending in reversed(endings[1:]) for r in records if r["ending"] == ending]
    rows = "".join(
        f"<tr><td>{escape(r['mesh'])}<td>{r['ending']}<td>{r['cpu_seconds']} s"
        f"<td>{r['memory_mb']} MB<td>{escape(r['reason'])}</tr>\n"
        for r in failed
    )
    # The worst ones first.
    done = sorted((r for r in records if r["ending"] == endings[0]), key=lambda r: -(r["l2"] or 9))
    return (
        '<!doctype html><meta charset="utf-8"><title>Meshes</title>'
        f"<style>{_STYLE}</style>\n<p>{escape(summary)}</p>\n"
        f"<h2>No pattern</h2>\n<table>\n{rows}</table>\n"
        f'<h2>Patterns</h2>\n<div class="meshes">\n{"".join(map(_figure, done))}</div>\n'
    )


def _figure(record: dict[str, Any]) -> str:
    name = record["mesh"]
    bad = record["l2"] is None or record["l2"] > _LARGE_L2
    l2 = "no number" if record["l2"] is None else f"{record['l2']:.4f}"
    warnings = "".join(f"<br>{escape(text)}" for text in record["warnings"])
    return (
        f'<figure><img loading="lazy" src="pictures/{quote(name)}.png" alt="">'
        f"<figcaption><b>{escape(name)}</b>, {record['faces']} faces, {record['charts']} charts, "
        f'<span class="{"bad" if bad else "good"}">L2 {l2}</span>, '
        f"{record['cpu_seconds']} s{warnings}</figcaption></figure>\n"
    )
