#!/usr/bin/env python3
"""modebank view under attack: view_test.py PROGRAM SOURCE_FOLDER WORK_FOLDER [TEST...]"""
import base64
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import h5py
from server import Server, wait_for

program = source = work = archive = None
HOSTILE_NAME = "<img src=x onerror=alert(1)>\"'&;é.h5"


def set_up(program_, source_, folder):
    global program, source, work, archive
    program, source, work = program_, pathlib.Path(source_), pathlib.Path(folder)
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    data, archive = work / "data", work / "made.h5"
    run = lambda *arguments: subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, cwd=work)
    run("simulate", source / "configs/simulate_ice.ini", "--simulate.output", data)
    run("run", source / "configs/demo.ini", "--data.root", data, "--mixture.components", "2", "--mixture.restarts", "1", "--bank.refine", "none",
        "--archive.output", archive)


class ViewTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=work))
        self.temporary = pathlib.Path(tempfile.mkdtemp(dir=work))
        self.servers = []

    def tearDown(self):
        for server in self.servers:
            if server.process.poll() is None:
                self.assertEqual(server.stop(), 0)
        self.assertEqual(list(self.temporary.iterdir()), [])
        shutil.rmtree(self.folder)  # some hold files that look very large

    def serve(self, what=None, *options, log_in=True):
        server = Server(program, what or self.folder, *options, environment={**os.environ, "TMPDIR": str(self.temporary)})
        self.servers.append(server)
        if log_in:
            server.log_in()
        return server

    def add(self, name="demo.h5"):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(archive, path)
        return path

    def rows(self, server):
        """All that are read, by name."""
        def whole():
            answer = json.loads(server.get("/overview.json")[1])
            return answer["rows"] if all("digest" in row or "problem" in row for row in answer["rows"]) else None
        end = time.monotonic() + 500
        while (rows := whole()) is None:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)
        return {(row["folder"] + "/" if row["folder"] else "") + row["name"]: row for row in rows}


class Strangers(ViewTest):
    def test_the_token_opens_once_and_becomes_a_cookie(self):
        server = self.serve(log_in=False)
        self.assertEqual(server.status("/"), 403)
        self.assertEqual(server.status("/?token=" + "0" * 32), 403)
        self.assertEqual(server.status("/?token="), 403)
        self.assertEqual(server.status(f"/?token={server.token[:-1]}"), 403)
        self.assertEqual(server.status(f"/?token={server.token}", method="HEAD"), 303)
        head = server.log_in()
        self.assertIn("\r\nLocation: /\r\n", head)
        self.assertNotIn(server.token, server.cookie)
        self.assertEqual(server.status("/"), 200)
        self.assertEqual(server.status(f"/?token={server.token}", cookie=None), 403)
        self.assertEqual(server.status(f"/?token={server.token}"), 303)  # who is in already
        again = server.process.stdout.readline().strip().rpartition("=")[2]
        self.assertNotEqual(again, server.token)
        self.assertEqual(server.status(f"/?token={again}", cookie=None), 303)
        for wrong in (server.cookie[:-1], server.cookie + "0", server.cookie.partition("=")[2], "modebank_=; =;;", "=" * 300, f"x{server.cookie}"):
            self.assertEqual(server.status("/", cookie=wrong), 403, wrong)
        self.assertEqual(server.status("/", cookie=f"a=b; {server.cookie}; c"), 200)

    def test_every_address_needs_the_cookie(self):
        self.add()
        server = self.serve()
        (row,) = self.rows(server).values()
        for target in ("/", "/overview.json", "/page.css", "/overview.js", f"/archive/{row['id']}", "/nothing"):
            self.assertEqual(server.status(target, cookie=None), 403, target)

    def test_tokens_differ(self):
        first, second = self.serve(log_in=False), self.serve(log_in=False)
        self.assertNotEqual(first.token, second.token)
        self.assertNotEqual(first.port, second.port)
        first.log_in()
        second.log_in()
        self.assertEqual(second.status("/", cookie=first.cookie), 403)

    def test_other_names_and_sites(self):
        server = self.serve()
        for host in ("localhost", f"localhost:{server.port}", "evil.example", f"evil.example:{server.port}", "127.0.0.1", f"127.0.0.1:{server.port + 1}",
                     f"127.0.0.1:{server.port}.evil.example", f"[::1]:{server.port}", f"127.0.0.1:0{server.port}"):
            self.assertEqual(server.status("/", host=host), 421, host)
        self.assertEqual(server.status("/", f"Host: {server.host}"), 421)  # twice
        self.assertEqual(int(server.send(f"GET / HTTP/1.0\r\nCookie: {server.cookie}\r\n\r\n".encode())[0].split()[1]), 421)
        for origin in ("http://evil.example", "null", f"https://{server.host}", "http://127.0.0.1", f"http://{server.host}.evil.example", f"http://localhost:{server.port}"):
            self.assertEqual(server.status("/", f"Origin: {origin}"), 403, origin)
        self.assertEqual(server.status("/", f"Origin: http://{server.host}"), 200)
        for site in ("cross-site", "same-site"):
            self.assertEqual(server.status("/", f"Sec-Fetch-Site: {site}"), 403, site)
        self.assertEqual(server.status("/", "Sec-Fetch-Site: none"), 200)
        self.assertEqual(server.status("http://evil.example/"), 400)
        self.assertEqual(server.status("*"), 400)

    def test_only_this_machine(self):
        server = self.serve(log_in=False)
        listening = subprocess.run(["cat", f"/proc/{server.process.pid}/net/tcp"], capture_output=True, text=True).stdout
        (line,) = [line for line in listening.splitlines() if f":{server.port:04X} 00000000:0000 0A" in line]
        self.assertIn(f"0100007F:{server.port:04X}", line)


