"""The page: every text that comes from a file is escaped, nothing is fetched from anywhere."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterator, Sequence
from datetime import datetime
from html import escape
from importlib import resources
from pathlib import Path

from sphcloth.programs import installed_version
from sphcloth.report.collect import Findings, Result
from sphcloth.report.viewer import Packed

# the browser itself keeps the page from reaching out, whatever is in it
POLICY = (
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'"
)
# tables of a benchmark that are nested deeper are shown as text
DEEPEST = 4
# a picture that is larger is no plot of ours
LARGEST_PICTURE = 8_000_000


def page(found: Findings, shown: Sequence[Packed], title: str) -> str:
    """Return the page as HTML."""
    parts = [
        (name, f"{name.lower().replace(' ', '-')}", body) for name, body in _parts(found, shown)
    ]
    links = "".join(f'<li><a href="#{anchor}">{name}</a></li>' for name, anchor, _ in parts)
    body = "".join(
        f'<section id="{anchor}"><h2>{name}</h2>{text}</section>' for name, anchor, text in parts
    )
    made = f"made {datetime.now():%Y-%m-%d %H:%M} by sphcloth {installed_version('sphcloth')}"
    script = f"<script>{_asset('viewer.js')}</script>" if shown else ""
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{_asset('page.css')}</style></head><body>"
        f"<header><h1>{escape(title)}</h1><p>{escape(made)}</p></header>"
        f"<nav><ul>{links}</ul></nav><main>{body}</main>{script}</body></html>\n"
    )


def _parts(found: Findings, shown: Sequence[Packed]) -> Iterator[tuple[str, str]]:
    """Yield name and HTML of each section that has something to show."""
    makers = {
        "validation": ("Validation", _validation),
        "tradeoff": ("Error against cost", _tradeoffs),
        "bench": ("Speed", _benches),
        "run": ("Runs", _runs),
        "advice": ("Advice", _advice),
    }
    if shown:
        yield "Trajectories", "".join(_viewer(each) for each in shown)
    for kind, (name, make) in makers.items():
        if found.results[kind]:
            yield name, make(found.results[kind])
    if found.skipped:
        rows = [(_code(path), escape(reason[:200])) for path, reason in found.skipped]
        yield "Left out", _table(("file", "why"), rows)


def _viewer(packed: Packed) -> str:
    # "</script>" in a string would end the script: no "<" is left
    data = json.dumps(packed.data, separators=(",", ":")).replace("<", "\\u003c")
    return (
        f'<div class="viewer"><h3>{escape(packed.name)} <span class="soft">'
        f"{escape(packed.caption)}</span></h3>"
        f'<canvas tabindex="0" aria-label="{escape(packed.name)} in three dimensions"></canvas>'
        '<div class="controls"><button class="play">Play</button>'
        '<input type="range" min="0" value="0" aria-label="frame">'
        '<span class="label"></span><button class="reset">Reset view</button></div>'
        '<p class="soft">Drag to turn, wheel to zoom; arrow keys step, space plays.</p>'
        f'<script type="application/json">{data}</script></div>'
    )


def _validation(results: Sequence[Result]) -> str:
    passed = sum(result.values["passed"] is True for result in results)
    total = len(results)
    mark = "good" if passed == total else "bad"
    head = f'<p><span class="{mark}">{passed} of {total}</span> cases within all their limits</p>'
    return head + "".join(_case(result) for result in results)


def _case(result: Result) -> str:
    values = result.values
    metrics = {n: m for n, m in values["metrics"].items() if isinstance(m, dict)}
    judged = [m for m in metrics.values() if m.get("limit") is not None]
    within = sum(m.get("passed") is True for m in judged)
    size = "quick" if values.get("quick") else "full size"
    told = f"{within} of {len(judged)} limits met, {size}, {_number(values.get('wall_s'))} s"
    rows = [
        (
            _code(name),
            _number(m.get("value")),
            _number(m.get("limit")),
            escape(str(m.get("unit", ""))),
            _badge(m.get("passed")),
        )
        for name, m in metrics.items()
    ]
    table = _table(("metric", "value", "limit", "unit", ""), rows, numbers=(1, 2))
    return (
        f"<details{'' if values['passed'] is True else ' open'}><summary>"
        f"<b>{escape(values['case'])}</b> {_badge(values['passed'])} "
        f'<span class="soft">{escape(told)}</span></summary>{table}'
        f"{_settings(values.get('parameters'))}{_pictures(result)}</details>"
    )


def _tradeoffs(results: Sequence[Result]) -> str:
    return "".join(_tradeoff(result) for result in results)


def _tradeoff(result: Result) -> str:
    values = result.values
    rows = []
    for cost, best in values["best"].items():
        schemes = best.get("by_scheme", {}) if isinstance(best, dict) else {}
        for scheme, each in schemes.items() if isinstance(schemes, dict) else ():
            given = each.get("values") if isinstance(each, dict) else None
            is_best = scheme == best.get("overall")
            rows.append((escape(str(cost)), escape(str(scheme)), _inline(given), _best(is_best)))
    measured = f"cheapest settings within an error of {_number(values.get('error'))}"
    table = _table(("cost", "scheme", "setting", ""), rows) if rows else "<p>none</p>"
    return f"<h3>{escape(values['scene'])}</h3><p>{measured}</p>{table}{_pictures(result)}"


def _best(is_best: bool) -> str:
    return '<span class="good">cheapest</span>' if is_best else ""


def _benches(results: Sequence[Result]) -> str:
    return "".join(
        f"<h3>{escape(result.values['bench'])}</h3>"
        + _tree({name: value for name, value in result.values.items() if name != "bench"})
        for result in results
    )


def _tree(values: dict, depth: int = 0) -> str:
    """Return nested figures as a table in tables; a spread is one number with its extremes."""
    rows = []
    for name, value in values.items():
        if isinstance(value, dict) and set(value) != {"value", "least", "most"}:
            shown = _tree(value, depth + 1) if depth < DEEPEST else _code(json.dumps(value)[:500])
        else:
            shown = _figure(value)
        rows.append((escape(str(name)), shown))
    return _table(("figure", "value"), rows) if rows else ""


def _figure(value: object) -> str:
    if isinstance(value, dict):
        extremes = f"{_number(value['least'])} to {_number(value['most'])}"
        return f'{_number(value["value"])} <span class="soft">({extremes})</span>'
    if isinstance(value, list):
        return escape(", ".join(map(str, value))[:500])
    return _number(value)


def _runs(results: Sequence[Result]) -> str:
    plain = ("time", "steps", "poured", "on_sheet", "spilled", "crossed", "mass_defect")
    texts = []
    for result in results:
        values = result.values
        rows = [(escape(name.replace("_", " ")), _number(values.get(name))) for name in plain]
        idle = [str(each.get("topic")) for each in _dicts(values.get("unused"))]
        rows.append(("never needed", escape("; ".join(idle)) or "-"))
        name = escape(result.path.parent.name)
        table = _table(("", ""), rows)
        texts.append(f"<h3>{name} {_badge(values['passed'])}</h3>{table}{_pictures(result)}")
    return "".join(texts)


def _advice(results: Sequence[Result]) -> str:
    texts = []
    for result in results:
        rows = [
            (
                escape(kind),
                escape(str(each.get("topic"))),
                escape(str(each.get("measured"))),
                _line(each),
            )
            for kind in ("facts", "needs", "unused")
            for each in _dicts(result.values[kind])
        ]
        table = _table(("", "topic", "measured", "line to type"), rows)
        texts.append(f"<h3>{_code(result.values['script'])}</h3>{table}")
    return "".join(texts)


def _line(finding: dict) -> str:
    return _code(finding["line"]) if finding.get("line") else ""


def _dicts(values: object) -> list[dict]:
    return [each for each in values if isinstance(each, dict)] if isinstance(values, list) else []


def _settings(values: object) -> str:
    shown = _inline(values)
    return f'<p class="soft">{shown}</p>' if shown else ""


def _inline(values: object) -> str:
    """Return settings as ``name = value``, one behind the other."""
    if not isinstance(values, dict):
        return ""
    return ", ".join(f"{escape(str(name))} = {_number(value)}" for name, value in values.items())


def _pictures(result: Result) -> str:
    return "".join(_picture(path) for path in result.pictures)


def _picture(path: Path) -> str:
    """Return a PNG as part of the page; nothing for what is none, or too large."""
    content = path.read_bytes() if path.stat().st_size <= LARGEST_PICTURE else b""
    if not content.startswith(b"\x89PNG"):
        return ""
    text = base64.b64encode(content).decode()
    return f'<img loading="lazy" alt="{escape(path.stem)}" src="data:image/png;base64,{text}">'


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]], numbers: Sequence[int] = ()) -> str:
    """Return a table; heads and cells are HTML already."""

    def cells(tag: str, row: Sequence[str]) -> str:
        classes = [' class="number"' if place in numbers else "" for place in range(len(row))]
        filled = zip(classes, row, strict=True)
        return "<tr>" + "".join(f"<{tag}{each}>{text}</{tag}>" for each, text in filled) + "</tr>"

    head = cells("th", heads) if any(heads) else ""
    return f'<div class="scroll"><table>{head}{"".join(cells("td", r) for r in rows)}</table></div>'


def _number(value: object) -> str:
    """Return a value for a cell: numbers with four digits, other things as escaped text."""
    if isinstance(value, bool) or value is None:
        return "-" if value is None else str(value).lower()
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(value, float):
        return f"{value:.4g}" if math.isfinite(value) else "-"
    return escape(str(value)[:500])


def _badge(passed: object) -> str:
    if passed is None:
        return ""
    return '<span class="good">ok</span>' if passed is True else '<span class="bad">failed</span>'


def _code(text: object) -> str:
    return f"<code>{escape(str(text))}</code>"


def _asset(name: str) -> str:
    return (resources.files("sphcloth.report") / name).read_text(encoding="utf-8")
