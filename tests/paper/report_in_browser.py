#!/usr/bin/env python3
"""The report in its quick form, in headless Chromium: every picture decodes, nothing is fetched, charts zoom and show values, their data
downloads, it fits on small screens and prints. [STUDY-185]

    report_in_browser.py RIG_LAB RIG_REPLAY

REPORT_KEEP=FOLDER keeps report, pictures of it and the PDF.
"""
import base64
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.common.by import By

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "panel"))

from browser import browser  # noqa: E402

good = True


def check(name, right, detail=""):
    global good
    good = good and bool(right)
    print(("ok      " if right else "FAILED  ") + name, detail, flush=True)


def made(lab, out):
    run = subprocess.run([lab, "report", "--quick", "--out", out], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    print(run.stdout)
    check("every study of the quick form answers yes, or says what it cannot judge", run.returncode == 0, f"status {run.returncode}")
    results = json.loads((out / "results.json").read_text())
    failed = [c["command"] for s in results["sections"] for c in s["commands"] if c["status"] != 0]
    check("no command failed", not failed, failed)
    missing = [c["quantity"] for c in results["comparisons"] if c["ours"] is None]
    check("every compared figure was found", not missing and bool(results["comparisons"]), missing)
    html = (out / "report.html").read_text()
    check("no picture is missing", "is not there" not in html)
    check("its size is bounded", len(html) < 8e6, f"{len(html) / 1e6:.1f} MB")
    for name in re.findall(r'<figure id="([^"]+)"', html):
        section, stem = name.split("-", 1)
        beside = [str(f.relative_to(out / section).with_suffix("")).replace("/", "-") for f in (out / section).rglob("*.svg")]
        check(f"{name}: an SVG beside it", stem in beside or name == "model-fig10" and beside == ["model"])
    return results


def sized(driver, width):
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False})
    time.sleep(0.5)
    check(f"nothing is wider than {width} pixels", driver.execute_script("return document.documentElement.scrollWidth <= innerWidth"))
    kept = os.environ.get("REPORT_KEEP")
    if kept:
        shot = driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": False})
        Path(kept).mkdir(parents=True, exist_ok=True)
        (Path(kept) / f"report_{width}.png").write_bytes(base64.b64decode(shot["data"]))


def charts(driver, folder):
    sized(driver, 400)
    sized(driver, 1280)
    figure = driver.find_element(By.ID, "fig12-stop")
    plots = figure.find_elements(By.CSS_SELECTOR, ".plot")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", plots[0])
    picture = figure.find_element(By.TAG_NAME, "img")
    check("a chart stands in the place of its picture", len(plots) == 3 and not picture.is_displayed())
    legend = figure.find_element(By.CSS_SELECTOR, ".legend")
    axis = lambda: [label.text for label in plots[1].find_elements(By.CSS_SELECTOR, ".dygraph-axis-label-x")]
    before = axis()
    webdriver.ActionChains(driver).move_to_element(plots[0]).perform()
    time.sleep(0.3)
    check("a point shows its values", re.search(r"aircraft [\d.]+\s*wheel [\d.]+\s*time \(s\) [\d.]+", legend.text), legend.text)
    webdriver.ActionChains(driver).move_to_element_with_offset(plots[0], -60, 0).click_and_hold().move_by_offset(120, 0).release().perform()
    time.sleep(0.3)
    check("a drag zooms, all charts of the figure alike", axis() != before and float(axis()[0]) > 1.0, f"{before} to {axis()}")
    figure.find_elements(By.CSS_SELECTOR, "button.csv")[0].click()
    file = folder / "fig12-stop-1.csv"
    end = time.monotonic() + 10
    while not file.exists() and time.monotonic() < end:
        time.sleep(0.1)
    rows = list(csv.reader(file.open()))
    check("its data downloads", rows[0] == ["time (s)", "aircraft", "wheel"] and len(rows) > 500 and float(rows[1][1]) == 61.0, f"{len(rows)} rows")
    link = driver.find_element(By.CSS_SELECTOR, "#fig7-density a.csv")
    check("so does that of a map", link.get_attribute("download") == "fig7-density.csv" and link.get_attribute("href").startswith("data:text/csv"))


def looked_at(driver, folder, report, results):
    driver.get(report.as_uri())
    images, fetched, live, figures = driver.execute_script("""return [
        [...document.images].map(i => [i.complete, i.naturalWidth, i.naturalHeight, i.alt]),
        performance.getEntriesByType('resource').map(e => e.name.slice(0, 30)).filter(n => !n.startsWith('data:')),
        document.querySelectorAll('figure.live').length, document.querySelectorAll('figure').length]""")
    bad = [i for i in images if not (i[0] and i[1] > 300 and i[2] > 200 and i[3])]
    check("every picture decodes, and has a text instead", len(images) > 8 and not bad, bad)
    check("all but a map and a schematic are charts", live == figures - 2, f"{live} of {figures}")
    check("nothing is fetched", not fetched, fetched)
    charts(driver, folder)
    complaints = sorted({e["message"] for e in driver.get_log("browser")})
    check("the browser has nothing to complain about", not complaints, complaints)
    pdf = base64.b64decode(driver.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"])
    pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
    check("it prints", pdf.startswith(b"%PDF") and pages >= len(results["sections"]), f"{pages} pages, {len(pdf) / 1e6:.1f} MB")
    return pdf


def main():
    lab = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        out = folder / "report"
        results = made(lab, out)
        with browser(folder) as driver:
            pdf = looked_at(driver, folder, out / "report.html", results)
        kept = os.environ.get("REPORT_KEEP")
        if kept:
            shutil.copytree(out, kept, dirs_exist_ok=True)
            (Path(kept) / "report.pdf").write_bytes(pdf)
    sys.exit(0 if good else 1)


main()