class Requests(ViewTest):
    def test_methods_and_headers(self):
        self.add()
        server = self.serve()
        (row,) = self.rows(server).values()
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PATCH", "PROPFIND", "NONSENSE"):
            answer = server.get("/", method=method)
            self.assertIn(answer[0].split()[1], ("405", "400"), method)
        for target in ("/", "/overview.json", "/page.css", "/overview.js", f"/archive/{row['id']}", "/nothing"):
            head, body = server.get(target)
            for header in ("X-Content-Type-Options: nosniff", "Referrer-Policy: no-referrer", "Cache-Control: no-store",
                           "Cross-Origin-Resource-Policy: same-origin", "frame-ancestors 'none'", "default-src 'none'"):
                self.assertIn(header, head, target)
            self.assertTrue(body)
            only_head, nothing = server.get(target, method="HEAD")
            self.assertEqual(only_head.split()[1], head.split()[1])
            self.assertEqual(nothing, b"")
        self.assertIn("frame-ancestors 'none'", server.get("/", cookie=None)[0])
        self.assertNotIn("unsafe-inline'; style-src '", server.get("/")[0])

    def test_a_page_runs_its_own_scripts_alone(self):
        """Named by their hashes, in the header and in the page, which is opened from a file, too."""
        self.add()
        server = self.serve()
        (row,) = self.rows(server).values()
        head, body = server.get(f"/archive/{row['id']}")
        page = body.decode()
        in_page = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', page)[1]
        for policy in (re.search(r"Content-Security-Policy: (.*)", head)[1], in_page):
            allowed = dict(rule.strip().split(" ", 1) for rule in policy.split(";") if rule.strip())
            self.assertNotIn("unsafe-inline", allowed["script-src"])
            self.assertNotIn("unsafe-inline", allowed["style-src"])
            for kind, texts in (("script-src", re.findall(r"<script>(.*?)</script>", page, re.S)), ("style-src", re.findall(r"<style>(.*?)</style>", page, re.S))):
                self.assertEqual(len(texts), 1)
                self.assertIn(f"'sha256-{base64.b64encode(hashlib.sha256(texts[0].encode()).digest()).decode()}'", allowed[kind])

    def test_bodies_long_headers_and_nonsense(self):
        server = self.serve()
        self.assertEqual(server.status("/", "Content-Length: 5"), 413)
        self.assertIn(server.status("/", "Transfer-Encoding: chunked"), (400, 413, 200, None))
        self.assertEqual(server.status("/", "X: " + "a" * 9000), 431)
        self.assertEqual(server.status("/" + "a" * 300), 414)
        self.assertEqual(server.status("/" + "a" * 100000), 431)
        for request in (b"\0\0\0\0\r\n\r\n", b"GET / HTTP/1.1\r\nbad header\r\n\r\n", b"GET\r\n\r\n", os.urandom(2000) + b"\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n"):
            answer = server.send(request)
            self.assertIn(answer[0].split()[1] if answer else "400", ("400", "403", "405", "421"))
        self.assertEqual(server.status("/"), 200)

    def test_addresses_lead_nowhere_else(self):
        self.add("a/demo.h5")
        server = self.serve()
        (row,) = self.rows(server).values()
        for target in ("/archive/../../etc/passwd", "/archive/%2e%2e%2fetc%2fpasswd", "/archive//etc/passwd", "/archive/a/demo.h5", "/archive/demo.h5",
                       f"/archive/{row['id']}/", f"/archive/{row['id']}/..", f"/archive/{row['id'].upper()}x", "/archive/", "/archive", "/compare/a/b",
                       f"/compare/{row['id']}", "/compare", "/..", "//", "/etc/passwd", "/page.css/", "/?x=1", "/archive/\0", "/archive/\udcff"):
            self.assertIn(server.status(target), (404, 400, None), target)

    def test_slow_and_many_clients(self):
        server = self.serve()
        idle = []
        try:
            for _ in range(1000):
                idle.append(server.connect())
                idle[-1].sendall(b"GET / HTTP/1.1\r\nHost: ")
            self.assertEqual(server.status("/"), 200)  # who asks gets an answer
            sockets = len([1 for fd in os.listdir(f"/proc/{server.process.pid}/fd")
                           if os.readlink(f"/proc/{server.process.pid}/fd/{fd}").startswith("socket:")])
            self.assertLessEqual(sockets, 20)
            # A letter now and then does not keep a connection: the whole header has five seconds.
            dripping = idle[-1]
            ended = False
            for _ in range(600):
                try:
                    dripping.sendall(b"a")
                    dripping.settimeout(0.1)
                    ended = dripping.recv(1) == b""
                except socket.timeout:
                    continue
                except OSError:
                    ended = True
                if ended:
                    break
            self.assertTrue(ended)
            self.assertEqual(server.status("/"), 200)
        finally:
            for each in idle:
                each.close()
        for _ in range(1000):
            self.assertEqual(server.status("/page.css"), 200)


