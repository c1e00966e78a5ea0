"""Pages printed by `chromium --print-to-pdf`: every figure as on the screen, and no empty sheet."""
import base64
import hashlib
import subprocess

import numpy
import session
from browser import CHROMIUM
from session import PageTest

DPI = 96
ROWS, COLUMNS = 12, 24  # cells of a figure whose ink is compared
SCREEN = (800, 600)     # size of the window from which Chromium prints
# Marks two corners of every visible figure with a unique colour: 255, number of the figure, 1 or 2.
FIGURES = "[...document.querySelectorAll('div.plot, canvas.picture, svg.graph')].filter((it) => it.checkVisibility())"
MARKS = """addEventListener('beforeprint', () => FIGURES.forEach((it, i) => {
  const end = 'right:0;bottom:0';
  let frame = it;
  if (!it.matches('div')) {
    frame = document.createElement('div');
    frame.style = `position:relative;max-width:${getComputedStyle(it).maxWidth}`;
    it.replaceWith(frame);
    frame.append(it);
  }
  for (const [corner, place] of [[1, 'left:0;top:0'], [2, end]]) {
    const mark = document.createElement('div');
    mark.style = `position:absolute;z-index:99;width:6px;height:6px;${place};background:rgb(255,${i},${corner});print-color-adjust:exact`;
    frame.append(mark);
  }
}));""".replace("FIGURES", FIGURES)
# The pixels of a picture as a list of bytes, by a canvas.
PIXELS = """
    const [data, done] = arguments, image = new Image();
    image.onload = () => {
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [image.width, image.height];
      const context = canvas.getContext('2d');
      context.drawImage(image, 0, 0);
      const bytes = context.getImageData(0, 0, image.width, image.height).data;
      done([image.width, image.height, btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''))]);
    };
    image.src = `data:image/png;base64,${data}`;"""


def ink(pixels):
    """Share of each cell that is not white."""
    dark = (pixels.min(2) < 215).astype(float)
    rows = numpy.array_split(dark, ROWS)
    return numpy.array([[cell.mean() for cell in numpy.array_split(row, COLUMNS, 1)] for row in rows])


def likeness(a, b):
    return numpy.corrcoef(a.ravel(), b.ravel())[0, 1]


def sheets_of(pdf):
    subprocess.run(["pdftoppm", "-r", str(DPI), pdf, pdf.with_suffix("")], check=True)
    sheets = []
    for path in sorted(pdf.parent.glob(f"{pdf.stem}-*.ppm")):
        _, width, height, _ = path.read_bytes().split(None, 4)[:4]
        size = int(width) * int(height) * 3
        sheets.append(numpy.frombuffer(path.read_bytes()[-size:], numpy.uint8).reshape(int(height), int(width), 3))
        path.unlink()
    return sheets


class Printed(PageTest):
    def print_page(self, made):
        """Sheets that headless Chromium prints of the page, and the printed page."""
        page, text = session.work / f"printed_{made.name}", made.read_text(encoding="utf-8")
        allowed = base64.b64encode(hashlib.sha256(MARKS.encode()).digest()).decode()  # allowed by the page's policy
        for old, new in (("script-src ", f"script-src 'sha256-{allowed}' "), ("</body>", f"<script>{MARKS}</script></body>")):
            self.assertIn(old, text)
            text = text.replace(old, new, 1) if old != "</body>" else new.join(text.rsplit(old, 1))
        page.write_text(text, encoding="utf-8")
        pdf = page.with_suffix(".pdf")
        subprocess.run([CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                        "--no-pdf-header-footer", f"--print-to-pdf={pdf}", page.as_uri()], check=True, capture_output=True)
        return sheets_of(pdf), page

    def printed_figure(self, sheets, i):
        """The pixels between the figure's two marks."""
        for sheet in sheets:
            corners = [numpy.argwhere((sheet == (255, i, corner)).all(2)) for corner in (1, 2)]
            if all(len(places) for places in corners):
                (top, left), (bottom, right) = corners[0].min(0), corners[1].max(0)
                return sheet[top:bottom + 1, left:right + 1]
        self.fail(f"figure {i} is on no sheet as a whole")

    def seen_figure(self, box):
        shot = session.browser.cdp("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip={**box, "scale": 1})["data"]
        width, height, data = session.browser.driver.execute_async_script(PIXELS, shot)
        return numpy.frombuffer(base64.b64decode(data), numpy.uint8).reshape(height, width, 4)[:, :, :3]

    def test_every_figure_is_printed_as_it_is_seen(self):
        demo, other = session.made["demo"], session.made["one_mode"]
        pages = (("run", session.modebank.page("demo", demo), 8),
                 ("comparison", session.modebank.page("compare", demo, other), 4),
                 ("study", session.modebank.page("study", session.made["study"], options=("--report.runs", "2")), 2))
        for kind, made, least in pages:
            with self.subTest(kind):
                self.check_printed(made, least)

    def check_printed(self, made, least):
        sheets, page = self.print_page(made)
        session.browser.size(*SCREEN)
        try:
            self.open(page)
            session.browser.draw_all()
            session.browser.run("document.getElementById('contents').remove()")  # not printed
            figures = session.browser.run(f"""return {FIGURES}.map((it) => {{
                const box = it.getBoundingClientRect();
                return [it.getAttribute('aria-label') || it.getAttribute('class'), {{x: box.x + scrollX, y: box.y + scrollY, width: box.width, height: box.height}}];}})""")
            self.assertGreaterEqual(len(figures), least)
            for i, (label, box) in enumerate(figures):
                with self.subTest(label):
                    figure = self.printed_figure(sheets, i)
                    printed, seen = ink(figure), ink(self.seen_figure(box))
                    self.assertGreater(printed.mean(), 0.003)
                    self.assertGreater(likeness(printed, seen), 0.8)
                    self.assertGreater(figure.shape[1], 0.7 * box["width"], "something wider than the sheet has shrunk all of the page")
        finally:
            session.browser.size(1200, 900)
        for number, sheet in enumerate(sheets):
            self.assertGreater((sheet.min(2) < 128).mean(), 0.0002, f"sheet {number + 1} of {len(sheets)} is empty")
