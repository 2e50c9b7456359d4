#!/usr/bin/env python3
"""The report in its quick form, read by headless Chromium: every picture decodes, nothing is fetched, it prints. [STUDY-185]

    report_in_browser.py RIG_LAB RIG_REPLAY
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--host-resolver-rules=MAP * ~NOTFOUND"]
# Only the copy that the test reads has a script: it asks the browser what it made of the page.
PROBE = """<script>addEventListener('load', () => {
  const images = [...document.images].map(i => [i.complete, i.naturalWidth, i.naturalHeight, i.alt]);
  const fetched = performance.getEntriesByType('resource').map(e => e.name.slice(0, 30)).filter(n => !n.startsWith('data:'));
  const wide = document.documentElement.scrollWidth > innerWidth;
  document.body.textContent = 'PROBE' + JSON.stringify({images, fetched, wide}) + 'EBORP';
});</script>"""


def browse(folder, *arguments):
    profile = tempfile.mkdtemp(dir=folder)
    return subprocess.run(["chromium", *FLAGS, f"--user-data-dir={profile}", *arguments], check=True, timeout=240,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout


def check(name, good, detail=""):
    print(("ok      " if good else "FAILED  ") + name, detail)
    return good


def main():
    lab, replay = map(Path, sys.argv[1:])
    if not shutil.which("chromium"):
        sys.exit("chromium is not installed: ./rig setup")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "report"
        run = subprocess.run([lab, "report", "--quick", "--out", out], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        print(run.stdout)
        good = check("every study of the quick form answers yes, or says what it cannot judge", run.returncode == 0, f"status {run.returncode}")
        results = json.loads((out / "results.json").read_text())
        failed = [c["command"] for s in results["sections"] for c in s["commands"] if c["status"] != 0]
        good &= check("no command failed", not failed, failed)
        missing = [c["quantity"] for c in results["comparisons"] if c["ours"] is None]
        good &= check("every compared figure was found", not missing and bool(results["comparisons"]), missing)

        html = (out / "report.html").read_text()
        pictures = len(re.findall("<img ", html))
        good &= check("no picture is missing", "is not there" not in html)
        good &= check("no script, no address", not re.search(r"<script|https?:|<link|url\(", html))

        probe = Path(folder) / "probe.html"
        probe.write_text(html.replace("</body>", PROBE + "</body>"))
        dom = browse(folder, "--window-size=1280,2000", "--virtual-time-budget=20000", "--dump-dom", probe.as_uri()).decode()
        found = json.loads(re.search("PROBE(.*?)EBORP", dom, re.S).group(1).replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">"))
        good &= check("the browser has them all", len(found["images"]) == pictures > 8, f"{pictures} pictures")
        bad = [i for i in found["images"] if not (i[0] and i[1] > 300 and i[2] > 200 and i[3])]
        good &= check("every picture decodes, and has a text instead", not bad, bad)
        good &= check("nothing is fetched", not found["fetched"], found["fetched"])
        good &= check("nothing is wider than the window", not found["wide"])

        pdf = Path(folder) / "report.pdf"
        browse(folder, f"--print-to-pdf={pdf}", "--no-pdf-header-footer", (out / "report.html").as_uri())
        pages = len(re.findall(rb"/Type\s*/Page\b", pdf.read_bytes()))
        good &= check("it prints", pdf.read_bytes().startswith(b"%PDF") and pages >= len(results["sections"]), f"{pages} pages")
        kept = os.environ.get("REPORT_KEEP")
        if kept:
            shutil.copytree(out, kept, dirs_exist_ok=True)
            shutil.copy(pdf, kept)
        sys.exit(0 if good else 1)


main()
