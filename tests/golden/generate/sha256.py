"""Writes tests/golden/data/sha256.json: SHA-256 by Python's hashlib, of messages of every length around one and two
blocks, and the Monte Carlo test of NIST's SHA Validation System (SHAVS, section 6.4).

Run:  python3 sha256.py
"""
import hashlib
import json
import pathlib


def message(length):
    """Bytes (7 i + length) mod 256."""
    return bytes((7 * i + length) % 256 for i in range(length))


def monte_carlo(seed, checkpoints):
    digests = []
    for _ in range(checkpoints):
        last = [seed, seed, seed]
        for _ in range(1000):
            last = last[1:] + [hashlib.sha256(b"".join(last)).digest()]
        seed = last[-1]
        digests.append(seed.hex())
    return digests


assert hashlib.sha256(b"abc").hexdigest() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
seed = hashlib.sha256(b"modebank").digest()
golden = {
    "messages": [hashlib.sha256(message(length)).hexdigest() for length in range(200)],
    "seed": seed.hex(),
    "monte_carlo": monte_carlo(seed, 10),
}
path = pathlib.Path(__file__).parent.parent / "data" / "sha256.json"
path.write_text(json.dumps(golden, indent=1) + "\n")
