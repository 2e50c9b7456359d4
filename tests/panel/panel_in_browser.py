#!/usr/bin/env python3
"""The panel in headless Chromium: live values move and the token decides, two maneuvers lie over each other, a note with HTML stays text, sliders
and a runway draw a stop; pages at 1280 and 400 pixels. [BRG-520] [BRG-521] [STUDY-190]

    panel_in_browser.py RIG_LAB PANEL_OF_NOTHING

PANEL_KEEP=FOLDER keeps pictures of the pages.
"""
import contextlib
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select

from browser import browser, picture, sized, text, wait

NOTE = "<img src=x onerror=\"document.title='taken over'\"> tread cut"
good = True


def check(name, right, detail=""):
    global good
    good = good and bool(right)
    print(("ok      " if right else "FAILED  ") + name, detail, flush=True)


@contextlib.contextmanager
def program(*command):
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        yield re.search(r"panel: (\S+/)", line).group(1), re.search(r"token=(\w+)", line).group(1) if "token" in line else ""
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(10)


def fits(driver, name):
    for width in (1280, 400):
        sized(driver, width)
        time.sleep(0.5)
        check(f"{name} fits in {width} pixels", driver.execute_script("return document.documentElement.scrollWidth <= innerWidth"))
        picture(driver, f"{name}_{width}")
    sized(driver, 1280)


def quiet(driver, name):
    # dygraphs writes a style of its own into the page, which the policy blocks; nothing that is used looks different by it.
    known = ("status of 401", "status of 503", "dygraph.js 1 Applying inline style")
    bad = sorted({e["message"] for e in driver.get_log("browser") if e["level"] == "SEVERE" and not any(k in e["message"] for k in known)})
    check(f"{name}: the browser has nothing to complain about", not bad, bad)


def live(driver, nothing):
    with program(nothing) as (url, token):
        driver.get(url)
        wait(driver, lambda d: "m/s" in text(d, "live_rim"))
        first = text(driver, "live_rim")
        wait(driver, lambda d: text(d, "live_rim") != first)
        check("values move", True, f"{first} to {text(driver, 'live_rim')}")
        seen = driver.execute_async_script("""const done = arguments[0], source = new EventSource('/events'), times = [];
            source.addEventListener('pixel', event => {
                times.push(JSON.parse(event.data).t);
                if (times.length === 100) { source.close(); done(times); }
            });""")
        check("each pixel is newer than the one before", all(a < b for a, b in zip(seen, seen[1:])), f"{seen[0]} to {seen[-1]} s")
        wait(driver, lambda d: len(d.find_elements(By.CSS_SELECTOR, "#live_charts canvas")) >= 12)
        check("states are text", "controlling <b>" in text(driver, "facts"))
        check("simulated is marked", "simulated" in text(driver, "kind"))
        check("the page says where the emergency stop is", "red button at the rig" in text(driver, "stop"))
        fits(driver, "live")
        driver.find_element(By.ID, "sound").click()
        driver.find_element(By.ID, "abort").click()
        wait(driver, lambda d: "only with the token" in text(d, "said"))
        check("no token: refused", not driver.find_elements(By.CSS_SELECTOR, ".alarm strong"))
        driver.find_element(By.ID, "token").send_keys("0" * 32)
        driver.find_element(By.ID, "abort").click()
        time.sleep(0.5)
        check("a wrong token: refused", "only with the token" in text(driver, "said"))
        driver.get("about:blank")
        driver.get(url + "#token=" + token)
        wait(driver, lambda d: d.find_elements(By.ID, "abort"))
        check("the token leaves the address", token not in driver.current_url, driver.current_url)

        def offered(*words):
            wait(driver, lambda d: [b.text for b in d.find_elements(By.CSS_SELECTOR, "#buttons button") if b.is_displayed()] == list(words))
            check(f"offered: {', '.join(words)}", True)
        offered("Abort this maneuver", "Start")
        driver.find_element(By.ID, "resume").click()
        offered("Abort this maneuver", "Pause after this maneuver")
        driver.find_element(By.ID, "hold").click()
        offered("Abort this maneuver", "Go on")
        driver.find_element(By.ID, "abort").click()
        wait(driver, lambda d: "aborts: 1" in text(d, "said"))
        check("the token: taken", True)
        wait(driver, lambda d: "start again when you are ready" in text(d, "alarms"))
        check("the alarm says what to do", "you asked for it" in text(driver, "alarms"))
        check("the alarm is in the tab's title, too", driver.title.startswith("\u26a0"))
        check("an open interlock is named", "guard closed: open" in text(driver, "interlocks"))
        picture(driver, "alarm_1280")
    wait(driver, lambda d: "no connection" in text(d, "link"))
    check("a panel that is gone is said to be", True)


