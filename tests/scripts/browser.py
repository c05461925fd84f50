"""Pages of scripts/report in a headless browser: what it complains of, asks for and shows, and whether it prints."""
import html
import json
import re
import shutil
import subprocess

# Appended to a copy of the page; what it finds is read from the DOM that the browser prints. Errors that come before it
# are in the browser's own log.
PROBE = """<script>addEventListener('load', () => {
  const found = {
    widths: [...document.images].map(image => image.naturalWidth),
    requests: performance.getEntriesByType('resource').map(entry => entry.name).filter(name => !name.startsWith('data:')),
    overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
    height: document.body.scrollHeight };
  const element = document.createElement('pre');
  element.id = 'probe';
  element.textContent = JSON.stringify(found);
  document.body.append(element);
})</script>"""


def browser():
    return next((found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None)


def call(folder, *words):
    # A profile of its own, no sandbox (root in a container has none), no requests of the browser's own.
    return subprocess.run([browser(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                           "--disable-background-networking", "--disable-component-update", "--no-first-run",
                           "--enable-logging=stderr", f"--user-data-dir={folder / 'profile'}", *words],
                          capture_output=True, text=True, check=False, timeout=120)


def look(page, folder):
    """What the browser finds: `complaints` (console), `requests`, `widths` of images, `overflow` and `height` in pixels."""
    probed = folder / f"probed_{page.name}"
    probed.write_text(page.read_text(encoding="utf-8") + PROBE, encoding="utf-8")
    done = call(folder, "--window-size=1000,1400", "--virtual-time-budget=5000", "--dump-dom", probed.as_uri())
    told = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    if not told:
        raise SystemExit(f"{browser()} did not show {page}\n{done.stderr[-2000:]}")
    return {"complaints": re.findall(r":CONSOLE.*", done.stderr), **json.loads(html.unescape(told[1]))}


def pages_when_printed(page, folder):
    """Sheets of paper, 0 where there is no PDF."""
    printed = folder / "printed.pdf"
    call(folder, "--no-pdf-header-footer", f"--print-to-pdf={printed}", page.as_uri())
    content = printed.read_bytes() if printed.exists() else b""
    return len(re.findall(rb"/Type\s*/Page\b", content)) if content.startswith(b"%PDF") else 0


SPOILT = """<!doctype html><title>spoilt</title><body><img src="data:image/png;base64,AAAA">
<img src="http://127.0.0.1:9/picture.png"><script>console.error("spoilt"); missing();</script>"""


def check_pages(case, results):
    """The report of `results`; then a page on which everything is wrong, as the control that it would be seen."""
    status, text = case.run("report", results)
    case.expect("there is a report", status == 0, text)
    page = results.resolve() / "report.html"
    found = look(page, case.folder)
    case.expect("nothing in the console", not found["complaints"], found)
    case.expect("nothing is asked for", not found["requests"], found)
    case.expect("all pictures are there", len(found["widths"]) == 4 and min(found["widths"]) > 100, found)
    case.expect("the page fits a window of 1000 pixels, and has a length", found["overflow"] <= 0 and found["height"] > 1000,
                found)
    sheets = pages_when_printed(page, case.folder)
    case.expect(f"it prints on {sheets} sheets", 2 <= sheets <= 20)

    spoilt = case.folder.resolve() / "spoilt.html"
    spoilt.write_text(SPOILT, encoding="utf-8")
    found = look(spoilt, case.folder)
    case.expect("control: both errors are seen", len(found["complaints"]) >= 2, found)
    case.expect("control: the request is seen", found["requests"] == ["http://127.0.0.1:9/picture.png"], found)
    case.expect("control: missing pictures are seen", found["widths"] == [0, 0], found)
