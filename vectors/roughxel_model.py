#!/usr/bin/env python3
"""Bit-exact model of the Roughxel datapaths, and a checker of golden vectors (format 3).

Exact integers throughout; Python 3.8 or newer and nothing else. Names and section numbers are those of SPEC.md.
As a program:

    python3 roughxel_model.py                       # the tables in `rom` and the sets in `smoke` and `smoke/stages`, beside this file
    python3 roughxel_model.py DIR_OR_JSON...        # other sets

Exit code: 0 all right, 3 a field or a table differs, 1 something is unreadable, 2 usage, 4 nothing differs, but there are sets of
stages that the model does not compute alone (they were read, with their check values). As a library:

    manifest = read_manifest("random_standard.json")
    for vector in load("random_standard.json"):
        fields = evaluate(manifest, vector)         # every tap and out field, by name
"""

from __future__ import annotations

import argparse
import functools
import json
import math
import os
import re
import sys
from dataclasses import dataclass
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

Manifest = Dict[str, Any]
Fields = Dict[str, int]


# --------------------------------------------------------------------------------------------------------------------
# Section 2: profiles and kinds of numbers
# --------------------------------------------------------------------------------------------------------------------

class Newton(NamedTuple):
    """A seed table and the refinements behind it."""
    seed_bits: int
    steps: int


@dataclass(frozen=True)
class Profile:
    """The knobs that decide results (2). Fields of a set are mantissas without their `dropped` low zero_block."""
    fraction_bits: int
    reciprocal: Newton
    inverse_root: Newton
    direction_steps: int = 0        # 0: exact, else steps of the table over 90 degrees
    max_probes: int = 16
    power_of_two: bool = False
    lod_bits: int = 8

    @property
    def word(self) -> int:
        """W (2): bits of a word."""
        return 16 if self.fraction_bits <= 14 else 32

    @property
    def fraction(self) -> int:
        """F (2): fraction bits of a mantissa."""
        return self.word - 2

    @property
    def dropped(self) -> int:
        """F - p (2): low bits of a mantissa that are always zero."""
        return self.fraction - self.fraction_bits

    @staticmethod
    def from_knobs(knobs: Dict[str, Any]) -> "Profile":
        """The profile of a manifest's `profile.knobs`."""
        direction = knobs["direction"]
        rule = knobs["probe_rule"]
        if rule not in ("ceiling", "power_of_two"):
            raise ValueError(f"unknown probe_rule {rule!r}")
        if direction == "exact":
            steps = 0
        elif isinstance(direction, dict) and list(direction) == ["table"]:
            steps = direction["table"]["steps"]
        else:
            raise ValueError(f"unknown direction {direction!r}")
        return Profile(knobs["fraction_bits"],
                       Newton(knobs["reciprocal"]["seed_bits"], knobs["reciprocal"]["steps"]),
                       Newton(knobs["inverse_root"]["seed_bits"], knobs["inverse_root"]["steps"]),
                       steps, knobs["max_probes"], rule == "power_of_two", knobs["lod_bits"])


PROFILES = {
    "narrow": Profile(14, Newton(8, 1), Newton(8, 1), lod_bits=6),
    "paper": Profile(16, Newton(8, 1), Newton(8, 1), direction_steps=10, power_of_two=True, lod_bits=4),
    "compact": Profile(16, Newton(8, 1), Newton(8, 1), lod_bits=6),
    "standard": Profile(20, Newton(10, 1), Newton(10, 1), lod_bits=8),
    "precise": Profile(26, Newton(8, 2), Newton(8, 2), lod_bits=12),
}

ZERO_E = -(1 << 15)      # of a block of zero_block, inside the datapath
VISIBLE = 1 << 16               # a share of one, 16 fraction bits


class Block(NamedTuple):
    """Mantissas and their common exponent (2): component i is m[i] * 2^-F * 2^e. A number has one mantissa."""
    m: Tuple[int, ...]
    e: int

    @property
    def zero(self) -> bool:
        """All mantissas are zero."""
        return not any(self.m)

    def scaled(self, e: int) -> "Block":
        """Times 2^e; moves the exponent of zero_block, too."""
        return Block(self.m, self.e + e)


def zero_block(n: int) -> Block:
    """A block of n zero_block (2): its exponent wins no alignment."""
    return Block((0,) * n, ZERO_E)


class Frame(NamedTuple):
    """Tangents in units of the mantissas of n."""
    e1: Block
    e2: Block
    pole: bool


class Surface(NamedTuple):
    """What all datapaths begin with: n, v, the frame, n_mod and the tangents of the roughness."""
    normal: Block
    view: Block
    frame: Frame
    modified: Block
    rough: List[Block]


class Reflected(NamedTuple):
    """r, the pair (v.n, |n|^2) it was made of, and whether v.n <= 0."""
    r: Block
    scalars: Block
    below: bool


class Place(NamedTuple):
    """A place on the cube, 1/(2m) and whether another component is as large as m."""
    face: int
    st: List[int]
    half_reciprocal: int
    tie: bool


class Axes(NamedTuple):
    """lambda 1 and 2 and the unit direction of lambda 1."""
    major: Block
    minor: Block
    direction: List[int]


class Rule(NamedTuple):
    """Probes needed, whether there are too few, and what the one before the last left over."""
    count: int
    capped: bool
    beyond: int


class Slope(NamedTuple):
    """A slope with p - 4 kept fraction bits, the side it looks to, and whether the run is zero."""
    slope: int
    negative: bool
    upright: bool


# --------------------------------------------------------------------------------------------------------------------
# Section 3: primitives that know no profile
# --------------------------------------------------------------------------------------------------------------------

def rnd(x: int, k: int) -> int:
    """rnd (3): x / 2^k to nearest, ties up; exact for k <= 0."""
    if k <= 0:
        return x << -k
    return (x + (1 << (k - 1))) >> k


def clamp(x: int, low: int, high: int) -> int:
    """clamp (3)."""
    return low if x < low else high if x > high else x


def point(x: int, f: int, g: int) -> int:
    """point (3): from f to g fraction bits, exact or floored."""
    return x << (g - f) if g >= f else x >> (f - g)


def floored(x: int, k: int) -> int:
    """floored (3): x / 2^k downwards; a negative k counts as 0."""
    return x >> k if k > 0 else x


def at_exponent(x: int, e: int, up: int) -> int:
    """at_exponent (3): x * 2^e with `up` fraction bits less than x; e above `up` counts as `up`."""
    return floored(x, up - e)


def dot(a: Sequence[int], b: Sequence[int]) -> int:
    """dot (3), exact."""
    return sum(x * y for x, y in zip(a, b))


