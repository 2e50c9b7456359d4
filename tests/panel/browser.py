"""Headless Chromium for the tests of pages: it sees this machine alone."""
import contextlib
import os
import pathlib

from selenium import webdriver
from selenium.common.exceptions import TimeoutException
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

FLAGS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--disable-dev-shm-usage", "--no-first-run", "--disable-sync",
         "--disable-background-networking", "--disable-component-update", "--autoplay-policy=no-user-gesture-required",
         "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1")


@contextlib.contextmanager
def browser(folder, *flags):
    """A driver that downloads to `folder`."""
    options = webdriver.ChromeOptions()
    for flag in (*FLAGS, *flags):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    options.add_experimental_option("prefs", {"download.default_directory": str(folder)})
    driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    try:
        yield driver
    finally:
        driver.quit()


def text(driver, name):
    return driver.find_element(By.ID, name).text


def wait(driver, what, seconds=20):
    try:
        return WebDriverWait(driver, seconds, poll_frequency=0.05).until(what)
    except TimeoutException:
        print("the page says:", text(driver, "said"), {e["message"] for e in driver.get_log("browser")})
        picture(driver, "failed")
        raise


def sized(driver, width, height=1000):
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})


def picture(driver, name):
    """In the folder PANEL_KEEP, if that is set."""
    kept = os.environ.get("PANEL_KEEP")
    if kept:
        pathlib.Path(kept).mkdir(parents=True, exist_ok=True)
        driver.save_screenshot(f"{kept}/{name}.png")
