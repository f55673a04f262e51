#!/usr/bin/env bash
# Opens reports in a headless Chromium, at the width of a phone and of a desk, and checks: nothing on the console, no
# horizontal scrolling, plots drawn, nothing loaded from elsewhere.
# Usage: check.sh REPORT.html PLOTS [REPORT.html PLOTS ...]; PLOTS is the least number of plots.
set -euo pipefail

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$browser" ]; then
    echo "pages: skipped, there is no chromium (Debian: apt-get install chromium)"
    exit 0
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

while [ $# -ge 2 ]; do
    report=$1 plots=$2
    shift 2
    # Windows of a headless browser have a least width; frames inside a page have none.
    {
        cat <<'PAGE'
<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><body><pre id="out">not finished</pre><script>
const bytes = Uint8Array.from(atob("
PAGE
        base64 -w0 "$report"
        cat <<'PAGE'
".trim()), c => c.charCodeAt(0));
const text = new TextDecoder().decode(bytes);
const lines = [];
let open = 2;
for (const width of [375, 1280]) {
  const frame = document.createElement("iframe");
  frame.style.cssText = `width:${width}px;height:900px;border:0`;
  frame.onload = () => {
    const page = frame.contentDocument, root = page.documentElement;
    page.querySelectorAll("details").forEach(d => d.open = true);
    const drawn = [...page.querySelectorAll("svg.ts-figure")].filter(svg =>
      svg.getBoundingClientRect().width > 100 && svg.querySelectorAll("path.line").length > 0).length;
    const small = [...page.querySelectorAll("svg.chart text")].map(t => t.getBoundingClientRect().height).filter(h => h > 0);
    const loads = frame.contentWindow.performance.getEntriesByType("resource").length;
    lines.push(`width ${width} scroll ${root.scrollWidth - root.clientWidth} plots ${drawn} ` +
      `text ${Math.round(Math.min(...small, 99))} loads ${loads}`);
    if (--open === 0) document.getElementById("out").textContent = lines.join("\n");
  };
  frame.srcdoc = text;
  document.body.append(frame);
}
</script>
PAGE
    } | tr -d '\n' >"$scratch/page.html"
    "$browser" --headless --no-sandbox --disable-gpu --enable-logging=stderr --user-data-dir="$scratch/profile" \
        --window-size=1400,1000 --virtual-time-budget=20000 --dump-dom "file://$scratch/page.html" \
        >"$scratch/dom" 2>"$scratch/log" || { cat "$scratch/log"; exit 1; }
    if grep CONSOLE "$scratch/log"; then
        echo "pages: $report writes to the console"
        exit 1
    fi
    found=$(grep -oE "width [0-9]+ scroll -?[0-9]+ plots [0-9]+ text [0-9]+ loads [0-9]+" "$scratch/dom" || true)
    echo "$report"
    echo "$found" | sed 's/^/    /'
    if [ "$(grep -c '^width' <<<"$found")" != 2 ]; then
        echo "pages: $report did not load"
        exit 1
    fi
    while read -r _ width _ scroll _ drawn _ text _ loads; do
        [ "$scroll" -le 0 ] || { echo "pages: scrolls sideways by $scroll pixels at width $width"; exit 1; }
        [ "$drawn" -ge "$plots" ] || { echo "pages: $drawn plots at width $width, not $plots"; exit 1; }
        [ "$text" -ge 9 ] || { echo "pages: text in plots is $text pixels high at width $width"; exit 1; }
        [ "$loads" = 0 ] || { echo "pages: loads $loads files"; exit 1; }
    done < <(grep '^width' <<<"$found")
done
