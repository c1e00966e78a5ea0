"""The page of a run before any scrolling, and the explanations of its words."""
import colorsys
import re
import subprocess

import h5py
import session
from session import PageTest, pooled

MAY_BE_USED = {"calibrated": "use it", "overconfident": "do not rely on it", "underconfident": "usable, but wider than necessary", "undecided": "cannot tell yet"}
DESKTOP, PHONE = (1440, 900), (390, 844)
# Headings that need no definition.
PLAIN = {"", "Runs", "Run", "Filter", "Samples", "Shape", "Iterations", "Converged", "Status", "Setting", "Value", "Default", "File", "Bytes", "SHA-256",
         "from \\ to", "to", "others"}


class FirstScreen(PageTest):
    def tearDown(self):
        session.browser.size(1200, 900)

    def open_run(self, name, size=DESKTOP):
        session.browser.size(*size)
        self.open(session.modebank.page(name, session.made[name]))
        session.browser.run("window.scrollTo(0, 0)")

    def bottoms(self, *selectors):
        found = session.browser.run("""
            return arguments[0].map((selector) => document.querySelector(selector)?.getBoundingClientRect())
                .map((box) => box && box.width > 0 && box.height > 0 && box.left >= 0 && box.right <= innerWidth ? box.bottom : null);""", list(selectors))
        self.assertNotIn(None, found, selectors)
        return found

    def test_the_answer_is_on_the_first_screen(self):
        for name in ("demo", "one_mode", "none_held_out", "many_modes", "ice"):
            if name not in session.made:
                continue
            with self.subTest(name):
                self.open_run(name)
                self.assertLessEqual(max(self.bottoms("#said", "#coverage", "#next", "#scores", "#screen-modes")), DESKTOP[1])
                session.browser.screenshot(f"first_{name}", whole=False)
                self.open_run(name, PHONE)
                self.assertLessEqual(max(self.bottoms("#said", "#coverage", "#next")), PHONE[1])
                session.browser.screenshot(f"first_{name}_phone", whole=False)
                self.assertLessEqual(session.browser.run("return document.documentElement.scrollWidth"), PHONE[0])
                self.commands_are_not_torn(name)
                self.assert_quiet()

    def commands_are_not_torn(self, name):
        """No line breaks after the hyphens of an option."""
        tops = session.browser.run("""
            return [...document.querySelectorAll('#next code')].flatMap((code) => [...code.textContent.matchAll(/--[\\w.]+/g)].map(({0: word}) => {
              const walk = document.createTreeWalker(code, NodeFilter.SHOW_TEXT), range = document.createRange();
              while (walk.nextNode() && !walk.currentNode.data.includes(word));
              range.setStart(walk.currentNode, walk.currentNode.data.indexOf(word));
              range.setEnd(walk.currentNode, walk.currentNode.data.indexOf(word) + word.length);
              return [word, new Set([...range.getClientRects()].map((box) => box.top)).size];
            }));""")
        if name == "demo":  # the others may end without an option
            self.assertTrue(tops)
        for word, lines in tops:
            self.assertEqual(lines, 1, word)

    def test_its_numbers_are_the_archives(self):
        self.open_run("demo")
        rows = pooled(session.made["demo"])
        shown = {name: (value, text) for name, value, text in session.browser.run("""
            return [...document.querySelectorAll('#verdict .numbers > li')].map((card) =>
                [card.querySelector('.name').textContent, JSON.parse(card.querySelector('.big span').dataset.value ?? 'null'), card.textContent]);""")}
        bank = rows["bank", "test"]
        best = max((row for (_, role), row in rows.items() if role == "test" and row["filter"] not in (b"bank", b"combined")), key=lambda row: row["log_score"])
        competitor = best["filter"].decode()
        self.assertEqual(shown["In the 95 % band"][0], bank["coverage_95"])
        with h5py.File(session.made["demo"]) as file:
            (verdict,) = {row["verdict"].decode() for row in file["evaluation/diagnostics"][:]
                          if (row["filter"], row["role"], row["mode"]) == (b"bank", b"test", -1)}
        self.assertIn(f"{MAY_BE_USED[verdict]}: {verdict}", shown["In the 95 % band"][1])
        self.assertAlmostEqual(shown[f"Gain over {competitor}"][0], bank["log_score"] - best["log_score"], places=9)
        self.assertIn("±", shown[f"Gain over {competitor}"][1])
        self.assertEqual(shown["RMSE one step ahead"][0], float(bank["rmse"].ravel()[0]))
        self.assertIn(f"{competitor} {best['rmse'].ravel()[0]:.3g}", shown["RMSE one step ahead"][1])
        screen = session.modebank("show", session.made["demo"]).stdout
        told = session.browser.run("return document.querySelector('#next').textContent").removeprefix("Next: ")
        # A page may be opened in another folder than those of the archive and the program.
        here = screen.replace(str(session.made["demo"]), "ARCHIVE").replace(str(session.modebank.program), "modebank")
        self.assertIn("".join(told.split()), "".join(here.replace("`", "").split()))

    def test_tables_of_modes_agree_with_the_first_screen(self):
        self.open_run("demo")
        first = session.browser.run("""
            const table = document.querySelector('#screen-modes table'), names = [...table.querySelectorAll('th')].map((th) => th.textContent);
            return [...table.querySelectorAll('tbody tr')].map((tr) => Object.fromEntries([...tr.children].map((td, i) => [names[i], td.textContent])));""")
        rows = self.table("Families of modes, most used first")[:len(first)]
        told = [(row["Used"][0], row["Stay"][0], row["Time constant"][0].partition(", period")[0]) for row in rows]
        self.assertEqual(told, [tuple(row[name].replace("\u00a0", " ") for name in ("used", "stay", "time constant")) for row in first])
        modes = [re.findall(r"\d+", row["Family"][0].rpartition("mode")[2]) for row in rows]
        for numbers, row in zip(modes, first):
            shown = re.findall(r"\d+", row["family (modes)"])
            self.assertEqual(numbers[:len(shown)], shown)

    def test_modes_of_one_family_share_a_hue(self):
        self.open_run("many_modes")
        session.browser.draw_all("#bank")
        shades = {}
        for name, colour in session.browser.run(session.BYTES + """
                const table = [...document.querySelectorAll('#bank table')].find((it) => it.caption.textContent.startsWith('Modes, most used'));
                return [...table.querySelectorAll('tbody tr td:first-child')].filter((td) => td.querySelector('.swatch'))
                    .map((td) => [td.textContent.trim(), bytes(getComputedStyle(td.querySelector('.swatch')).backgroundColor)]);"""):
            label = name.partition(" ")[2]
            if label:
                shades.setdefault(label, []).append(colorsys.rgb_to_hls(*(byte / 255 for byte in colour))[0])
        self.assertGreater(max(map(len, shades.values())), 1)
        for hues in shades.values():
            self.assertLess(max(hues) - min(hues), 0.02)
        firsts = sorted(hues[0] for hues in shades.values())
        self.assertGreater(min(b - a for a, b in zip(firsts, firsts[1:])), 0.05)

    def test_the_first_paint_has_it(self):
        script = session.browser.cdp("Page.addScriptToEvaluateOnNewDocument", source="""
            new PerformanceObserver(() => {
              if (window.atFirstPaint) return;
              window.atFirstPaint = {said: document.querySelector('#said')?.textContent ?? ''};
            }).observe({type: 'paint', buffered: true});""")
        try:
            self.open_run("demo")
            first = session.browser.wait("return window.atFirstPaint", what="the first paint")
        finally:
            session.browser.cdp("Page.removeScriptToEvaluateOnNewDocument", identifier=script["identifier"])
        self.assertIn("modes of motion", first["said"])

    def test_many_modes_are_folded(self):
        self.open_run("many_modes")
        with h5py.File(session.made["many_modes"]) as file:
            modes = len(file["bank/weight"])
            rows = [row for row in file["evaluation/diagnostics"][:] if row["filter"] == b"bank" and row["role"] == b"test" and row["mode"] >= 0]
        usage = {int(row["mode"]): row["usage"] for row in rows}
        session.browser.draw_all("#bank")
        families = [list(map(int, re.findall(r"\d+", row["Family"][0].rpartition("mode")[2]))) for row in self.table("Families of modes, most used first")]
        self.assertEqual(sorted(sum(families, [])), list(range(modes)))
        use = [sum(usage[k] for k in family) for family in families]
        self.assertEqual(use, sorted(use, reverse=True))
        told = min(8, sum(share >= 0.01 for share in use))
        self.assertLess(told, modes)
        self.assertEqual(session.browser.run("return document.querySelectorAll('#screen-modes tbody tr').length"), told)
        names = [list(row.values())[0][0] for row in self.table("Modes, most used first")]
        self.assertEqual([int(name.split()[0]) for name in names if name != "baseline"], sum(families[:told], []))
        colours = session.browser.run("return [...document.querySelectorAll('#screen-modes .swatch')].map((s) => s.style.background)")
        self.assertEqual(len(set(colours)), told)
        self.assertLessEqual(len(self.table("Parameters")), modes + 1)

    def test_words_are_explained_on_hover_and_on_focus(self):
        self.open_run("demo")
        heading = "document.querySelector('#screen-modes th .term')"
        session.browser.run(f"{heading}.focus()")
        tip = session.browser.run("const tip = document.getElementById('term-tip'); return tip.hidden ? null : tip.textContent")
        word = session.browser.run(f"return {heading}.textContent")
        said = subprocess.run([session.modebank.program, "help", word], capture_output=True, text=True, check=True).stdout
        self.assertIn("".join(tip.split()), "".join(said.split()))
        session.browser.key("Escape")
        self.assertTrue(session.browser.run("return document.getElementById('term-tip').hidden"))
        box = session.browser.box("#coverage .term")
        session.browser.move(box["x"] + 3, box["y"] + 3)
        session.browser.wait("return !document.getElementById('term-tip').hidden", what="the definition to show")
        bare = session.browser.run("return [...document.querySelectorAll('th')].filter((th) => !th.querySelector('.term')).map((th) => th.textContent)")
        unexplained = {text for text in bare if text not in PLAIN and " <- " not in text and " per " not in text and not re.search(r"\bmodes? \d", text)
                       and not text.split()[0].isdigit()}
        self.assertEqual(unexplained, set())

    def test_nothing_is_named_by_a_column_of_a_table(self):
        self.open_run("demo")
        session.browser.draw_all()
        names = session.browser.run("""
            return [...document.querySelectorAll('.chart .axis-title')].map((title) => title.textContent)
                .concat([...document.querySelectorAll('option')].map((option) => option.textContent));""")
        self.assertTrue(names)
        for name in names:
            self.assertNotRegex(name, r"log_|_variance|nis_|too_")

    def test_where_it_comes_from_is_at_the_end_one_click_away(self):
        self.open_run("demo")
        self.assertEqual(session.browser.run("return document.querySelector('main > section:last-child').id"), "origin")
        self.assertEqual(session.browser.run("return [...document.querySelectorAll('code')].filter((c) => /^[0-9a-f]{64}$/.test(c.textContent) && c.checkVisibility()).length"), 0)
        session.browser.run("document.querySelector('#origin details summary').click()")
        self.assertEqual(session.browser.run("return [...document.querySelectorAll('#origin code')].filter((c) => /^[0-9a-f]{64}$/.test(c.textContent) && c.checkVisibility()).length"), 2)
