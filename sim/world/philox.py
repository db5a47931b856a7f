"""Random numbers as a function of a key and a counter.

There is no state, so the order of sampling is irrelevant. The generator is Philox4x32-10 of Salmon et al.,
"Parallel random numbers: as easy as 1, 2, 3" (SC 2011).
"""

import math

from vitruvius.sim.runtime import ti

EPISODE, SENSOR, WHEELS, ODOMETER, DIRECTION, VARIED = range(6)
"""Purposes of random numbers: the fourth word of the counter."""

MASK = 0xFFFFFFFF
Words = ti.types.vector(4, ti.u64)


@ti.func
def philox(key, counter: Words) -> Words:
    """Return four random 32-bit words, each in a u64, for a 64-bit key and a counter of four 32-bit words.

    Words stay below 2^32 in 64 bits, so that no product overflows and Taichi's checks report nothing.
    """
    mask = ti.u64(MASK)
    k0, k1 = key & mask, key >> ti.u64(32)
    c = counter
    for _ in range(10):
        p0, p1 = ti.u64(0xD2511F53) * c[0], ti.u64(0xCD9E8D57) * c[2]
        c = Words((p1 >> ti.u64(32)) ^ c[1] ^ k0, p1 & mask, (p0 >> ti.u64(32)) ^ c[3] ^ k1, p0 & mask)
        k0, k1 = (k0 + ti.u64(0x9E3779B9)) & mask, (k1 + ti.u64(0xBB67AE85)) & mask
    return c


@ti.func
def below(word, bound):
    """Return a number in 0..bound-1 from a random 32-bit word, uniform except for less than bound / 2^32."""
    return ti.cast((word * ti.cast(bound, ti.u64)) >> ti.u64(32), ti.i32)


@ti.func
def uniform(word):
    """Return a float32 in [0, 1) from a random 32-bit word: its upper 24 bits."""
    return ti.cast(word >> ti.u64(8), ti.f32) * ti.static(2.0**-24)


@ti.func
def normal(words):
    """Return a standard normal float32 from two random words (Box-Muller)."""
    size = ti.sqrt(-2.0 * ti.log(1.0 - uniform(words[0])))
    return size * ti.cos(ti.static(2 * math.pi) * uniform(words[1]))
