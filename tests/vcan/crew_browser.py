#!/usr/bin/python3
"""A person in front of the panel's page: starts a campaign that waits, sees the landing move, and aborts it. The browser runs here; three programs
run in paced lockstep inside `./rig vcan`, which makes their page's port reachable. [BRG-520] [BRG-522]

usage: crew_browser.py BUILD_DIR               all of it
       crew_browser.py BUILD_DIR PORT          the part inside

PANEL_KEEP=FOLDER keeps pictures of the page.
"""
import pathlib
import re
import socket
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[1] / "panel"))

from selenium.webdriver.common.by import By  # noqa: E402

from browser import browser, picture, sized, text, wait  # noqa: E402
from three_programs import Bus, changed, check, in_guest_memory, ledger_copy, patient_rig, quick_rig, words  # noqa: E402

BUILD = pathlib.Path(sys.argv[1]).resolve()


def programs(folder, port):
    scenario, config = quick_rig(folder)
    text = changed(scenario.read_text(), speed_mps=40.0).replace("[11.95, 12.05]", "[39.9, 40.1]")
    scenario.write_text(text.replace('"dry_asphalt"', '"snow"'))  # a long braking, and many of them: no press comes too late
    rig, bus, out = patient_rig(BUILD, folder, scenario, config), Bus(), folder / "campaign"
    run = rig.bridge("campaign", out, "--maneuvers", "20", "--held", "--panel", f"127.0.0.1:{port}")
    print(re.search(r"http://127.0.0.1:\d+/#token=\w+", rig.await_words(run, "#token=")).group(), flush=True)
    check(run.wait(timeout=300) == 130, words(run))
    check(bus.valve_raw == 0, "the valve is not at its safe current")
    rows = ledger_copy(out)
    check(rows and rows[-1]["state"] == "aborted" and rows[-1]["outcome"] == "requested", rows)
    check(all(row["state"] == "finished" for row in rows[:-1]), rows)
    rig.end()


def press(driver, name):
    wait(driver, lambda d: d.find_element(By.ID, name).is_displayed(), 60)
    driver.find_element(By.ID, name).click()


def person(driver, address):
    sized(driver, 1280)
    driver.set_script_timeout(60)
    driver.get(address)
    press(driver, "resume")
    times = driver.execute_async_script("""const done = arguments[0], source = new EventSource('/events'), times = [];
        source.addEventListener('pixel', event => {
            times.push(JSON.parse(event.data).t);
            if (times.length === 50) { source.close(); done(times); }
        });""")
    check(all(a < b for a, b in zip(times, times[1:])), f"a pixel is not newer than the one before: {times}")
    wait(driver, lambda d: "braking" in text(d, "facts"), 120)
    wait(driver, lambda d: float(text(d, "live_rim").split()[0]) < 35.0, 60)  # of 40 m/s
    picture(driver, "panel_live")
    press(driver, "abort")
    wait(driver, lambda d: "you requested it" in text(d, "alarms"), 60)
    wait(driver, lambda d: "no connection" in text(d, "link"), 60)


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def main():
    port = free_port()
    inside = subprocess.Popen([HERE.parents[2] / "rig", "vcan", "--timeout", "400", "--port", str(port), "--",
                               "/usr/bin/python3", HERE, BUILD, str(port)], stdout=subprocess.PIPE, text=True)
    try:
        address = inside.stdout.readline().strip()
        check(address.startswith("http://"), f"no address: {address}")
        with tempfile.TemporaryDirectory() as folder, browser(folder) as driver:
            person(driver, address)
        said = inside.stdout.read()
        check(inside.wait(timeout=60) == 0, said)
    finally:
        inside.terminate()
        inside.wait()
    print("browser: passed")


if __name__ == "__main__":
    if len(sys.argv) > 2:
        with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
            programs(pathlib.Path(name), int(sys.argv[2]))
    else:
        main()
