#!/usr/bin/env python3
"""track_day.py PROGRAM ARCHIVE [HOURS]: a robot's day through `modebank track`, as fast as possible.

Samples at 200 Hz go to two filters. One runs through. The other is killed (SIGKILL) once in every ten minutes of the log, at any
sample, and continues from its last checkpoint. The output of the second, cut after each checkpoint where the next process
continues, must equal that of the first, byte for byte. The memory of the first must not grow. Some samples miss a value, are
repeated, or are not samples at all. The archive's bank has one state and two inputs, like that of `modebank demo`.
"""

import configparser
import functools
import hashlib
import operator
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time

import h5py
import numpy as np

RATE_HZ = 200
BLOCK = 600 * RATE_HZ  # ten minutes
CHECKPOINT = 2000  # samples: ten seconds


VARIANTS = 7  # number of different blocks; generating all would take longer than filtering them


@functools.lru_cache(VARIANTS)
def values(variant, size):
    """Contents of a block's lines after the time, and the disturbances among them."""
    random = np.random.default_rng([7, variant])
    k = variant * size + np.arange(size)
    left, right = np.sin(k / 170.0), np.sin(k / 230.0 + 1.0)
    gain = np.where((k // 3000) % 2 == 0, 0.9, 0.4)  # two alternating modes
    state = gain * (right - left) + random.normal(0.0, 0.02, size)
    table = np.column_stack([state, left, right])
    lines = (",%.6f,%.6f,%.6f\n" * size % tuple(table.ravel())).splitlines(keepends=True)
    for i in range(0, size - 3, 997):  # a missing state, then a missing input; sometimes a line that is not a sample
        lines[i] = "," + lines[i][lines[i].index(",", 1):]
        lines[i + 1] = ",".join([*lines[i + 1].split(",")[:2], "", lines[i + 1].split(",")[3]])
        if i % (997 * 16) == 0:
            lines[i + 3] += "no,sample\n"
    return lines


def block(number, size):
    """The lines of a block; some samples are repeated."""
    times = ("%.3f\n" * size % tuple((number * size + np.arange(size)) / RATE_HZ)).splitlines()
    lines = list(map(operator.add, times, values(number % VARIANTS, size)))
    for i in range(2, size, 997):
        lines[i] += lines[i]
    return lines


class Filter:
    """A `modebank track` process with a thread that reads its output."""

    def __init__(self, command):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.written = bytearray()
        self.said = bytearray()
        self.lock = threading.Lock()
        self.threads = [threading.Thread(target=self.drain, args=arguments)
                        for arguments in [(self.process.stdout, self.written), (self.process.stderr, self.said)]]
        for thread in self.threads:
            thread.start()

    def drain(self, stream, to):
        while chunk := os.read(stream.fileno(), 1 << 20):
            with self.lock:
                to += chunk

    def send(self, lines):
        try:
            self.process.stdin.write("".join(lines).encode())
            self.process.stdin.flush()
        except BrokenPipeError:
            sys.exit(f"the filter ended: {self.said.decode()}")

    def end(self, kill):
        if kill:
            self.process.send_signal(signal.SIGKILL)
        else:
            self.process.stdin.close()
        for thread in self.threads:
            thread.join()
        status = self.process.wait()
        if not kill and status != 0:
            sys.exit(f"status {status}: {self.said.decode()}")

    def take(self):
        """The complete lines so far."""
        with self.lock:
            end = self.written.rfind(b"\n") + 1
            lines = bytes(self.written[:end])
            del self.written[:end]
        return lines

    def resident_kb(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
            return int(re.search(r"VmRSS:\s+(\d+)", status.read())[1])


def stamp_of(line):
    return float(line[: line.index(b",")])


def up_to(lines, time_s):
    """The lines at or before a time, from lines in time order."""
    kept = lines.splitlines(keepends=True)
    low, high = 0, len(kept)
    while low < high:
        middle = (low + high) // 2
        if stamp_of(kept[middle]) <= time_s:
            low = middle + 1
        else:
            high = middle
    return b"".join(kept[:low])


class Killed:
    """The filter that is killed and continued; `digest` covers its output, each estimate once."""

    def __init__(self, command, header, folder):
        self.command, self.header = command, header
        self.checkpoint = os.path.join(folder, "state.json")
        self.digest, self.pending, self.sent = hashlib.sha256(), b"", []
        self.kills = self.again = 0
        self.start([])

    def start(self, resume):
        self.filter = Filter([*self.command, f"--track.checkpoint={self.checkpoint}",
                              f"--track.checkpoint_interval={CHECKPOINT}", *resume])
        self.filter.send([self.header])
        self.headed = False

    def send(self, lines):
        self.filter.send(lines)
        self.sent += lines

    def collect(self):
        lines = self.filter.take()
        if lines and not self.headed:
            lines = lines[lines.index(b"\n") + 1:]
            self.headed = True
        self.pending += lines

    def kill(self):
        if not os.path.exists(self.checkpoint):
            return  # no checkpoint to continue from yet
        self.filter.end(kill=True)
        self.collect()
        self.start([f"--track.resume={self.checkpoint}"])
        while b"\n" not in self.filter.said:
            time.sleep(0.001)
        said = re.search(r"goes on after the sample at (\S+) s", self.filter.said.decode())
        time_s = float(said[1])
        kept = up_to(self.pending, time_s)
        self.again += self.pending.count(b"\n") - kept.count(b"\n")
        self.digest.update(kept)
        self.pending = b""
        first = next((i for i, line in enumerate(self.sent) if float(line.split(",", 1)[0]) > time_s), len(self.sent))
        self.sent = self.sent[first:]
        self.filter.send(self.sent)
        self.kills += 1

    def forget(self):
        """Drops samples long before the last checkpoint, which are not sent again."""
        self.sent = self.sent[-10 * CHECKPOINT:] if len(self.sent) > 20 * CHECKPOINT else self.sent
        self.collect()

    def end(self):
        self.filter.end(kill=False)
        self.collect()
        self.digest.update(self.pending)


def main():
    program, archive = sys.argv[1:3]
    hours = float(sys.argv[3]) if len(sys.argv) > 3 else 24.0
    with h5py.File(archive) as file:
        config = configparser.ConfigParser(strict=False, interpolation=None)
        config.read_string(file["config"][()].decode())
    inputs = ",".join(name.strip() for name in config["data"]["input"].split(","))
    header = f"time,{config['data']['state']},{inputs}\n"
    command = [program, "track", archive, "--data.time=time"]
    blocks = max(1, round(hours * 6))
    size = min(BLOCK, round(hours * 3600 * RATE_HZ / blocks))
    random = np.random.default_rng(1)
    whole, resident, start = hashlib.sha256(), [], time.time()
    with tempfile.TemporaryDirectory() as folder:
        through = Filter(command)
        through.send([header])
        killed = Killed(command, header, folder)
        samples, headed = 0, False
        for number in range(blocks):
            lines = block(number, size)
            through.send(lines)
            cut = int(random.integers(1, len(lines)))
            killed.send(lines[:cut])
            killed.kill()
            killed.send(lines[cut:])
            out = through.take()
            if out and not headed:
                out, headed = out[out.index(b"\n") + 1:], True
            whole.update(out)
            resident.append(through.resident_kb())
            samples += size
            killed.forget()
            if number % 6 == 5:
                print(f"{(number + 1) / 6:.0f} h: {samples} samples, {killed.kills} kills, {resident[-1]} kB, "
                      f"{time.time() - start:.0f} s", flush=True)
        through.end(kill=False)
        out = through.take()
        whole.update(out if headed else out[out.index(b"\n") + 1:])
        killed.end()
    usage = os.times()
    print(f"{samples} samples at {RATE_HZ} Hz; {killed.kills} kills, {killed.again} estimates made again; resident memory "
          f"after the first block {resident[0]} kB, at most {max(resident)} kB, at the end {resident[-1]} kB; "
          f"{time.time() - start:.0f} s, processor time of the filters {usage.children_user + usage.children_system:.0f} s")
    print(f"whole  {whole.hexdigest()}\nkilled {killed.digest.hexdigest()}")
    if whole.digest() != killed.digest.digest():
        sys.exit("what the killed filter wrote differs")
    if resident[-1] > resident[0] + 1024:
        sys.exit("the filter grows")


if __name__ == "__main__":
    main()
