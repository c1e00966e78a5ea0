"""modebank view as its attackers meet it: the program, its address, and requests byte by byte."""
import pathlib
import re
import signal
import socket
import subprocess
import time


def heed_ctrl_c():
    """A shell makes what it runs in the background ignore SIGINT."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class Server:
    def __init__(self, program, what, *options, environment=None):
        self.process = subprocess.Popen([program, "view", str(what), *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                        env=environment, preexec_fn=heed_ctrl_c)
        while True:
            line = self.process.stdout.readline()
            assert line, self.process.stderr.read()
            if found := re.search(r"http://127\.0\.0\.1:(\d+)/\?token=([0-9a-f]{32})$", line.strip()):
                break
        self.port, self.token = int(found[1]), found[2]
        self.host = f"127.0.0.1:{self.port}"
        self.cookie = None

    def log_in(self):
        head, _ = self.get(f"/?token={self.token}", cookie=None)
        assert head.startswith("HTTP/1.1 303"), head
        self.cookie = re.search(r"Set-Cookie: ([^;]+); HttpOnly; SameSite=Strict; Path=/\r\n", head)[1]
        return head

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=600)

    def send(self, request):
        """Raw bytes out; (head, body) back, or None where the server closes without a word."""
        with self.connect() as connection:
            try:
                connection.sendall(request)
            except (BrokenPipeError, ConnectionResetError):
                pass
            return self.receive(connection)

    @staticmethod
    def receive(connection):
        answer = b""
        try:
            while piece := connection.recv(65536):
                answer += piece
        except ConnectionResetError:
            pass
        if not answer:
            return None
        head, _, body = answer.partition(b"\r\n\r\n")
        return head.decode() + "\r\n", body

    def request(self, target, *more, method="GET", host=None, cookie=""):
        cookie = self.cookie if cookie == "" else cookie
        lines = [f"{method} {target} HTTP/1.1", f"Host: {host or self.host}", *([f"Cookie: {cookie}"] if cookie else []), *more]
        return ("\r\n".join(lines) + "\r\n\r\n").encode("utf-8", "surrogateescape")

    def get(self, target, *more, **options):
        return self.send(self.request(target, *more, **options))

    def status(self, target, *more, **options):
        answer = self.get(target, *more, **options)
        return int(answer[0].split()[1]) if answer else None

    def stop(self, how=signal.SIGINT):
        if self.process.poll() is None:
            self.process.send_signal(how)
        status = self.process.wait(timeout=600)
        self.process.stdout.close()
        self.process.stderr.close()
        return status

    def children(self):
        """Process ids, read from /proc: ps is not installed everywhere."""
        found = []
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                after_name = (folder / "stat").read_text().rpartition(")")[2].split()
            except OSError:  # it ended meanwhile
                continue
            if after_name[1] == str(self.process.pid):
                found.append(folder.name)
        return found


def wait_for(condition, seconds=600):
    end = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)
    return value
