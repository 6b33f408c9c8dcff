"""Debian's Chromium without a window, which draws in software."""

from __future__ import annotations

import shutil
from typing import Any

_ARGUMENTS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--window-size=1280,1000",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)


def is_there() -> bool:
    return bool(shutil.which("chromium") and shutil.which("chromedriver"))


def start() -> Any:
    """A browser that Selenium drives; its log has what the console says."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in _ARGUMENTS:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