def cross(a: Sequence[int], b: Sequence[int]) -> List[int]:
    """cross (3), exact."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def code_parts(code: int) -> Tuple[int, int]:
    """A stored code of 16 bits as integer and exponent (5, short_number): value = integer * 2^exponent units."""
    c, f = code >> 12, code & 0xfff
    return (4096 + f, c - 1) if c else (f, 0)


def leave(block: Block) -> Block:
    """leave (6): a block as a port."""
    return Block(block.m, 0 if block.zero else clamp(block.e, -(1 << 15), (1 << 15) - 1))


def to_face(face: int, vector: Sequence[int]) -> Tuple[int, int, int]:
    """Table of cube_face (6): s_c, t_c and m of a vector, as a face sees it."""
    x, y, z = vector
    return ((-z, -y, x), (z, -y, -x), (x, z, y), (x, -z, -y), (x, -y, z), (-x, -y, -z))[face]


# --------------------------------------------------------------------------------------------------------------------
# Section 4: tables
# --------------------------------------------------------------------------------------------------------------------

def nearest(x: float, f: int) -> int:
    """nearest (4): x >= 0 with f fraction bits."""
    return int(x * (1 << f) + 0.5)


def reciprocal_seeds(k: int) -> List[int]:
    """Reciprocal seeds (4), k + 2 fraction bits: 1/(2x) in the middle of each interval."""
    seeds = []
    for i in range(1 << k):
        middle = (1 << (k + 1)) + 2 * i + 1                             # x with k + 2 fraction bits
        seeds.append(((1 << (2 * k + 4)) + middle) // (2 * middle))
    return seeds


def inverse_root_seeds(k: int) -> List[int]:
    """Inverse root seeds (4), k + 2 fraction bits: 1/(2 sqrt x), rounded by an integer root with one more bit."""
    n = 1 << k
    return [(math.isqrt((n << (2 * k + 6)) // (n + 4 * i + 2)) + 1) >> 1 for i in range(3 * n // 4)]


LOG2 = [nearest(math.log2(1 + i / 256), 24) for i in range(257)]
EXP2 = [nearest(2.0 ** (i / 256 - 1), 30) for i in range(257)]
ONE_MINUS = [nearest(0.5 / math.log(2), 26)] + [nearest(-math.log2(1 - i / 512) * 256 / i, 26) for i in range(1, 257)]
ONE_PLUS = [nearest(0.5 / math.log(2), 26)] + [nearest(math.log2(1 + i / 256) * 128 / i, 26) for i in range(1, 257)]
COUNTS = [1, *range(1, 17)]         # entry 0 is not read; it is that of 1
STEP_PER_SIGMA = [nearest(math.sqrt(12) / i, 28) for i in COUNTS]
SPREAD_LIMIT = [nearest(math.sqrt(1 - 1 / (i * i)), 30) for i in COUNTS]
LOG2_OF_COUNT = [nearest(math.log2(i), 16) for i in COUNTS]
BOX_SIGMA = 309962566               # 1/sqrt(12), 30 fraction bits
LOG2_DIAMETER = 117472              # log2(2 sqrt 3), 16
LOG2_TEXEL_ON_SPHERE = 107510       # log2(1.8 sqrt 3), 16


def tables() -> Dict[str, List[int]]:
    """The tables of the folder `rom` (4), by the names of their files."""
    out = {"log2": LOG2, "exp2": EXP2, "half_log2_one_minus_ratio": ONE_MINUS, "half_log2_one_plus_ratio": ONE_PLUS,
           "step_per_sigma": STEP_PER_SIGMA, "spread_limit": SPREAD_LIMIT, "log2_of_count": LOG2_OF_COUNT}
    for k in (8, 10):
        out[f"reciprocal_{k}"] = [seed << (28 - k) for seed in reciprocal_seeds(k)]
        out[f"inverse_root_{k}"] = [seed << (28 - k) for seed in inverse_root_seeds(k)]
    return out


def wrong_tables(folder: str) -> List[str]:
    """The files of `rom` that are not, to the byte, what their formulas give."""
    wrong = []
    for name, table in tables().items():
        path = os.path.join(folder, name + ".hex")
        with open(path, encoding="ascii", newline="\n") as file:
            if file.read() != "".join(f"{entry:08x}\n" for entry in table):
                wrong.append(path)
    return wrong


# --------------------------------------------------------------------------------------------------------------------
# Sections 3 and 5 to 7, for one profile
# --------------------------------------------------------------------------------------------------------------------

class Datapath:
    """Everything that depends on the profile. Mantissas have F fraction bits, of which p are kept."""

    def __init__(self, profile: Profile) -> None:
        self.profile = profile
        self.p = profile.fraction_bits
        self.w = profile.word
        self.f = profile.fraction
        self.ff = 2 * self.f                    # fraction bits of a product
        self.drop = profile.dropped
        self.one = 1 << self.f
        self.unit = Block((1 << (self.f - 1),), 1)
        k = profile.reciprocal.seed_bits
        self.reciprocal_table = [seed << (self.f - k - 2) for seed in reciprocal_seeds(k)]
        k = profile.inverse_root.seed_bits
        self.root_table = [seed << (self.f - k - 2) for seed in inverse_root_seeds(k)]
        self.box_sigma = self.table_mantissa(BOX_SIGMA)

    # ---- Section 3 ----

    def mantissa(self, x: int, f: int) -> int:
        """mantissa (3): a number with f fraction bits, rounded to a mantissa."""
        return rnd(x, f - self.p) << self.drop

    def offset_word(self, x: int, f: int) -> int:
        """offset_word (3): the same as an offset or roughness, with two fraction bits less."""
        return rnd(x, f - self.p + 2) << self.drop

    def normalise(self, xs: Sequence[int], f: int, e: int, keep: Optional[int] = None) -> Block:
        """normalise (3): numbers with f fraction bits and an exponent as a block, rounded once."""
        keep = self.p if keep is None else keep
        bits = max((x if x >= 0 else ~x).bit_length() for x in xs)
        if bits == 0 and not any(xs):
            return zero_block(len(xs))
        return Block(tuple(rnd(x, bits - keep) << (self.f - keep) for x in xs), e + bits - f)

    def number(self, x: int, f: int, e: int, keep: Optional[int] = None) -> Block:
        """number (3): a block of one."""
        return self.normalise((x,), f, e, keep)

    def shifted(self, m: int, k: int) -> int:
        """shifted (3): mantissa / 2^k, rounded, 0 <= k < W."""
        return rnd(m >> self.drop, k) << self.drop

    def mantissas_at(self, block: Block, e: int) -> List[int]:
        """mantissas_at (3): those for a larger exponent e."""
        k = clamp(e - block.e, 0, self.w - 1)
        return [self.shifted(m, k) for m in block.m]

    def align(self, blocks: Sequence[Block]) -> Tuple[List[List[int]], int]:
        """align (3): all to the largest exponent, each rounded."""
        top = max(block.e for block in blocks)
        return [self.mantissas_at(block, top) for block in blocks], top

    def times(self, block: Block, k: Block) -> Block:
        """times (3): a block times a number."""
        return self.normalise([m * k.m[0] for m in block.m], self.ff, block.e + k.e)

    def square_length(self, block: Block) -> Block:
        """square_length (3)."""
        return self.number(dot(block.m, block.m), self.ff, 2 * block.e)

    def square_of_mantissas(self, block: Block) -> Block:
        """The same of the mantissas alone, as directions need it."""
        return self.number(dot(block.m, block.m), self.ff, 0)

    # ---- Section 4 ----

    def table_mantissa(self, entry: int) -> int:
        """table_mantissa (4): an entry with 30 fraction bits, first as a word."""
        return self.mantissa(rnd(entry, 32 - self.w), self.f)

    def table_offset(self, entry: int) -> int:
        """table_offset (4): an entry with 28 fraction bits, first as a word."""
        return self.offset_word(rnd(entry, 32 - self.w), self.w - 4)

    def angle(self, i: int, n: int) -> Tuple[int, int]:
        """angle (4): cosine and sine of i/n of a right angle, the cosine as the sine of the rest."""
        cosine, sine = (self.table_mantissa(nearest(math.sin(turn * math.pi / (2 * n)), 30)) for turn in (n - i, i))
        return cosine, sine

    # ---- Section 5 ----

    def correct(self, y: int, residual: int, s: int, halve: int) -> int:
        """correct (5): y + y * residual / 2^halve. The residual is cut to 2^-s, shifted up by s, and rounded."""
        limit = (1 << self.ff) >> s
        operand = self.mantissa(clamp(residual, -limit, limit) << s, self.ff)
        return self.mantissa((y << self.f) + ((y * operand) >> (s + halve)), self.ff)

    def half_reciprocal(self, x: int) -> int:
        """half_reciprocal (5): 1/(2x) of a mantissa in [1/2, 1]."""
        k, steps = self.profile.reciprocal
        index = point(x - (self.one >> 1), self.f, k + 1)
        y = self.reciprocal_table[clamp(index, 0, len(self.reciprocal_table) - 1)]
        s = k - 3
        for _ in range(steps):
            y = self.correct(y, (1 << self.ff) - 2 * x * y, s, 0)
            s = min(2 * s, self.f - 2)
        return min(y, self.one)

    def half_inverse_root(self, x: int) -> int:
        """half_inverse_root (5): 1/(2 sqrt x) of a mantissa in [1/4, 1]."""
        k, steps = self.profile.inverse_root
        index = point(x - (self.one >> 2), self.f, k)
        y = self.root_table[clamp(index, 0, len(self.root_table) - 1)]
        s = k - 3
        for _ in range(steps):
            square = self.mantissa(y * y, self.ff)
            y = self.correct(y, (1 << self.ff) - 4 * x * square, s, 1)
            s = min(2 * s, self.f - 2)
        return min(y, self.one)

    def inverse_root(self, x: Block) -> Block:
        """inverse_root (5): 1/sqrt(x); the exponent is made even first."""
        odd = x.e & 1
        return Block((self.half_inverse_root(self.shifted(x.m[0], odd)),), 1 - (x.e + odd) // 2)

    def root_and_inverse(self, x: Block) -> Tuple[Block, Block]:
        """root_and_inverse (5)."""
        inverse = self.inverse_root(x)
        return self.times(x, inverse), inverse

    def root(self, x: Block) -> Block:
        """sqrt(x): x times its inverse root."""
        return self.root_and_inverse(x)[0]

    def over_length(self, block: Block) -> List[int]:
        """over_length (5): the components over the length, as mantissas that may exceed 1 a little."""
        inverse = self.inverse_root(self.square_of_mantissas(block))
        return [self.mantissa(at_exponent(m * inverse.m[0], inverse.e, 2), self.ff - 2) for m in block.m]

    def between(self, difference: int, f: int, e: int, fraction: int) -> int:
        """between (5): a fraction of the difference of two knots. In words of 16 bits the difference loses its leading
        zero_block, then its low bits."""
        if self.w == 32:
            return difference * fraction
        s = 30 - f + e
        return (((difference << s) >> 16) * fraction) >> s

    def between_knots(self, table: List[int], f: int, e: int, x: int, places: int) -> int:
        """between_knots (5): a table of f fraction bits read at a mantissa x in [0, 1), with 2W - 34 + f of them."""
        place = self.f - places
        i = x >> place
        fraction = self.mantissa(x & ((1 << place) - 1), place)
        low, high = table[i], table[i + 1]
        rise = self.between(abs(high - low), f, e, fraction)
        return point(low, f, 2 * self.w - 34 + f) + (rise if high >= low else -rise)

    def log2(self, m: int) -> int:
        """log2 (5): of a mantissa, 24 fraction bits, in [-1, 0]."""
        if m >= self.one:
            return 0
        value = self.between_knots(LOG2, 24, 7, max(m - (self.one >> 1), 0), 9)
        return rnd(value, 2 * self.w - 34) - (1 << 24)

    def exp2(self, x: int) -> Block:
        """exp2 (5): 2^x of x with 24 fraction bits, |x| < 64. The mantissa is in [1/2, 1]."""
        i = (x >> 16) & 255
        step = rnd(EXP2[i + 1] - EXP2[i], 6) << 6
        rise = self.between(step, 30, 8, self.mantissa(x & 0xffff, 16))
        return Block((self.mantissa(point(EXP2[i], 30, self.ff) + rise, self.ff),), (x >> 24) + 1)

    def minus_log2_one_minus(self, y: int) -> Block:
        """minus_log2_one_minus (5): -log2(1 - y), y >= 0 with 2F + 1 fraction bits."""
        half = 1 << self.ff
        if y < half:
            ratio = self.between_knots(ONE_MINUS, 26, 9, y >> (self.f + 1), 9)
            value = self.number(y, self.ff + 1, 0)
            return self.number(value.m[0] * self.mantissa(ratio, 2 * self.w - 8), self.ff, value.e + 1)
        rest = self.number(max(2 * half - y, 0), self.ff + 1, 0)
        log = self.log2(rest.m[0]) + (clamp(rest.e, -63, 0) << 24)
        return self.number(point(-log, 24, self.ff - 12), self.ff, 12)

    def cosine_power(self, y: int, n: Block) -> Block:
        """cosine_power (5): (1 - y)^n, y with 2F + 1 fraction bits."""
        if y >> (self.ff + 1):
            return zero_block(1)
        log = self.minus_log2_one_minus(y)
        e = log.e + n.e
        most = 63 << 24
        fall = rnd(at_exponent(log.m[0] * n.m[0], e, 6), self.ff - 6 - 24)
        return self.exp2(-(most if e > 6 else min(fall, most)))

    def short_number(self, code: int) -> Block:
        """short_number (5): a stored code in units of 2^-13."""
        integer, e = code_parts(code)
        return Block((integer << (self.f - 13),), e)

    def one_plus(self, x: Block, keep: Optional[int] = None) -> Block:
        """one_plus (5): 1 + x of x >= 0."""
        top = max(x.e, 0)
        return self.number(floored(1 << self.ff, top) + floored(x.m[0] << self.f, top - x.e), self.ff, top, keep)

    def log2_one_plus(self, x: Block) -> Block:
        """log2_one_plus (5): log2(1 + x) of x >= 0."""
        if x.e <= 0:
            place = min(x.m[0] >> min(-x.e, self.w - 1), self.one - 1)
            ratio = self.between_knots(ONE_PLUS, 26, 9, place, 8)
            return self.number(x.m[0] * self.mantissa(ratio, 2 * self.w - 8), self.ff, x.e + 1)
        total = self.one_plus(x, keep=self.f)
        return self.number((total.e << 24) + self.log2(total.m[0]), 24, 0)

    # ---- Section 6: enter, frame, perturb, roughness ----

    def enter(self, m: Sequence[int], e: int = 0) -> Block:
        """enter (6): a vector's port; its exponent is read within 2^11."""
        return self.normalise(m, self.f, clamp(e, -2048, 2048))

    def enter_offset(self, x: int) -> int:
        """enter.offset, enter.roughness (6)."""
        most = ((2 << self.p) - 1) << self.drop
        return self.offset_word(min(x, most), self.w - 4)

    def enter_shininess(self, m: int, root: int) -> Tuple[Block, Block]:
        """enter.shininess (6, highlight): m and its root, with 16 and 24 fraction bits."""
        return (self.number(clamp(m, 1 << 16, 8192 << 16), 16, 0), self.number(clamp(root, 1 << 24, 91 << 24), 24, 0))

    def length_of_mantissas(self, n: Block) -> Block:
        """|n| without the exponent of n."""
        return self.root(self.square_length(n)).scaled(-n.e)

    def main_direction(self, n: Block, h: Block) -> Frame:
        """frame, system 3 (6): E1 along h x n, E2 along n x E1, both of the length of n."""
        across = cross(h.m, n.m)
        pole = not any(across)
        if pole:                                # the unit axis on which |n| is smallest, times n
            x, y, z = n.m
            smallest = min(range(3), key=lambda i: abs(n.m[i]))
            turned = ((0, -z, y), (z, 0, -x), (-y, x, 0))[smallest]
            across = [m << self.f for m in turned]
        c = self.normalise(across, self.ff, 0)
        d = self.normalise(cross(n.m, c.m), self.ff, c.e)
        inverse = self.inverse_root(self.square_length(c))
        ratio = self.times(inverse, self.length_of_mantissas(n))
        return Frame(self.times(c, ratio), self.times(d, inverse), pole)

    def natural(self, n: Block, u: Block, v: Block) -> Frame:
        """frame, system 1 (6): n x p_v and p_u x n over |p_u x p_v|."""
        area = self.normalise(cross(u.m, v.m), self.ff, u.e + v.e)
        if area.zero:
            return Frame(zero_block(3), zero_block(3), True)
        inverse = self.inverse_root(self.square_length(area))
        s_u = self.normalise(cross(n.m, v.m), self.ff, v.e)
        s_v = self.normalise(cross(u.m, n.m), self.ff, u.e)
        return Frame(self.times(s_u, inverse), self.times(s_v, inverse), False)

    def natural_normalised(self, n: Block, u: Block, v: Block) -> Frame:
        """frame, system 2 (6): the directions of system 1, both of the length of n."""
        sides = [self.normalise(cross(n.m, v.m), self.ff, 0), self.normalise(cross(u.m, n.m), self.ff, 0)]
        if any(side.zero for side in sides):
            return Frame(zero_block(3), zero_block(3), True)
        length = self.length_of_mantissas(n)
        e1, e2 = (self.times(s, self.times(self.inverse_root(self.square_length(s)), length)) for s in sides)
        return Frame(e1, e2, False)

    def perturb(self, n: Block, b: Sequence[int], frame: Frame) -> Block:
        """perturb (6): n + b1 E1 + b2 E2, floored to the largest exponent of a term that is not zero."""
        if not any(b):
            return n
        terms = [([m << (self.w - 5) for m in n.m], ZERO_E if n.zero else 0)]
        for factor, tangent in zip(b, (frame.e1, frame.e2)):
            terms.append(([(factor * m) >> 1 for m in tangent.m], tangent.e if factor else ZERO_E))
        top = max(e for _, e in terms)
        total = [sum(floored(xs[i], top - e) for xs, e in terms) for i in range(3)]
        return self.normalise(total, 2 * self.w - 7, top + n.e)

    def rough_times(self, d: int, tangent: Block) -> Block:
        """A stored deviation times a tangent."""
        return self.normalise([d * m for m in tangent.m], 2 * self.w - 6, tangent.e)

    def roughness_anisotropic(self, d: Sequence[int], frame: Frame) -> List[Block]:
        """roughness (6): d1 E1 and d2 E1 + d3 E2."""
        terms = [(factor, tangent.m, tangent.e if factor else ZERO_E)
                 for factor, tangent in ((d[1], frame.e1), (d[2], frame.e2))]
        top = max(e for _, _, e in terms)
        total = [sum(floored(factor * m[i], top - e) for factor, m, e in terms) for i in range(3)]
        return [self.rough_times(d[0], frame.e1), self.normalise(total, 2 * self.w - 6, top)]

    def roughness_isotropic(self, d: Sequence[int], frame: Frame) -> List[Block]:
        """roughness (6), isotropic: I1 E1 and I1 E2."""
        return [self.rough_times(d[0], frame.e1), self.rough_times(d[0], frame.e2)]

    # ---- Section 6: reflect, cube_face, columns ----

    def reflect(self, n: Block, v: Block) -> Reflected:
        """reflect (6): r = 2n<v.n> - v|n|^2."""
        along = dot(v.m, n.m)
        scalars = self.normalise((along, dot(n.m, n.m)), self.ff, 0)
        a, square = scalars.m
        r = [2 * x * a - y * square for x, y in zip(n.m, v.m)]
        return Reflected(self.normalise(r, self.ff, scalars.e + v.e + 2 * n.e), scalars, along <= 0)

    def cube_face(self, r: Block) -> Place:
        """cube_face (6): the face that r meets, s and t on it."""
        size = [abs(m) for m in r.m]
        axis = max((2, 1, 0), key=lambda i: size[i])            # the first of equals: z, then y
        face = 2 * axis + (r.m[axis] < 0)
        s_c, t_c, m = to_face(face, r.m)
        h = self.half_reciprocal(m)
        st = [clamp(self.mantissa(c * h, self.ff - 1), -self.one, self.one) for c in (s_c, t_c)]
        return Place(face, st, h, size.count(m) > 1)

    def derivative(self, n: Block, v: Block, reflected: Reflected, dv: Block, dn: Block) -> Block:
        """columns.derivative (6): dr of a pair (dv, dn)."""
        (u, w), e = self.align([dv.scaled(n.e), dn.scaled(v.e)])
        scale = 4 - clamp(reflected.scalars.e + 2, 0, 4)
        products = [(dot(n.m, u) + dot(v.m, w)) >> 2, dot(n.m, w) >> 2]
        products += [(m << self.f) >> scale for m in reflected.scalars.m]
        four = self.normalise(products, self.ff - 2, 0)
        moved, n_dn, n_v, n_n = four.m
        dr = [2 * (n.m[i] * moved - v.m[i] * n_dn + w[i] * n_v) - u[i] * n_n for i in range(3)]
        return self.normalise(dr, self.ff, e + four.e + n.e)

    def across(self, place: Place, dr: Block) -> Block:
        """columns (6): how (s_c, t_c) moves against m."""
        ds, dt, dm = to_face(place.face, dr.m)
        s, t = place.st
        return self.normalise(((ds << self.f) - s * dm, (dt << self.f) - t * dm), self.ff, dr.e)

    def column(self, reflected: Reflected, place: Place, dr: Block) -> Block:
        """columns.pixel, columns.roughness (6): the column on the face."""
        if reflected.r.zero:
            return zero_block(2)
        across = self.across(place, dr)
        return self.times(across, Block((place.half_reciprocal,), 1 - reflected.r.e))

    def tangent_plane(self, place: Place) -> Tuple[int, List[int]]:
        """columns.plane (6): 1/(2 m rho), and (s, t)/(2 rho (rho + 1)) as it is pulled off."""
        s, t = place.st
        quarter = self.mantissa((s * s + t * t + (1 << self.ff)) >> 2, self.ff)
        inverse = self.half_inverse_root(quarter)
        total = self.mantissa(quarter * inverse + (1 << (self.ff - 2)), self.ff)
        twice = self.mantissa(inverse * self.half_reciprocal(total), self.ff)
        scale = self.mantissa(place.half_reciprocal * inverse, self.ff)
        return scale, [self.mantissa((x * twice) >> 1, self.ff) for x in place.st]

    def column_on_sphere(self, reflected: Reflected, place: Place, plane: Tuple[int, List[int]],
                         dr: Block) -> Block:
        """columns.sphere (6): the column on the tangent plane of the sphere, in radians."""
        if reflected.r.zero:
            return zero_block(2)
        scale, pull = plane
        across = self.across(place, dr)
        outwards = self.mantissa(dot(place.st, across.m) >> 1, self.ff)
        turned = self.normalise([(m << self.f) - 2 * x * outwards for m, x in zip(across.m, pull)], self.ff, across.e)
        return self.times(turned, Block((scale,), 1 - reflected.r.e))

    # ---- Section 6: ellipse, axes ----

    def pixel_columns(self, columns: Sequence[Block]) -> List[Block]:
        """pixel_columns (6): the first two become standard deviations of a box."""
        sigma = Block((self.box_sigma,), 0)
        return [self.times(q, sigma) for q in columns[:2]] + list(columns[2:])

    def ellipse(self, columns: Sequence[Block]) -> Tuple[Block, Block]:
        """ellipse (6): (a, b, c) of the covariance, and its determinant."""
        q, e = self.align(columns)
        sums = [sum(x[i] * x[j] for x in q) for i, j in ((0, 0), (0, 1), (1, 1))]
        minors = self.normalise([x[0] * y[1] - y[0] * x[1] for k, x in enumerate(q) for y in q[k + 1:]],
                                self.ff, 2 * e)
        return self.normalise(sums, self.ff, 2 * e), self.square_length(minors)

    def less(self, a: Block, b: Block) -> bool:
        """less (6, axes): a < b of numbers >= 0, floored to the larger exponent."""
        top = max(a.e, b.e)
        return floored(a.m[0] << self.f, top - a.e) < floored(b.m[0] << self.f, top - b.e)

    def axes(self, covariance: Block, determinant: Block) -> Axes:
        """axes (6): lambda 1 and 2 and the direction of lambda 1."""
        a, b, c = covariance.m
        double = self.normalise(((a - c) << self.f, b << (self.f + 1)), self.ff, 0)
        h = self.root(self.square_length(double))
        half_h = at_exponent(h.m[0] << self.f, h.e, 2) >> 1
        square = self.number(((a + c) << (self.f - 3)) + half_h, self.ff - 2, covariance.e)
        major, inverse = self.root_and_inverse(square)
        minor = self.times(self.root(determinant), inverse)
        if self.less(major, minor):
            minor = major
        return Axes(major, minor, self.direction(double, h))

    def direction(self, double: Block, h: Block) -> List[int]:
        """direction (6, axes): half the angle of (a - c, 2b)."""
        if double.zero:
            return [self.one, 0]
        x, y = (abs(m) for m in double.m)
        steps = self.profile.direction_steps
        if steps == 0:
            length = at_exponent(h.m[0] << self.f, h.e - double.e, 2)
            sides = self.normalise((length + (x << (self.f - 2)), y << (self.f - 2)), self.ff - 2, 0)
            larger, smaller = (min(m, self.one) for m in self.over_length(sides))
        else:
            entry = 0
            for k in range(1, steps // 2 + 1):
                cosine, sine = self.angle(2 * k - 1, steps)
                if sine * x < cosine * y:
                    entry = k
            larger, smaller = self.angle(entry, steps)
        if double.m[1] < 0:
            smaller = -smaller
        return [larger, smaller] if double.m[0] >= 0 else [smaller, larger]

    # ---- Section 6: map_scale, probes ----

    def map_scale(self, edge: int) -> Tuple[int, int]:
        """map_scale (6): log2 of the texels in half a face, 16 fraction bits, and the last level."""
        edge = clamp(edge, 1, 16384)
        x = self.number(edge, 0, 0)
        return ((x.e - 1) << 16) + (self.log2(x.m[0]) >> 8), edge.bit_length() - 1

    def probe_rule(self, minor: int, threshold: int, more: int) -> Rule:
        """probe_rule (6, probes): the least N with (N - more) * minor >= threshold, or the most there are."""
        if self.profile.power_of_two:
            last = 1 << (self.profile.max_probes.bit_length() - 1)
            counts = [1 << k for k in range(last.bit_length())]
        else:
            last = self.profile.max_probes
            counts = list(range(1, last + 1))
        enough = [count for count in counts if (count - more) * minor >= threshold]
        count = enough[0] if enough else last
        before = 0 if self.profile.power_of_two or count == 1 else (count - 1 - more) * minor
        return Rule(count, not enough, threshold - before)

    def level_of_detail(self, axes: Axes, rule: Rule, log2_diameter: int, log2_texels: int) -> int:
        """level_of_detail (6, probes): of lambda 2, or lambda 1 / N if there are too few; 16 fraction bits."""
        sigma = axes.major if rule.capped else axes.minor
        level = (clamp(sigma.e, -8192, 8192) << 16) + (self.log2(sigma.m[0]) >> 8) + log2_diameter + log2_texels
        return level - LOG2_OF_COUNT[rule.count] if rule.capped else level

    def minor_at_major(self, axes: Axes) -> int:
        """minor_at_major (6, probes): lambda 2 with 2F - 2 fraction bits at the exponent of lambda 1."""
        return floored(axes.minor.m[0] << (self.f - 2), axes.major.e - axes.minor.e)

    def probes(self, axes: Axes, log2_texels: int, last_level: int) -> Tuple[Rule, List[int], int, bool]:
        """probes (6): count, step with 28 fraction bits, level of detail with 16, and whether lambda 1 was cut."""
        major = axes.major
        wide = major.m[0] << (self.f - 2)
        rule = self.probe_rule(self.minor_at_major(axes), wide - (wide >> (self.p - 4)), 0)
        saturated = major.e > 1
        drawn = Block((self.one,), 1) if saturated else major
        length = self.number(self.table_offset(STEP_PER_SIGMA[rule.count]) * drawn.m[0], 2 * self.w - 6, drawn.e)
        both = self.normalise([d * length.m[0] for d in axes.direction], self.ff, length.e)
        step = [rnd(at_exponent(m << self.f, both.e, 3), self.ff - 3 - 28) for m in both.m]
        level = self.level_of_detail(axes, rule, LOG2_DIAMETER, log2_texels)
        spare = 16 - self.profile.lod_bits
        return rule, step, rnd(clamp(level, 0, last_level << 16), spare) << spare, saturated

    def count_and_level(self, axes: Axes, spread: int, log2_texels: int) -> Tuple[Rule, int, int]:
        """probes with footprint-sphere (6): count, share and level, both with 16 fraction bits."""
        low = self.minor_at_major(axes)
        rule = self.probe_rule(low, ((axes.major.m[0] * spread) >> 2) - (low >> 4), 1)
        level = self.level_of_detail(axes, rule, LOG2_TEXEL_ON_SPHERE, log2_texels)
        if self.profile.power_of_two or rule.capped:
            return rule, VISIBLE, level
        beyond = self.number(rule.beyond, self.ff - 2, axes.major.e)
        quotient = beyond.m[0] * self.half_reciprocal(axes.minor.m[0])
        share = at_exponent(quotient, clamp(beyond.e - axes.minor.e, -64, 0) + 2, 2)
        return rule, rnd(clamp(share, 0, 1 << (self.ff - 2)), self.ff - 2 - 16), level

    # ---- Section 6: sweep ----

    def spread_of(self, axes: Axes) -> int:
        """sweep.spread (6): sqrt(1 - (lambda 2 / lambda 1)^2) as a mantissa."""
        major = axes.major.m[0]
        minor = self.shifted(axes.minor.m[0], clamp(axes.major.e - axes.minor.e, 0, self.w - 1))
        root = self.root(self.number(max(major * major - minor * minor, 0), self.ff, 0))
        quotient = at_exponent(root.m[0] * self.half_reciprocal(major), root.e + 1, 2)
        return self.mantissa(clamp(quotient, 0, 1 << (self.ff - 2)), self.ff - 2)

    def shares(self, deviations: Sequence[Block], axes: Axes, spread: int, count: int) -> List[int]:
        """sweep.shares (6): what each column has of the direction of lambda 1."""
        q, _ = self.align(deviations)
        along = self.normalise([dot(x, axes.direction) for x in q], self.ff, 0)
        spread = min(spread, self.table_mantissa(SPREAD_LIMIT[count]))
        w = [self.mantissa(m * spread, self.ff) for m in self.over_length(along)]
        return [self.mantissa(m * self.box_sigma, self.ff) for m in w[:2]] + w[2:]

    def mixed(self, w: Sequence[int], blocks: Sequence[Block]) -> Block:
        """sweep.first, sweep.turn (6): the sum of the blocks by their shares."""
        columns, e = self.align(blocks)
        return self.normalise([sum(k * x[i] for k, x in zip(w, columns)) for i in range(3)], self.ff, e)

    def mean_shift(self, turns: Sequence[Block], v: Block) -> Block:
        """sweep.mean (6): 2Cv - v tr C of the covariance C of the normals."""
        t, e = self.align(self.pixel_columns(turns))
        upper = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
        c = self.normalise([sum(x[i] * x[j] for x in t) for i, j in upper], self.ff, 2 * e)
        entry = {pair: m for pair, m in zip(upper, c.m)}
        trace = sum(entry[i, i] for i in range(3))
        half_trace = self.mantissa((trace << self.f) >> 1, self.ff)
        rows = [[entry[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]
        shift = [dot(row, v.m) - x * half_trace for row, x in zip(rows, v.m)]
        return self.normalise(shift, self.ff, c.e + v.e + 1)

    def combined(self, a: Block, b: Block, sign: int) -> Block:
        """combined (6, sweep): a + b or a - b, aligned and rounded."""
        (x, y), e = self.align([a, b])
        return self.normalise([(i + sign * j) << self.f for i, j in zip(x, y)], self.ff, e)

    def centre_of(self, r: Block, shift: Block, second: Block, axes: Axes) -> Block:
        """sweep.centre (6): r + (mean - second)/(1 + lambda 2 squared)."""
        divisor = self.one_plus(self.square_length(axes.minor))
        damping = Block((self.half_reciprocal(divisor.m[0]),), 1 - divisor.e)
        return self.combined(r, self.times(self.combined(shift, second, -1), damping), 1)

    def sweep(self, r: Block, parts: Sequence[Block], level: int) -> Tuple[List[List[int]], int]:
        """sweep (6): centre, first and second at one exponent, and the level with it."""
        square = self.square_of_mantissas(r)
        length = ((clamp(square.e, -64, 64) << 16) + (self.log2(square.m[0]) >> 8)) >> 1
        aligned, top = self.align(parts)
        return aligned, level + length - (clamp(top - r.e, -8192, 8192) << 16)

    # ---- Section 6: half, highlight ----

    def half(self, light: Block, view: Block) -> Block:
        """half (6): l/|l| + v/|v|."""
        if light.zero or view.zero:
            return zero_block(3)
        inverse = [self.inverse_root(self.square_of_mantissas(d)) for d in (light, view)]
        top = max(x.e for x in inverse)
        total = [sum(floored(d.m[i] * x.m[0], top - x.e) for d, x in zip((light, view), inverse)) for i in range(3)]
        return self.normalise(total, self.ff, top)

    def sum_of_squares(self, parts: Sequence[Block]) -> Block:
        """square_at (6, highlight): squares of parts that were rounded to the largest exponent."""
        q, top = self.align(parts)
        return self.number(sum(dot(m, m) for m in q), self.ff, 2 * top)

    def spread_highlight(self, n: Block, rough: Sequence[Block], root: Block) -> Tuple[List[Block], Block]:
        """highlight.spread (6): the tangents relative to n_mod and 1/sqrt m, and the amplitude 1/sqrt D."""
        inverse = self.inverse_root(self.square_of_mantissas(n))
        scale = self.times(root, inverse).scaled(-n.e)
        q = [self.times(c, scale) for c in rough]
        area = self.normalise(cross(q[0].m, q[1].m), self.ff, q[0].e + q[1].e)
        parts = [self.normalise(cross(n.m, x.m), self.ff, x.e) for x in q]
        parts.append(self.number(dot(n.m, area.m), self.ff, area.e))
        growth = self.times(self.sum_of_squares(parts), self.times(inverse, inverse))
        return q, self.unit if growth.zero else self.inverse_root(self.one_plus(growth))

    def highlight(self, n: Block, modified: Block, light: Block, h: Block, spread: Optional[List[Block]],
                  amplitude: Block, m: Block) -> Tuple[int, bool, bool]:
        """highlight (6): f with 24 fraction bits, light below, half vector below. No spread: a smooth surface."""
        cosine = dot(modified.m, h.m)
        light_below, half_below = dot(n.m, light.m) <= 0, cosine <= 0
        if light_below or half_below:
            return 0, light_below, half_below
        g = self.normalise(cross(modified.m, h.m), self.ff, 0)
        cos = self.number(cosine, self.ff, 0)
        inverse = Block((self.half_reciprocal(cos.m[0]),), 1 - cos.e)
        inverse_square = self.times(inverse, inverse)
        if spread is None:
            x = self.times(self.square_length(g), inverse_square)
        else:
            parts = [g] + [self.number(dot(g.m, c.m), self.ff, g.e + c.e) for c in spread]
            x = self.times(self.sum_of_squares(parts), self.times(inverse_square, self.times(amplitude, amplitude)))
        log = self.log2_one_plus(x)
        e = m.e + log.e - 1
        most = 63 << (self.ff - 8)
        fall = most if e > 8 else clamp(at_exponent(m.m[0] * log.m[0], e, 8), 0, most)
        power = self.exp2(-rnd(fall, self.ff - 8 - 24))
        if spread is None:
            f, e = power.m[0] << self.f, power.e
        else:
            f, e = power.m[0] * amplitude.m[0], power.e + amplitude.e
        return min(rnd(at_exponent(f, e, 2), self.ff - 2 - 24), 1 << 24), False, False

    # ---- Section 6: local, horizon, peaks ----

    def local_components(self, d: Block, frame: Frame, n: Block) -> Block:
        """local.components (6): d along E1, E2 and the mantissas of n."""
        if frame.e1.zero or frame.e2.zero:
            return zero_block(3)
        along = [(dot(d.m, axis.m), e) for axis, e in ((frame.e1, frame.e1.e), (frame.e2, frame.e2.e), (n, 0))]
        along = [(x, e if x else ZERO_E) for x, e in along]
        top = max(e for _, e in along)
        return self.normalise([floored(x, top - e) for x, e in along], self.ff, d.e + top)

    def local_unit(self, local: Block) -> List[int]:
        """local.unit (6)."""
        return [clamp(m, -self.one, self.one) for m in self.over_length(local)]

    def slopes(self, local: Block) -> List[Slope]:
        """horizon.slopes (6): z/|x| and z/|y|, cut to 8."""
        *runs, z = local.m
        rise = self.number(z, self.f, 0)
        limit = 8 << (self.ff - 5)
        out = []
        for along in runs:
            run = self.number(abs(along), self.f, 0)
            e = rise.e - run.e + 1
            if e > 5:
                slope = -limit if z < 0 else limit
            else:
                slope = clamp(at_exponent(rise.m[0] * self.half_reciprocal(run.m[0]), e, 5), -limit, limit)
            slope = rnd(slope, self.ff - 5 - (self.p - 4)) << self.drop
            out.append(Slope(slope, along < 0, along == 0))
        return out

    def ramps(self, slopes: Sequence[Slope], low: Sequence[int], inverse_width: Sequence[int]) -> List[int]:
        """horizon.ramps (6): visible shares of both axes, 16 fraction bits."""
        out = []
        for axis, slope in enumerate(slopes):
            side = 2 * axis + (not slope.negative)
            above = point(slope.slope, self.w - 6, 26) - (low[side] << 14)
            if slope.upright:
                out.append(VISIBLE)
            elif inverse_width[side] == 0:
                out.append(VISIBLE if above >= 0 else 0)
            else:
                integer, e = code_parts(inverse_width[side])
                spare = 26 - max(self.p - 4, 12)
                x = ((rnd(above, spare) << spare) * (integer << 17)) >> (14 - e)
                out.append(rnd(clamp(x, 0, 1 << 43), 27))
        return out

    def peak(self, unit: Sequence[int], none: bool, normal: Sequence[int], amplitude: int, exponent: int,
             weight: int) -> int:
        """peaks (6): the light of one stored peak, 24 fraction bits."""
        limit = 3 << (self.f - 1)
        d = [self.mantissa(clamp(point(n, 15, self.f) - h, -limit, limit), self.f) for n, h in zip(normal, unit)]
        power = self.cosine_power(dot(d, d), self.short_number(exponent))
        a = self.short_number(amplitude).scaled(-8)
        product = point(self.mantissa(power.m[0] * a.m[0], self.ff), self.f, 30)
        return 0 if none else rnd(floored(product * weight, 7 - power.e - a.e), 15)

    # ---- Section 7: datapaths ----

    def surface(self, port: "Ports", effects: Dict[str, Any], bump: bool, roughness: str, local: bool) -> Surface:
        """surface (7): what all datapaths begin with."""
        n, v = self.enter(*port.vector("normal")), self.enter(*port.vector("view"))
        frame = Frame(zero_block(3), zero_block(3), False)
        if bump or local or roughness != "none":
            system = effects["frame"]
            slots = (0,) if system == "main_direction" else (0, 1)
            vectors = [self.enter(*port.vector(f"frame_vectors_{i}")) for i in slots]
            make = {"main_direction": self.main_direction, "natural": self.natural,
                    "natural_normalised": self.natural_normalised}[system]
            frame = make(n, *vectors)
        modified = n
        if bump:
            modified = self.perturb(n, [self.enter_offset(port.mantissa(f"offset_{i}")) for i in (1, 2)], frame)
        rough = [zero_block(3)] * 2
        if roughness == "isotropic":
            rough = self.roughness_isotropic([self.enter_offset(port.mantissa("roughness_1"))], frame)
        elif roughness != "none":
            d = [self.enter_offset(port.mantissa(f"roughness_{i}")) for i in (1, 2, 3)]
            rough = self.roughness_anisotropic(d, frame)
        return Surface(n, v, frame, modified, rough)

    def reflection(self, port: "Ports", effects: Dict[str, Any]) -> Fields:
        """reflection (7)."""
        footprint = effects["footprint"]
        roughness = "none" if footprint == "none" else effects["roughness"]
        surface = self.surface(port, effects, effects["bump"], roughness, False)
        n, v = surface.modified, surface.view
        reflected = self.reflect(n, v)
        place = self.cube_face(reflected.r)
        out = Outcome(self.drop)
        out.frame(surface)
        out.block("normal_mod", n, "xyz")
        out.block("reflected", reflected.r, "xyz")
        out.fields["face"] = place.face
        out.mantissas("st", place.st, "st")
        empty, saturated, capped = True, False, False
        if footprint == "none":
            out.fields.update(probes=1, step_s=0, step_t=0, lod=0)
        else:
            pairs = []
            for side in (0, 1):
                dn = self.enter(*port.vector(f"dnormal_{side}")) if effects["curvature"] else zero_block(3)
                pairs.append((self.enter(*port.vector(f"dview_{side}")), dn))
            if roughness != "none":
                pairs += [(zero_block(3), q.scaled(surface.normal.e)) for q in surface.rough]
            moves = [self.derivative(n, v, reflected, dv, dn) for dv, dn in pairs]
            if footprint == "face":
                columns = [self.column(reflected, place, dr) for dr in moves]
            else:
                plane = self.tangent_plane(place)
                columns = [self.column_on_sphere(reflected, place, plane, dr) for dr in moves]
            deviations = self.pixel_columns(columns)
            covariance, determinant = self.ellipse(deviations)
            axes = self.axes(covariance, determinant)
            for i, column in enumerate(columns):
                out.block(f"columns_{i}", column, "st")
            out.block("covariance", covariance, "abc")
            out.block("determinant", determinant, "m")
            out.block("major", axes.major, "m")
            out.block("minor", axes.minor, "m")
            out.mantissas("direction", axes.direction, "st")
            empty = axes.major.zero
            log2_texels, last_level = self.map_scale(port["edge_texels"])
            if footprint == "face":
                rule, step, level, saturated = self.probes(axes, log2_texels, last_level)
                out.fields.update(step_s=step[0], step_t=step[1], lod=level >> (16 - self.profile.lod_bits))
            else:
                spread = self.spread_of(axes)
                rule, share, level = self.count_and_level(axes, spread, log2_texels)
                w = self.shares(deviations, axes, spread, rule.count)
                turns = [dn for _, dn in pairs]
                second = self.reflect(self.mixed(w, turns), v).r
                centre = self.centre_of(reflected.r, self.mean_shift(turns, v), second, axes)
                vectors, level = self.sweep(reflected.r, [centre, self.mixed(w, moves), second], level)
                for i, vector in enumerate(vectors):
                    out.mantissas(f"sweep_{i}", vector, "012")
                out.fields.update(share=share, level=level)
            capped = rule.capped
            out.fields["probes"] = rule.count
        out.status(surface, {8: reflected.below, 16: place.tie, 32: empty, 64: saturated, 128: capped})
        return out.fields

    def highlight_datapath(self, port: "Ports", effects: Dict[str, Any]) -> Fields:
        """highlight_datapath (7)."""
        surface = self.surface(port, effects, effects["bump"], effects["roughness"], False)
        rough = [q.scaled(surface.normal.e) for q in surface.rough]
        light = self.enter(*port.vector("light"))
        half = self.half(light, surface.view)
        m, root = self.enter_shininess(port["shininess_exponent"], port.optional("shininess_root"))
        spread: Optional[List[Block]] = None
        amplitude = self.unit
        if effects["roughness"] != "none":
            spread, amplitude = self.spread_highlight(surface.modified, rough, root)
        f, light_below, half_below = self.highlight(surface.normal, surface.modified, light, half, spread, amplitude, m)
        out = Outcome(self.drop)
        out.frame(surface)
        out.block("normal_mod", surface.modified, "xyz")
        out.block("half", half, "xyz")
        for i, q in enumerate(rough):
            out.block(f"rough_{i + 1}", q, "xyz")
        for i, q in enumerate(spread or []):
            out.block(f"spread_{i + 1}", q, "xyz")
        out.block("amplitude", amplitude, "m")
        out.fields["f"] = f
        out.status(surface, {256: light.zero, 512: half.zero, 1024: light_below, 2048: half_below})
        return out.fields

    def peak_datapath(self, port: "Ports", effects: Dict[str, Any]) -> Fields:
        """peak_datapath (7)."""
        surface = self.surface(port, effects, False, "none", True)
        light = self.enter(*port.vector("light"))
        half = self.half(light, surface.view)
        local_half, local_light, local_eye = (self.local_components(d, surface.frame, surface.normal)
                                              for d in (half, light, surface.view))
        unit = self.local_unit(local_half)
        below = local_light.m[2] <= 0
        out = Outcome(self.drop)
        out.frame(surface)
        out.block("half", half, "xyz")
        out.mantissas("local_half", unit, "xyz")
        out.block("local_light", local_light, "xyz")
        visibility = VISIBLE
        if effects["horizon"] != "none":
            both = [self.slopes(local_light), self.slopes(local_eye)]
            low, inverse_width = port.numbers("horizon_low", "0123"), port.numbers("horizon_inverse_width", "0123")
            lit, seen = (self.ramps(slopes, low, inverse_width) for slopes in both)
            visibility = (independent if effects["horizon"] == "product" else correlated)(lit, seen)
            out.block("local_eye", local_eye, "xyz")
            for i, slopes in enumerate(both):
                out.mantissas(f"slopes_{i}", [slope.slope for slope in slopes], "01")
        weight = 0 if below else share_product(clamp(port["weight"], 0, VISIBLE), visibility)
        light_of_peak = self.peak(unit, local_half.zero, port.numbers("peak_normal", "xyz"), port["peak_amplitude"],
                                  port["peak_exponent"], weight)
        last = (64 << 24) - 1
        out.fields["visibility"] = visibility
        out.fields["peak"] = min(light_of_peak, last)
        out.status(surface, {256: light.zero, 512: half.zero, 1024: below, 4096: local_half.zero,
                             8192: light_of_peak > last})
        return out.fields


def share_product(a: int, b: int) -> int:
    """share_product (6, horizon): of shares with 16 fraction bits."""
    return rnd(a * b, 16)


def correlated(lit: Sequence[int], seen: Sequence[int]) -> int:
    """horizon.correlated (6): a - a(1 - b)/4 of the two smallest cleared shares, 1 - (1 - t)^2 of a ramp t."""
    low, high = sorted([*lit, *seen])[:2]
    lost, lost_next = (VISIBLE - low) ** 2, (VISIBLE - high) ** 2           # 32 fraction bits
    taken = ((VISIBLE - rnd(lost, 16)) * rnd(lost_next, 16)) >> 2
    return rnd(clamp((1 << 32) - lost - taken, 0, 1 << 32), 16)


def independent(lit: Sequence[int], seen: Sequence[int]) -> int:
    """horizon.product (6): all four multiplied."""
    return share_product(share_product(lit[0], lit[1]), share_product(seen[0], seen[1]))


class Ports:
    """Inputs of a vector in the form of section 2, by the names of their fields."""

    def __init__(self, inputs: Fields, drop: int) -> None:
        self.inputs = inputs
        self.drop = drop

    def __getitem__(self, name: str) -> int:
        return self.inputs[name]

    def optional(self, name: str) -> int:
        """A number that nothing reads under some effects: 0 where a set has no field for it."""
        return self.inputs.get(name, 0)

    def mantissa(self, name: str) -> int:
        """A mantissa, an offset or a roughness: with its low zero_block."""
        return self.inputs[name] << self.drop

    def vector(self, name: str) -> Tuple[List[int], int]:
        """Mantissas and exponent; 0 where a set has no field for it."""
        return [self.mantissa(f"{name}_{axis}") for axis in "xyz"], self.optional(name + "_e")

    def numbers(self, name: str, places: str) -> List[int]:
        """An array of plain numbers."""
        return [self.inputs[f"{name}_{place}"] for place in places]


class Outcome:
    """Collects taps and outcomes as fields of a set."""

    def __init__(self, drop: int) -> None:
        self.drop = drop
        self.fields: Fields = {}

    def mantissas(self, name: str, values: Sequence[int], places: str) -> None:
        """Mantissas or slopes: without their low zero_block."""
        for place, value in zip(places, values):
            self.fields[f"{name}_{place}"] = value >> self.drop

    def block(self, name: str, block: Block, places: str) -> None:
        """A block as a port (6, leave)."""
        block = leave(block)
        self.mantissas(name, block.m, places)
        self.fields[name + "_e"] = block.e

    def frame(self, surface: Surface) -> None:
        """Both tangents, with the exponent of n."""
        for i, tangent in enumerate((surface.frame.e1, surface.frame.e2)):
            self.block(f"frame_{i}", tangent.scaled(surface.normal.e), "xyz")

    def status(self, surface: Surface, raised: Dict[int, bool]) -> None:
        """status (6): the bits of all datapaths and the given ones."""
        common = {1: surface.normal.zero, 2: surface.view.zero, 4: surface.frame.pole}
        self.fields["status"] = sum(bit for bit, on in {**common, **raised}.items() if on)


@functools.lru_cache(maxsize=None)
def datapath_of(profile: Profile) -> Datapath:
    """The datapath of a profile, made once."""
    return Datapath(profile)


class StagePorts:
    """The ports of one stage (FORMAT, sets of one stage) by their names without formats, in the form of section 2."""

    def __init__(self, path: Datapath, manifest: Manifest, inputs: Fields) -> None:
        self.path = path
        self.effects: Dict[str, Any] = manifest["effects"]
        self.wires: Dict[str, Tuple[int, int]] = {}             # integer and fraction bits
        for field in manifest["fields"]:
            if field["direction"] == "in":
                self.wires[plain_name(field["name"])] = (inputs[field["name"]], field["fraction_bits"])
        self.outcomes: Dict[str, Tuple[int, int]] = {}

    def integers(self, name: str, fraction: int) -> List[int]:
        """An array: name_0, name_1, ..., with so many fraction bits."""
        wires = []
        while f"{name}_{len(wires)}" in self.wires:
            x, f = self.wires[f"{name}_{len(wires)}"]
            wires.append(x << (fraction - f))
        return wires

    def block(self, name: str, mantissas: str = "_m", exponent: str = "_e") -> Block:
        """A block; 0 is the exponent of one whose length does not count."""
        m = self.integers(name + mantissas, self.path.f)
        if not m:
            raise KeyError(name)
        return Block(tuple(m), self.wires.get(name + exponent, (0, 0))[0])

    def blocks(self) -> List[Block]:
        """All blocks in the order of the ports."""
        return [self.block(name[:-len("_m_0")]) for name in self.wires if name.endswith("_m_0")]

    def out(self, name: str, values: Sequence[int], fraction: int) -> None:
        """Outcomes name_0, name_1, ..."""
        self.outcomes.update({f"{name}_{i}": (value, fraction) for i, value in enumerate(values)})

    def out_block(self, name: str, block: Block) -> None:
        """A block; without a name where it is all that the stage makes."""
        prefix = name + "_" if name else ""
        self.out(prefix + "m", block.m, self.path.f)
        self.outcomes[prefix + "e"] = (block.e, 0)

    def out_flag(self, name: str, flag: bool) -> None:
        """A flag."""
        self.outcomes[name] = (int(flag), 0)


def plain_name(port: str) -> str:
    """A port of a module without its format: `r_m_0` of `r_m_0_i2f20`."""
    return re.sub(r"_(flag|[iu]n?[0-9]+fn?[0-9]+)$", "", port)


def stage_enter(path: Datapath, port: StagePorts) -> None:
    """enter of a vector (6)."""
    name = next(name for name in port.wires if name.endswith("_mantissa_0"))[:-len("_mantissa_0")]
    block = port.block(name, "_mantissa", "_exponent")
    port.out_block("", path.enter(block.m, block.e))


def stage_enter_offset(path: Datapath, port: StagePorts) -> None:
    """enter.offset, enter.roughness (6)."""
    name = next(iter(port.wires))[:-len("_0")]
    entered = [path.enter_offset(x) for x in port.integers(name, path.w - 4)]
    port.out(name[len("surface_"):], entered, path.w - 4)


def stage_frame(path: Datapath, port: StagePorts) -> None:
    """frame (6) of n and one or two frame vectors."""
    system = {"main_direction": path.main_direction, "natural": path.natural,
              "natural_normalised": path.natural_normalised}[port.effects["frame"]]
    frame = system(*port.blocks())
    port.out_block("e1", frame.e1)
    port.out_block("e2", frame.e2)
    port.out_flag("pole", frame.pole)


def stage_perturb(path: Datapath, port: StagePorts) -> None:
    """perturb (6)."""
    n, e1, e2 = port.blocks()
    port.out_block("", path.perturb(n, port.integers("enter_offset", path.w - 4), Frame(e1, e2, False)))


def stage_roughness(path: Datapath, port: StagePorts) -> None:
    """roughness (6)."""
    frame = Frame(port.block("frame_e1"), port.block("frame_e2"), False)
    run = path.roughness_isotropic if port.effects["roughness"] == "isotropic" else path.roughness_anisotropic
    for i, tangent in enumerate(run(port.integers("enter_roughness", path.w - 4), frame)):
        port.out_block(f"roughness_{i}", tangent)


def stage_reflect(path: Datapath, port: StagePorts) -> None:
    """reflect (6); the normal is modified or as it entered."""
    modified = "perturb" if "perturb_m_0" in port.wires else "enter_normal"
    reflected = path.reflect(port.block(modified), port.block("enter_view"))
    port.out_block("r", reflected.r)
    port.out_block("scalars", reflected.scalars)
    port.out_flag("below", reflected.below)


def stage_cube_face(path: Datapath, port: StagePorts) -> None:
    """cube_face (6); the face is its axis, then its sign."""
    place = path.cube_face(port.block("reflect_r"))
    port.out_flag("select_is_z", place.face >= 4)
    port.out_flag("select_is_y", place.face in (2, 3))
    port.out_flag("select_negative", place.face % 2 == 1)
    port.out("st", place.st, path.f)
    port.outcomes["half_reciprocal"] = (place.half_reciprocal, path.f)
    port.out_flag("tie", place.tie)


def stage_axes(path: Datapath, port: StagePorts) -> None:
    """axes (6)."""
    axes = path.axes(*port.blocks())
    port.out_block("major", axes.major)
    port.out_block("minor", axes.minor)
    port.out("direction", axes.direction, path.f)


def stage_map_scale(path: Datapath, port: StagePorts) -> None:
    """map_scale (6)."""
    log2_texels, last_level = path.map_scale(port.wires["edge_texels"][0])
    port.outcomes.update(log2_texels=(log2_texels, 16), last_level=(last_level, 0))


def stage_half(path: Datapath, port: StagePorts) -> None:
    """half (6)."""
    port.out_block("", path.half(port.block("enter_light"), port.block("enter_view")))


def stage_probes(path: Datapath, port: StagePorts) -> None:
    """probes (6) in the plane of a face, or on the sphere."""
    on_sphere = port.effects["footprint"] == "sphere"
    direction = [] if on_sphere else port.integers("axes_direction", path.f)
    axes = Axes(port.block("axes_major"), port.block("axes_minor"), direction)
    log2_texels = port.wires["map_scale_log2_texels"][0]
    if on_sphere:
        spread, f = port.wires["sweep_spread"]
        rule, share, level = path.count_and_level(axes, spread << (path.f - f), log2_texels)
        port.outcomes.update(share=(share, 16), level=(level, 16))
    else:
        rule, step, level, saturated = path.probes(axes, log2_texels, port.wires["map_scale_last_level"][0])
        port.out("step", step, 28)
        port.outcomes["lod"] = (level, 16)
        port.out_flag("saturated", saturated)
    port.outcomes["count"] = (rule.count, 0)
    port.out_flag("empty", axes.major.zero)
    port.out_flag("capped", rule.capped)


def stage_spread(path: Datapath, port: StagePorts) -> None:
    """highlight.spread (6); the normal is modified or as it entered."""
    normal = port.block("perturb" if "perturb_m_0" in port.wires else "enter_normal")
    rough = [port.block(f"roughness_{i}").scaled(port.wires["enter_normal_e"][0]) for i in range(2)]
    tangents, amplitude = path.spread_highlight(normal, rough, port.block("enter_shininess_root"))
    for i, tangent in enumerate(tangents):
        port.out_block(f"rough_{i}", tangent)
    port.out_block("amplitude", amplitude)
    port.out_block("reciprocal", path.times(amplitude, amplitude))


def stage_highlight(path: Datapath, port: StagePorts) -> None:
    """highlight (6), of a rough or of a smooth surface."""
    normal = port.block("enter_normal")
    modified = port.block("perturb") if "perturb_m_0" in port.wires else normal
    spread, amplitude = None, path.unit
    if "highlight_spread_rough_0_m_0" in port.wires:
        spread = [port.block(f"highlight_spread_rough_{i}") for i in range(2)]
        amplitude = port.block("highlight_spread_amplitude")
    f, light_below, half_below = path.highlight(normal, modified, port.block("enter_light"), port.block("half"), spread,
                                                amplitude, port.block("enter_shininess_exponent"))
    port.outcomes["f"] = (f, 24)
    port.out_flag("light_below", light_below)
    port.out_flag("half_below", half_below)


def stage_local_unit(path: Datapath, port: StagePorts) -> None:
    """local.unit (6)."""
    local = port.block("local_components")
    port.out("unit", path.local_unit(local), path.f)
    port.out_flag("none", local.zero)


def stage_slopes(path: Datapath, port: StagePorts) -> None:
    """horizon.slopes (6)."""
    for i, slope in enumerate(path.slopes(port.block("local_components"))):
        port.outcomes[f"slopes_{i}_slope"] = (slope.slope, path.w - 6)
        port.out_flag(f"slopes_{i}_negative", slope.negative)
        port.out_flag(f"slopes_{i}_upright", slope.upright)


def stage_peak(path: Datapath, port: StagePorts) -> None:
    """peaks (6): one stored peak."""
    unit, none = port.integers("local_unit_unit", path.f), port.wires["local_unit_none"][0] == 1
    amplitude, exponent, weight = (port.wires[name][0] for name in ("peak_amplitude", "peak_exponent", "peaks_weight"))
    peak = path.peak(unit, none, port.integers("peak_normal", 15), amplitude, exponent, weight)
    port.outcomes["peak"] = (peak, 24)


# By the names of modules.
ALONE: Dict[str, Callable[[Datapath, StagePorts], None]] = {
    **{f"enter_{name}": stage_enter for name in ("normal", "view", "tangent", "dview", "dnormal", "light")},
    "enter_offset": stage_enter_offset, "enter_roughness": stage_enter_offset, "frame": stage_frame,
    "perturb": stage_perturb, "roughness": stage_roughness, "reflect": stage_reflect, "cube_face": stage_cube_face,
    "axes": stage_axes, "map_scale": stage_map_scale, "probes": stage_probes, "half": stage_half,
    "highlight_spread": stage_spread, "highlight": stage_highlight, "local_unit": stage_local_unit,
    "horizon_slopes": stage_slopes, "peaks_peak": stage_peak}


def evaluate_stage(path: Datapath, manifest: Manifest, inputs: Fields) -> Fields:
    """The outcomes of one stage of `ALONE`. Raises KeyError where the model does not compute the stage alone."""
    port = StagePorts(path, manifest, inputs)
    ALONE[manifest["stage"]["module"]](path, port)
    fields: Fields = {}
    for field in manifest["fields"]:
        if field["direction"] == "out":
            value, fraction = port.outcomes[plain_name(field["name"])]
            fields[field["name"]] = value >> (fraction - field["fraction_bits"])
    return fields


def evaluate(manifest: Manifest, inputs: Fields) -> Fields:
    """All taps and outcomes of a vector, as integers of their fields. `inputs` may have more fields than inputs."""
    path = datapath_of(Profile.from_knobs(manifest["profile"]["knobs"]))
    if "stage" in manifest:
        return evaluate_stage(path, manifest, inputs)
    run = {"reflection": path.reflection, "highlight": path.highlight_datapath, "peak": path.peak_datapath}
    return run[manifest["datapath"]](Ports(inputs, path.drop), manifest["effects"])


# --------------------------------------------------------------------------------------------------------------------
# FORMAT.md: reading of sets
# --------------------------------------------------------------------------------------------------------------------

class Unreadable(Exception):
    """A set that cannot be read; says which file and line."""


def crc_table() -> List[int]:
    table = []
    for byte in range(256):
        crc = byte << 24
        for _ in range(8):
            crc = ((crc << 1) ^ (0x04c11db7 if crc >> 31 else 0)) & 0xffffffff
        table.append(crc)
    return table


CRC_TABLE = crc_table()


def check_value(data: int, bits: int) -> int:
    """CRC-32 (FORMAT, check value) of `bits` bits, a multiple of 4, most significant first."""
    crc = 0xffffffff
    if bits % 8:
        bits -= 4
        crc ^= (data >> bits) << 28
        for _ in range(4):
            crc = ((crc << 1) ^ (0x04c11db7 if crc >> 31 else 0)) & 0xffffffff
        data &= (1 << bits) - 1
    for byte in data.to_bytes(bits // 8, "big"):
        crc = ((crc << 8) & 0xffffffff) ^ CRC_TABLE[(crc >> 24) ^ byte]
    return crc


def read_manifest(path: str) -> Manifest:
    """NAME.json, with what a reader needs checked."""
    try:
        with open(path, encoding="utf-8") as file:
            manifest = json.load(file)
    except (OSError, ValueError) as error:
        raise Unreadable(f"{path}: {error}") from error
    try:
        if (manifest["schema"], manifest["format_version"]) != ("roughxel-vectors", 3):
            raise Unreadable(f"{path}: not a set of roughxel-vectors, format 3")
        Profile.from_knobs(manifest["profile"]["knobs"])
        if manifest["datapath"] not in ("reflection", "highlight", "peak"):
            raise Unreadable(f"{path}: unknown datapath {manifest['datapath']!r}")
        if "stage" in manifest and not isinstance(manifest["stage"]["module"], str):
            raise Unreadable(f"{path}: the stage has no module")
        end = manifest["word_bits"]
        for field in manifest["fields"]:
            end -= -(-field["width"] // 4) * 4
            if field["lsb"] != end:
                raise Unreadable(f"{path}: field {field['name']} is at {field['lsb']} instead of {end}")
        if end != 0 or manifest["fields"][-1]["name"] != "check":
            raise Unreadable(f"{path}: the fields do not fill a word of {manifest['word_bits']} bits")
        if len(manifest["files"]) != 1 or not isinstance(manifest["count"], int):
            raise Unreadable(f"{path}: one file and a count are expected")
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise Unreadable(f"{path}: manifest is incomplete: {error!r}") from error
    return manifest


def read_words(path: str, digits: int) -> Iterator[Tuple[str, int]]:
    """Words of a file with their places in it: lines of NAME.hex, records of NAME.bin. Raises Unreadable."""
    if path.endswith(".bin"):
        size = -(-digits // 2)
        with open(path, "rb") as file:
            for place, record in enumerate(iter(lambda: file.read(size), b""), 1):
                if len(record) != size or int.from_bytes(record, "big") >> 4 * digits:
                    raise Unreadable(f"{path}:{place}: not a record of {digits} digits in {size} bytes")
                yield f"{path}:{place}", int.from_bytes(record, "big")
        return
    with open(path, encoding="ascii", newline="\n") as file:
        for place, line in enumerate(file, 1):
            text = line.rstrip("\n")
            if text.startswith("//"):
                continue
            hexadecimal = text.replace("_", "")
            if len(hexadecimal) != digits or hexadecimal.strip("0123456789abcdef"):
                raise Unreadable(f"{path}:{place}: not a word of {digits} hex digits")
            yield f"{path}:{place}", int(hexadecimal, 16)


def first_index(manifest: Dict[str, Any]) -> int:
    """Index of a file's first vector: a part of a set has those of the whole one."""
    return manifest.get("part", {}).get("first", 0)


def load(path: str) -> Iterator[Fields]:
    """Vectors of NAME.json as dictionaries of all fields, signed ones as such. Raises Unreadable."""
    manifest = read_manifest(path)
    words_path = os.path.join(os.path.dirname(path), manifest["files"][0]["name"])
    layout = [(field["name"], field["lsb"], field["width"], field["signed"]) for field in manifest["fields"]]
    padding = sum(((1 << -(-width // 4) * 4) - (1 << width)) << lsb for _, lsb, width, _ in layout)
    count = 0
    try:
        for place, word in read_words(words_path, manifest["word_bits"] // 4):
            if check_value(word >> 32, manifest["word_bits"] - 32) != word & 0xffffffff:
                raise Unreadable(f"{place}: check value of vector {first_index(manifest) + count} is wrong: damaged word")
            if word & padding:
                raise Unreadable(f"{place}: a field of vector {first_index(manifest) + count} has bits above its width")
            vector = {}
            for name, lsb, width, signed in layout:
                value = (word >> lsb) & ((1 << width) - 1)
                vector[name] = value - (1 << width) if signed and value >> (width - 1) else value
            count += 1
            if count > manifest["count"]:
                raise Unreadable(f"{place}: more than the {manifest['count']} words of the manifest")
            yield vector
    except (OSError, UnicodeError) as error:
        raise Unreadable(f"{words_path}: {error}") from error
    if count != manifest["count"]:
        raise Unreadable(f"{words_path}: {count} words instead of {manifest['count']}")


# --------------------------------------------------------------------------------------------------------------------
# FORMAT.md: random inputs of a reflection
# --------------------------------------------------------------------------------------------------------------------

SEED_RULE = "splitmix64(fnv1a64(name) xor index * 9e3779b97f4a7c15), inputs 2"
GAMMA = 0x9E3779B97F4A7C15
BITS_64 = (1 << 64) - 1


def mixed(state: int) -> int:
    """A number of SplitMix64 from its state."""
    z = state & BITS_64
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & BITS_64
    z = (z ^ z >> 27) * 0x94D049BB133111EB & BITS_64
    return z ^ z >> 31


def numbers_of(name: str, index: int) -> Callable[[int], int]:
    """The numbers of a vector, by their places."""
    of_name = 0xCBF29CE484222325
    for byte in name.encode():
        of_name = (of_name ^ byte) * 0x100000001B3 & BITS_64
    seed = mixed((of_name ^ index * GAMMA & BITS_64) + GAMMA)
    return lambda place: mixed(seed + (place + 1) * GAMMA)


def below(number: int, quarter: int, bound: int) -> int:
    """An integer below `bound` from a quarter of a number, the highest first."""
    return (number >> (48 - 16 * quarter) & 0xffff) * bound >> 16


def upper_bits(word: int, bits: int) -> int:
    """The upper bits of a word of 32 bits, as a signed integer."""
    word &= 0xffffffff
    return (word - (word >> 31 << 32)) >> (32 - bits)


def odd_word(number: int, bits: int) -> int:
    """A word of `bits` bits, with weight on the corners."""
    one = 1 << ((number >> 32 & 0xffff) * (bits - 1) >> 16)
    corners = [0, one, -one, one - 1, -(1 << (bits - 1))]
    kind = number >> 61
    return corners[kind] if kind < len(corners) else upper_bits(number, bits)


def odd_exponent(number: int) -> int:
    """An exponent with weight on 0, some far from it."""
    kind = below(number, 0, 6)
    return 0 if kind == 0 else below(number, 1, 119) - 59 if kind == 1 else below(number, 2, 15) - 11


def random_reflection(name: str, index: int, profile: Profile) -> Fields:
    """The inputs of vector `index` of a random set of reflections, as integers of their fields; those that a set has no field of, too."""
    number = numbers_of(name, index)
    vectors = ["normal", "view", "frame_vectors_0", "frame_vectors_1", "dview_0", "dview_1", "dnormal_0", "dnormal_1"]
    bits, bump_bits = profile.fraction_bits + 1, profile.fraction_bits + 2
    if below(number(0), 0, 10) == 0:
        mantissas = [odd_word(number(1 + i), bits) for i in range(24)]
        b1, b2, d1, d2, d3 = (odd_word(number(25 + i), bump_bits) for i in range(5))
        most = (1 << (bump_bits - 1)) - 1
        d1, d3 = min(abs(d1), most), min(abs(d3), most)
        exponents = [odd_exponent(number(30 + i)) for i in range(8)]
        edge = 1 << below(number(38), 0, 15)
    else:
        first, second = number(1), number(2)
        normal, view = below(first, 0, 7) - 3, below(first, 1, 13) - 6
        shift, turn = view + below(first, 2, 9) - 12, normal + below(first, 3, 10) - 14
        exponents = [normal, view, 0, 0, shift, shift, turn, turn]
        rough = below(second, 0, 8)
        edge = 16 << below(second, 1, 8)
        words = [number(3 + i // 2) >> (32 - i % 2 * 32) & 0xffffffff for i in range(30)]
        mantissas = [upper_bits(word, bits) for word in words[:24]]
        b1, b2, d1, d2, d3 = words[24:29]
        b1, b2, d2 = upper_bits(b1, bump_bits - 4), upper_bits(b2, bump_bits - 4), upper_bits(d2, bump_bits - 4 - rough)
        d1, d3 = (d >> (32 + 5 + rough - bump_bits) for d in (d1, d3))
    fields = {"offset_1": b1, "offset_2": b2, "roughness_1": d1, "roughness_2": d2, "roughness_3": d3, "edge_texels": edge}
    for place, (vector, exponent) in enumerate(zip(vectors, exponents)):
        fields.update(zip((f"{vector}_{axis}" for axis in "xyz"), mantissas[3 * place:]))
        fields[f"{vector}_e"] = exponent
    return fields


def random_inputs(manifest: Manifest, index: int) -> Fields:
    """The inputs that follow from a set's seed; of other sets, and of seeds that the model does not know, none."""
    seed = manifest["seed"]
    if "stage" in manifest or manifest["datapath"] != "reflection" or seed is None or seed["rule"] != SEED_RULE:
        return {}
    return random_reflection(seed["name"], index, Profile.from_knobs(manifest["profile"]["knobs"]))


# --------------------------------------------------------------------------------------------------------------------
# Command line
# --------------------------------------------------------------------------------------------------------------------

STAGES = ["input", "frame", "perturb", "roughness", "reflect", "cube_face", "columns", "ellipse", "axes", "probes",
          "sweep", "half", "highlight", "local", "horizon", "peaks", "status"]       # pipeline order


class Mismatch(NamedTuple):
    """The first wrong field of a stage."""
    stage: int
    index: int
    field: Dict[str, Any]
    expected: int
    got: Optional[int]


def shown(value: Optional[int], field: Dict[str, Any]) -> str:
    """A field in hex and as a real number."""
    if value is None:
        return "nothing"
    digits = -(-field["width"] // 4)
    pattern = value & ((1 << field["width"]) - 1)
    return f"{pattern:0{digits}x} ({value / 2 ** field['fraction_bits']:.10g})"


def compare(path: str, stop: Optional[int]) -> Tuple[int, int, Optional[Mismatch]]:
    """Vectors seen, wrong ones, and the first mismatch of the first wrong stage. Ends after `stop` wrong vectors."""
    manifest = read_manifest(path)
    checked = [(STAGES.index(field["stage"]) if field["stage"] in STAGES else len(STAGES), field)
               for field in manifest["fields"] if field["direction"] in ("in", "tap", "out")]
    checked.sort(key=lambda pair: pair[0])
    inputs = [field["name"] for field in manifest["fields"] if field["direction"] == "in"]
    count, wrong = 0, 0
    first: Optional[Mismatch] = None
    for index, vector in enumerate(load(path), first_index(manifest)):
        count += 1
        try:
            got = evaluate(manifest, vector)
        except KeyError as error:
            raise Unreadable(f"{path}: an input has no field: {error}") from error
        # Inputs without a seed are taken as they are.
        got.update(random_inputs(manifest, index) or {name: vector[name] for name in inputs})
        for stage, field in checked:
            name = field["name"]
            if got.get(name) != vector[name]:
                wrong += 1
                if first is None or stage < first.stage:
                    first = Mismatch(stage, index, field, vector[name], got.get(name))
                break
        if stop is not None and wrong >= stop:
            break
    return count, wrong, first


def manifests_in(paths: Sequence[str]) -> List[str]:
    """Manifests that the arguments name; folders are not searched below."""
    out = []
    for path in paths:
        if os.path.isdir(path):
            found = sorted(name for name in os.listdir(path) if name.endswith(".json"))
            if not found:
                raise Unreadable(f"{path}: no manifest (NAME.json) in this folder")
            out += [os.path.join(path, name) for name in found]
        else:
            out.append(path)
    return out


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """The program; its exit code."""
    here = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description="Checks golden vectors with a bit-exact model of the datapaths.",
                                     epilog="Exit code: 0 all right, 3 something differs, 1 something is unreadable, 4 nothing "
                                            "differs, but there are sets of stages that are read and not computed.")
    smoke = os.path.join(here, "smoke")
    parser.add_argument("sets", nargs="*", metavar="DIR_OR_JSON", default=[smoke, os.path.join(smoke, "stages")],
                        help="folders of sets, or manifests (NAME.json); without, those of `smoke` and `smoke/stages`")
    parser.add_argument("--stop", type=int, metavar="N", help="leave a set after N wrong vectors")
    parser.add_argument("--rom", metavar="DIR", default=os.path.join(here, "rom"),
                        help="folder of the tables that are checked first; without, `rom` beside this file")
    options = parser.parse_args(arguments)
    different, unreadable, left = False, False, False
    try:
        wrong = wrong_tables(options.rom)
        paths = manifests_in(options.sets)
    except (OSError, UnicodeError, Unreadable) as error:
        print(error, file=sys.stderr)
        return 1
    for path in wrong:
        different = True
        print(f"{path}: differs from its formula")
    if not wrong:
        print(f"{options.rom}: {len(tables())} tables, all right")
    for path in paths:
        name = os.path.splitext(os.path.basename(path))[0]
        try:
            stage = read_manifest(path).get("stage", {}).get("module")
            if stage is not None and stage not in ALONE:
                left = True
                print(f"{name}: {sum(1 for _ in load(path))} vectors of stage {stage}, read; the model does not compute it alone")
                continue
            count, wrong, first = compare(path, options.stop)
        except Unreadable as error:
            unreadable = True
            print(f"{name}: {error}", file=sys.stderr)
            continue
        if first is None:
            print(f"{name}: {count} vectors, all right")
        else:
            different = True
            print(f"{name}: {wrong} of {count} vectors wrong; stage {first.field['stage']}, vector {first.index}, "
                  f"{first.field['name']}: expected {shown(first.expected, first.field)}, "
                  f"got {shown(first.got, first.field)}")
    return 1 if unreadable else 3 if different else 4 if left else 0


if __name__ == "__main__":
    sys.exit(main())
