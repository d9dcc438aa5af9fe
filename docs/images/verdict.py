"""Photograph the verdict of a report, as the README shows it.

``python docs/images/verdict.py FOLDER`` takes the report of a run, as that of the flange of
docs/validation/judged_by_hand.py, in Chromium (``pip install playwright``) to verdict.png.
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

WIDTH, HEIGHT = 1100, 985
"""Pixels, down to where the joint is seen."""

SOFTWARE = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
"""WebGL without a graphics card."""


def main() -> None:
    """Write the picture."""
    report = Path(sys.argv[1]).resolve() / "report.html"
    with sync_playwright() as driver:
        program = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = driver.chromium.launch(executable_path=program, args=SOFTWARE)
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT}, color_scheme="light")
        page.goto(report.as_uri())
        page.wait_for_timeout(5000)  # until the joint is drawn
        page.screenshot(path=Path(__file__).with_name("verdict.png"))
        browser.close()


if __name__ == "__main__":
    main()
