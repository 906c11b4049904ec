"""Vector sets for a test bench: a packed integer a vector, a dictionary of its fields, the comparison of outputs.

Python 3.8 or newer, its standard library alone.

    vectors = roughxel_vectors.VectorSet("set.json", "words.hex")
    vectors[7]["normal_x"]           # the integer of the field
    vectors.inputs(7)                # the inputs as one integer, first field most significant
    vectors.differences(7, got)      # a line a field that differs
    vectors.with_outputs(7, got)     # the word with these outputs, for `roughxel vectors check`
"""
import hashlib
import json

# Of four bits, for the check value: CRC-32, polynomial 04c11db7, most significant bit first.
_REMAINDERS = []
for _digit in range(16):
    _remainder = _digit << 28
    for _ in range(4):
        _remainder = (_remainder << 1 ^ (0x04C11DB7 if _remainder >> 31 else 0)) & 0xFFFFFFFF
    _REMAINDERS.append(_remainder)


class DamagedSet(Exception):
    """The words are not those that the manifest was written for."""


class Field:
    """A field of a word: `name`, `direction`, `stage`, `lsb`, `width`, `signed`, `fraction_bits` as in the manifest."""

    def __init__(self, entry):
        for key, value in entry.items():
            setattr(self, key, value)

    def bits(self, word):
        """Its bits in a word."""
        return word >> self.lsb & ((1 << self.width) - 1)

    def integer(self, bits):
        """The integer of its bits."""
        return bits - (1 << self.width) if self.signed and bits >> (self.width - 1) else bits

    def number(self, bits):
        """The real number of its bits: the integer over 2^fraction_bits; beside an exponent the mantissa alone."""
        return self.integer(bits) / 2 ** self.fraction_bits

    def text(self, bits):
        """Its bits in hex and as a number."""
        return f"{bits:0{-(-self.width // 4)}x} = {self.number(bits):.10g}"


class VectorSet:
    """A set of vectors, read and checked whole.

    `outputs` are the names of the outputs in the order of the bench's packed structure; without it they stand in the word's
    order. Raises DamagedSet where the file's SHA-256 or a word's check value is another than the set was written with.
    """

    def __init__(self, manifest, words, outputs=None):
        with open(manifest, encoding="utf-8") as file:
            self.manifest = json.load(file)
        if (self.manifest["schema"], self.manifest["format_version"]) != ("roughxel-vectors", 3):
            raise DamagedSet(f"{manifest}: not a vector set of format 3")
        self.name = f"{self.manifest['set']}_{self.manifest['profile']['name']}"
        fields = [Field(entry) for entry in self.manifest["fields"]]
        self.fields = {field.name: field for field in fields if field.direction != "check"}
        self.input_fields = [field for field in fields if field.direction == "in"]
        self.output_fields = [field for field in fields if field.direction in ("tap", "out")]
        if outputs is not None:
            self.output_fields = [self.fields[name] for name in outputs]
        self.input_bits = sum(field.width for field in self.input_fields)
        self.output_bits = sum(field.width for field in self.output_fields)
        with open(words, "rb") as file:
            text = file.read()
        entry = next(file for file in self.manifest["files"] if file["name"].endswith(".hex"))
        if hashlib.sha256(text).hexdigest() != entry["sha256"]:
            raise DamagedSet(f"{words}: SHA-256 is not that in {manifest}; make the bench again")
        lines = text.decode("ascii").splitlines()
        self.words = [self._word(line.replace("_", "")) for line in lines if not line.startswith("//")]
        if len(self.words) != self.manifest["count"]:
            raise DamagedSet(f"{words}: {len(self.words)} words, {manifest} says {self.manifest['count']}")

    @staticmethod
    def _word(digits):
        remainder = 0xFFFFFFFF
        for digit in digits[:-8]:
            remainder = (remainder << 4 & 0xFFFFFFFF) ^ _REMAINDERS[remainder >> 28 ^ int(digit, 16)]
        if remainder != int(digits[-8:], 16):
            raise DamagedSet(f"the check value of the word {digits} is wrong")
        return int(digits, 16)

    def __len__(self):
        return len(self.words)

    def __getitem__(self, index):
        """The integers of vector `index`, by the names of their fields."""
        word = self.words[index]
        return {name: field.integer(field.bits(word)) for name, field in self.fields.items()}

    def inputs(self, index):
        """The inputs of vector `index` as one integer, first field most significant."""
        return self._packed(self.words[index], self.input_fields)

    def outputs(self, index):
        """The outputs that belong to them, in the same way."""
        return self._packed(self.words[index], self.output_fields)

    @staticmethod
    def _packed(word, fields):
        packed = 0
        for field in fields:
            packed = packed << field.width | field.bits(word)
        return packed

    def with_outputs(self, index, got):
        """Vector `index` in hex with other outputs; its check value stays. `got` as in `differences`; a digit that is none is an x."""
        digits = got if isinstance(got, str) else f"{got:0{self.output_bits}b}"
        length = sum(-(-field.width // 4) * 4 for field in self.fields.values()) + 32
        bits = list(f"{self.words[index]:0{length}b}")
        begin = 0
        for field in self.output_fields:
            end = length - field.lsb
            bits[end - field.width:end] = digits[begin:begin + field.width]
            begin += field.width
        nibbles = ("".join(bits[place:place + 4]) for place in range(0, length, 4))
        return "".join(f"{int(nibble, 2):x}" if set(nibble) <= {"0", "1"} else "x" for nibble in nibbles)

    def differences(self, index, got, outputs_only=False):
        """A line for each output that differs from vector `index`, in the order of the outputs; taps aside with `outputs_only`.

        `got` is the packed integer of the outputs, or its binary digits, of which some may be no digits but x or z.
        """
        lines = []
        digits = got if isinstance(got, str) else f"{got:0{self.output_bits}b}"
        begin = 0
        for field in self.output_fields:
            expected = field.bits(self.words[index])
            of_field = digits[begin:begin + field.width]
            begin += field.width
            if of_field == f"{expected:0{field.width}b}" or outputs_only and field.direction == "tap":
                continue
            is_known = set(of_field) <= {"0", "1"}
            shown = field.text(int(of_field, 2)) if is_known else of_field
            lines.append(f"{self.name} #{index}: stage {field.stage}, field {field.name}: "
                         f"expected {field.text(expected)}, got {shown}")
        return lines