class Archives(ViewTest):
    def test_one_archive(self):
        server = self.serve(self.add())
        self.add("beside.h5")
        self.assertIn(b"page-data", server.get("/")[1])
        self.assertEqual(list(self.rows(server)), ["demo.h5"])

    def test_pages_and_comparison(self):
        self.add("a/demo.h5")
        self.add("b/demo.h5")
        server = self.serve()
        rows = self.rows(server)
        self.assertEqual(sorted(rows), ["a/demo.h5", "b/demo.h5"])
        with h5py.File(archive) as file:
            found = file["evaluation/evidence"].attrs
            (pooled,) = [row for row in file["evaluation/summary"][:] if (row["filter"], row["role"], row["run"]) == (b"bank", b"test", b"*")]
            digest = rows["a/demo.h5"]["digest"]
            self.assertEqual(digest["answer"], found["answer"].decode() if isinstance(found["answer"], bytes) else found["answer"])
            self.assertEqual((digest["gain"], digest["standard_error"], digest["modes"]), (found["gain"], found["standard_error"], found["modes"]))
            self.assertEqual((digest["log_score"], digest["coverage_95"], digest["samples"]), (pooled["log_score"], pooled["coverage_95"], pooled["samples"]))
            self.assertEqual(digest["created"], file.attrs["created"].decode() if isinstance(file.attrs["created"], bytes) else file.attrs["created"])
        ids = [row["id"] for row in rows.values()]
        for target in (f"/archive/{ids[0]}", f"/compare/{ids[0]}/{ids[1]}"):
            head, body = server.get(target)
            self.assertTrue(head.startswith("HTTP/1.1 200"))
            self.assertIn(f"Content-Length: {len(body)}\r\n", head)
            self.assertIn(b"page-data", body)
        self.assertNotIn(str(self.folder).encode(), server.get(f"/compare/{ids[0]}/{ids[1]}")[1])

    def test_the_page_is_the_reports(self):
        path = self.add()
        page = self.folder / "page.html"
        subprocess.run([program, "report", path.name, "-o", page], check=True, capture_output=True, cwd=self.folder)
        server = self.serve(path)
        self.assertEqual(server.get("/")[1], page.read_bytes())

    def test_new_changed_and_deleted_ones(self):
        server = self.serve()
        self.assertEqual(self.rows(server), {})
        first = json.loads(server.get("/overview.json")[1])
        self.assertNotIn("rows", json.loads(server.get(f"/overview.json?{first['version']}")[1]))
        path = self.add()
        row = self.rows(server)["demo.h5"]
        self.assertIn("rows", json.loads(server.get(f"/overview.json?{first['version']}")[1]))
        path.unlink()
        head, body = server.get(f"/archive/{row['id']}")
        self.assertEqual(head.split()[1], "404")
        self.assertEqual(self.rows(server), {})
        path.write_text("no archive")
        self.assertIn("problem", self.rows(server)["demo.h5"])
        self.add()
        self.assertIn("digest", self.rows(server)["demo.h5"])

    def test_links_and_pipes(self):
        outside = work / "outside"
        shutil.rmtree(outside, ignore_errors=True)
        outside.mkdir()
        shutil.copy(archive, outside / "secret.h5")
        path = self.add("sub/demo.h5")
        (self.folder / "link.h5").symlink_to(outside / "secret.h5")
        (self.folder / "linked").symlink_to(outside)
        (self.folder / "around").symlink_to(".")
        (self.folder / "passwd.h5").symlink_to("/etc/passwd")
        os.mkfifo(self.folder / "pipe.h5")
        (self.folder / "folder.h5").mkdir()
        server = self.serve()
        rows = self.rows(server)
        self.assertEqual(list(rows), ["sub/demo.h5"])
        # What was a file or a folder when it was listed is exchanged for a link.
        target = f"/archive/{rows['sub/demo.h5']['id']}"
        path.unlink()
        path.symlink_to(outside / "secret.h5")
        self.assertEqual(server.status(target), 404)
        path.unlink()
        path.parent.rmdir()
        shutil.copy(archive, outside / "demo.h5")
        path.parent.symlink_to(outside)
        self.assertEqual(server.status(target), 404)

    def test_hostile_names(self):
        names = [HOSTILE_NAME, "--help.h5", "-o.h5", "a b$(touch x)`y`.h5", "new\nline.h5", "%2e%2e.h5", os.fsdecode(b"\xff\xfe.h5")]
        for name in names:
            self.add(name)
        broken = "</title><script>alert(2)</script>.h5".replace("/", "∕")
        (self.folder / broken).write_text("no archive")
        server = self.serve()
        rows = self.rows(server)
        self.assertEqual(len(rows), len(names) + 1)
        for row in rows.values():
            head, body = server.get(f"/archive/{row['id']}")
            if "digest" in row:
                self.assertEqual(head.split()[1], "200", row)
                self.assertNotIn(b"<img src=x", body)
            else:
                self.assertEqual(head.split()[1], "500", row)
                self.assertNotIn(b"<script>", body)
                self.assertIn(b"&lt;script&gt;", body)
        self.assertFalse((self.folder / "x").exists())

    def test_hostile_archives(self):
        good = archive.read_bytes()
        middle = len(good) // 2
        (self.folder / "cut.h5").write_bytes(good[:middle])
        (self.folder / "changed.h5").write_bytes(good[:middle] + bytes(200) + good[middle + 200:])
        (self.folder / "empty.h5").write_bytes(b"")
        with h5py.File(self.folder / "foreign.h5", "w") as file:
            file["x"] = [1]
        self.add()
        # 8 TB of address in a file of a few bytes, and digests that lie about their types
        path = self.add("huge.h5")
        with h5py.File(path, "a") as file:
            del file["evaluation/summary"]
            file.create_dataset("evaluation/summary", shape=(10**12,), dtype="f8", chunks=(10**6,))
            file["evaluation/evidence"].attrs["text"] = "<script>alert(1)</script>" * 2000
        server = self.serve()
        rows = self.rows(server)
        for name, row in rows.items():
            self.assertEqual(server.status(f"/archive/{row['id']}"), 200 if name == "demo.h5" else 500, name)
        self.assertEqual(server.status("/"), 200)

    def test_two_hundred(self):
        for i in range(200):
            os.link(archive, self.folder / f"{i:03}.h5") if i else self.add("000.h5")
        server = self.serve()
        rows = self.rows(server)
        self.assertEqual(len(rows), 200)
        self.assertTrue(all("digest" in row for row in rows.values()))


