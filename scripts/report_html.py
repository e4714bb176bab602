# SPDX-License-Identifier: BSD-3-Clause
"""A report as one HTML page that needs no other file and no network."""
import base64
import html
from urllib.parse import quote

STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.45 system-ui, sans-serif; margin: 0 auto; max-width: 70rem; padding: 0.8rem; color: #222; background: #fff; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.2rem; margin-top: 2rem; } h3 { font-size: 1.05rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { border-bottom: 1px solid #ddd; padding: 0.35rem 0.6rem; text-align: right; vertical-align: top; white-space: nowrap; }
th:first-child { text-align: left; position: sticky; left: 0; background: #fff; }
td small { display: block; color: #666; font-size: 0.78rem; white-space: normal; min-width: 7.5rem; }
td.literature, th.literature { color: #0b5394; background: #eef4fb; }
td.other, th.other { color: #7a4a00; }
td.failed { color: #a61b1b; font-style: italic; }
figure { margin: 0.6rem 0; } figcaption { color: #555; font-size: 0.85rem; }
svg, img { max-width: 100%; height: auto; border: 1px solid #eee; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.15rem 0.8rem; margin: 0; }
dt { color: #666; } dd { margin: 0; overflow-wrap: anywhere; }
@media (max-width: 40rem) { body { font-size: 15px; padding: 0.5rem; } dl { display: block; } dt { font-size: 0.8rem; }
  th:first-child { white-space: normal; max-width: 6.5rem; overflow-wrap: anywhere; } }
"""


def cell_html(cell, sources):
    details = "".join(f"<small>{html.escape(line)}</small>" for line in cell.details)
    mark = ""
    if cell.kind == "literature" and cell.text:
        mark = f"<sup>{sources.setdefault(cell.note, len(sources) + 1)}</sup>"
    title = f' title="{html.escape(cell.note, quote=True)}"' if cell.note else ""
    return f'<td class="{cell.kind}"{title}>{html.escape(cell.text)}{mark}{details}</td>'


def table_html(table, sources):
    kinds = [cells.kind for cells in table.rows[0][1]] if table.rows else []
    heads = "".join(f'<th scope="col" class="{"literature" if kind == "literature" else ""}">{html.escape(column)}</th>'
                    for column, kind in zip(table.columns, kinds))
    lines = [f"<h2>{html.escape(table.title)} ({html.escape(table.unit)})</h2>"]
    if table.note:
        lines.append(f"<p>{html.escape(table.note)}</p>")
    lines.append(f'<div class="wide"><table><thead><tr><th scope="col">sequence</th>{heads}</tr></thead><tbody>')
    for heading, cells in table.rows:
        row = "".join(cell_html(cell, sources) for cell in cells)
        lines.append(f'<tr><th scope="row">{html.escape(heading)}</th>{row}</tr>')
    lines.append("</tbody></table></div>")
    return "\n".join(lines)


def picture(path, caption):
    data = base64.b64encode(path.read_bytes()).decode()
    return (f'<figure><img src="data:image/png;base64,{data}" alt="{html.escape(caption, quote=True)}">'
            f"<figcaption>{html.escape(caption)}</figcaption></figure>")


def link(address, text):
    return f'<p><a href="{html.escape(quote(str(address)), quote=True)}">{html.escape(text)}</a></p>'


def drawing(svg, caption):
    return f"<figure>{svg}<figcaption>{html.escape(caption)}</figcaption></figure>"


def page(tables, sections, facts):
    """`sections`: [(heading, [html])], one for each sequence."""
    sources = {}
    body = [table_html(table, sources) for table in tables]
    listed = "".join(f"<li>{html.escape(source)}</li>" for source in sources)
    body.append(f"<p>Blue: figures of the literature, from</p><ol>{listed}</ol>" if sources else "")
    for heading, parts in sections:
        body.append(f"<h2>{html.escape(heading)}</h2>")
        body += parts
    known = "".join(f"<dt>{html.escape(name)}</dt><dd>{html.escape(value)}</dd>" for name, value in facts)
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>posefusion: report</title><style>{STYLE}</style></head>
<body><h1>posefusion: report</h1><dl>{known}</dl>
{chr(10).join(body)}
</body></html>
"""
