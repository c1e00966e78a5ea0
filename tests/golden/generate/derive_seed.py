"""Prints the expected values of tests/ident/data/window_test.cpp, Seed.HasTheStatedMixing.

Run:  /usr/bin/python3 derive_seed.py
"""

MASK = 2**64 - 1


def splitmix64(x):
    x = (x + 0x9E3779B97F4A7C15) & MASK
    x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & MASK
    return x ^ (x >> 31)


def fnv1a(text):
    h = 0xCBF29CE484222325
    for byte in text.encode():
        h = ((h ^ byte) * 0x100000001B3) & MASK
    return h


def derive_seed(seed, use, index=0):
    return splitmix64(splitmix64(splitmix64(seed) ^ fnv1a(use)) ^ index)


assert splitmix64(0) == 0xE220A8397B1DCDAF  # first output of the published generator seeded with 0
assert fnv1a("a") == 0xAF63DC4C8601EC8C  # published test vector
print(derive_seed(0, ""), derive_seed(1, "simulate.modes", 7))