class Ends(ViewTest):
    def slow(self):
        """A server that is at work on a page: its archive is a file that nobody can read quickly."""
        path = self.add()
        with open(path, "r+b") as file:  # a hole that has to be hashed
            file.truncate(200 << 30)
        server = self.serve(path)
        connection = server.connect()
        connection.sendall(server.request("/"))
        wait_for(server.children)
        return server, connection

    def test_stopped_while_at_work(self):
        for how in (signal.SIGINT, signal.SIGTERM):
            server, connection = self.slow()
            (child,) = server.children()
            self.assertEqual(server.stop(how), 0)
            connection.close()
            self.assertFalse(pathlib.Path(f"/proc/{child}").exists())
            self.assertEqual(list(self.temporary.iterdir()), [])

    def test_killed(self):
        server, connection = self.slow()
        (child,) = server.children()
        self.assertEqual(server.stop(signal.SIGKILL), -signal.SIGKILL)
        connection.close()
        wait_for(lambda: not pathlib.Path(f"/proc/{child}").exists() or "Z" in pathlib.Path(f"/proc/{child}/stat").read_text().split()[2])
        (left,) = self.temporary.iterdir()  # in the folder for temporary files, which the system empties
        shutil.rmtree(left)

    def test_a_reader_who_leaves_gives_up_his_page(self):
        server, connection = self.slow()
        connection.close()
        wait_for(lambda: not server.children())

    def test_what_the_child_may(self):
        server, connection = self.slow()
        (child,) = server.children()
        limits = pathlib.Path(f"/proc/{child}/limits").read_text()
        self.assertRegex(limits, rf"Max address space +{512 << 20} ")
        self.assertRegex(limits, r"Max cpu time +20 ")
        open_files = [os.readlink(f"/proc/{child}/fd/{fd}") for fd in os.listdir(f"/proc/{child}/fd")]
        self.assertFalse([name for name in open_files if name.startswith("socket:")])
        everything = pathlib.Path(f"/proc/{child}/environ").read_bytes() + pathlib.Path(f"/proc/{child}/cmdline").read_bytes()
        self.assertNotIn(server.token.encode(), everything)
        self.assertNotIn(server.cookie.partition("=")[2].encode(), everything)
        connection.close()

    def test_usage(self):
        for arguments, status in ((["view"], 2), (["view", "absent"], 2), (["view", "/dev/null"], 2), (["view", "a", "b"], 2),
                                  (["view", str(self.folder), "--port", "70000"], 2), (["view", str(self.folder), "--window.length", "3"], 2)):
            self.assertEqual(subprocess.run([program, *arguments], capture_output=True).returncode, status, arguments)
        server = self.serve(log_in=False)
        taken = subprocess.run([program, "view", str(self.folder), "--port", str(server.port)], capture_output=True, text=True)
        self.assertEqual(taken.returncode, 2)
        self.assertIn("in use", taken.stderr)


if __name__ == "__main__":
    set_up(*sys.argv[1:4])
    sys.exit(not unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, exit=False).result.wasSuccessful())
