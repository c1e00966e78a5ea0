"""Accessibility faults of pages, found by axe-core (.ci/packages)."""
import os

import session

PHONE = (390, 844)
# Each offending element once, with its fault.
CHECK = """
    const [options, done] = arguments;
    axe.run({resultTypes: ['violations'], ...options}).then(({violations}) =>
        done(violations.flatMap(({id, nodes}) => nodes.map(({target, failureSummary}) => `${id}: ${target}: ${failureSummary}`))), (error) => done([String(error)]));"""


def script():
    return session.modebank.source / "build/npm/node_modules/axe-core/axe.min.js"


def offences(colours_only=False):
    """Faults of the open page, folded parts included."""
    browser = session.browser
    if not script().exists():
        print("SKIPPED: axe-core is absent: npm installs it into build/npm")
        assert os.environ.get("CI") != "true", "axe-core is required with CI=true"
        return []
    browser.run("document.querySelectorAll('details').forEach((part) => { part.open = true; })")
    if not browser.run("return 'axe' in window"):
        browser.cdp("Runtime.evaluate", expression=script().read_text(encoding="utf-8"))
    return browser.driver.execute_async_script(CHECK, {"runOnly": ["cat.color"]} if colours_only else {})


def assert_accessible(test):
    """Checks a page in light, in dark (colours only) and on a phone, whose width it must fit."""
    browser = session.browser
    test.assertEqual(offences(), [])
    browser.scheme("dark")
    browser.wait("return document.documentElement.dataset.drawn === 'dark'")
    test.assertEqual(offences(colours_only=True), [])
    browser.scheme("light")
    browser.size(*PHONE)
    try:
        browser.wait("return innerWidth === arguments[0] && document.documentElement.scrollWidth <= innerWidth", PHONE[0], what="the page to fit a phone")
        test.assertEqual(offences(), [])
    finally:
        browser.size(1200, 900)