def campaign(lab, folder):
    """Two maneuvers of a ledger with the logs that the bridge would have left."""
    subprocess.run([lab, "endurance", "--scenario", "config/scenarios/heavy.toml", "--maneuvers", "2", "--out", folder], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for seed in ("1", "2"):
        subprocess.run([lab, "maneuver", "config/scenarios/heavy.toml", "--seed", seed, "--out", folder / "heavy" / ("000" + seed)], check=True,
                       stdout=subprocess.DEVNULL)


def downloaded(folder, name):
    end = time.monotonic() + 10
    while not (folder / name).exists() and time.monotonic() < end:
        time.sleep(0.1)
    return (folder / name).read_text()


def recorded(driver, lab, folder):
    campaign(lab, folder / "brake")
    with program(lab, "panel", folder / "brake", "--panel", "127.0.0.1:0") as (url, token):
        driver.get(url)
        wait(driver, lambda d: len(d.find_elements(By.CSS_SELECTOR, "#runs input")) == 2)
        for box in driver.find_elements(By.CSS_SELECTOR, "#runs input"):
            box.click()
        wait(driver, lambda d: "2 slip" in text(d, "recorded_charts"))
        check("two maneuvers lie over each other", "1 slip" in text(driver, "recorded_charts"))
        rows = wait(driver, lambda d: [r.text for r in d.find_elements(By.CSS_SELECTOR, "#differences tr.differs")])
        told = [r.text for r in driver.find_elements(By.CSS_SELECTOR, "#differences tr")]
        check("what the controller was told is named", "law on the bus wheel_slip wheel_slip" in told, told)
        check("the slip reference, too", "slip reference on the bus 0.24 0.24" in told)
        length = [row for row in rows if row.startswith("length, m")]
        check("differences are named", re.search(r"\([+\u2212][\d.]+\)", length[0]), length)
        canvases = len(driver.find_elements(By.CSS_SELECTOR, "#recorded_charts .plot canvas"))
        check("plots are drawn", canvases >= 10, f"{canvases} canvases")
        plot = driver.find_elements(By.CSS_SELECTOR, "#recorded_charts .plot")[0]
        webdriver.ActionChains(driver).move_to_element_with_offset(plot, -60, 0).click_and_hold().move_by_offset(120, 0).release().perform()
        time.sleep(0.5)
        driver.find_element(By.CSS_SELECTOR, "#recorded_charts .csv").click()
        csv = downloaded(folder, "maneuvers.csv").splitlines()
        times = [float(line.split(",")[0]) for line in csv[1:]]
        check("a zoomed view is what is exported, all plots alike", 0.2 < times[-1] - times[0] < 8.0, f"{times[0]} to {times[-1]} s")
        check("columns have names and units", "1 braked wheel, m/s" in csv[0] and "2 brake pressure, MPa" in csv[0], csv[0][:90])
        driver.find_element(By.CSS_SELECTOR, "#recorded_charts .svg").click()
        svg = downloaded(folder, "maneuvers.svg")
        check("the view as SVG", svg.startswith("<svg") and svg.count("<polyline") >= 10, f"{svg.count('<polyline')} curves")
        fits(driver, "recorded")

        def write(note):
            driver.find_element(By.ID, "note_text").clear()
            driver.find_element(By.ID, "note_text").send_keys(note)
            driver.find_element(By.ID, "note_who").clear()
            driver.find_element(By.ID, "note_who").send_keys("A. Rossi")
            driver.find_element(By.CSS_SELECTOR, "#note button").click()
        write(NOTE)
        wait(driver, lambda d: "only with the token" in text(d, "said"))
        driver.find_element(By.ID, "token").send_keys(token)
        write(NOTE)
        wait(driver, lambda d: NOTE in text(d, "notes"))
        check("a note with HTML is text", NOTE in text(driver, "runs") and not driver.find_elements(By.CSS_SELECTOR, "#notes img, #runs img"))
        check("and runs nothing", "taken over" not in driver.title)

        driver.find_element(By.ID, "tab_what_if").click()
        wait(driver, lambda d: "197.7" in text(d, "what_if_figures"))
        driver.find_element(By.ID, "keep").click()
        began = time.monotonic()
        driver.execute_script("""const slider = document.querySelector('#sliders [name=slip]');
            slider.value = 0.12;
            slider.dispatchEvent(new Event('input'));""")
        wait(driver, lambda d: "dry_asphalt slip 0.12" in text(d, "what_if_figures"))
        check("a slider draws another stop", True, f"{1000 * (time.monotonic() - began):.0f} ms")
        check("beside the one that was kept", "dry_asphalt slip 0.24" in text(driver, "what_if_charts"))
        sized(driver, 1280, 900)
        driver.execute_script("scrollTo(0, 0)")
        time.sleep(0.5)
        picture(driver, "panel")
        fits(driver, "what_if")
        Select(driver.find_element(By.CSS_SELECTOR, "#sliders [name=surface]")).select_by_visible_text("runway wet_middle")
        wait(driver, lambda d: "runway wet_middle slip 0.12" in text(d, "what_if_figures"))
        check("a runway is tried", True)


def without_ledger(driver, lab, folder):
    """Two clicks: what `rig-lab maneuver` or an import has left."""
    with program(lab, "panel", folder, "--panel", "127.0.0.1:0") as (url, _):
        driver.get(url)
        for box in wait(driver, lambda d: d.find_elements(By.CSS_SELECTOR, "#runs input")):
            box.click()
        wait(driver, lambda d: "0002 2 slip" in text(d, "recorded_charts"))
        check("maneuvers of folders lie over each other, too", "0001 1 slip" in text(driver, "recorded_charts"))
        check("without a ledger no note is asked for", not driver.find_element(By.ID, "note").is_displayed())


def main():
    lab, nothing = map(pathlib.Path, sys.argv[1:])
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        with browser(folder) as driver:
            sized(driver, 1280)
            live(driver, nothing)
        with browser(folder) as driver:
            sized(driver, 1280)
            recorded(driver, lab, folder)
            without_ledger(driver, lab, folder / "brake" / "heavy")
            quiet(driver, "recorded and what if")
    sys.exit(0 if good else 1)


main()
