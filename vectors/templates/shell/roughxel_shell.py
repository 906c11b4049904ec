"""Words of a shell: a fragment as the words of its stream and the writes of its registers, and an outcome from its words.

Python 3.8 or newer, its standard library alone. Values are integers by the names of the ports, as the manifest lists them.

    shell = roughxel_shell.Shell("roughxel_fragment.json")
    shell.words(inputs)              # the words of a fragment, in the order of the stream
    shell.writes(inputs)             # (offset, word) for each register of a constant, and for the take
    shell.outcome(words)             # outputs by name
    shell.registers["ident"]         # a register as the manifest describes it
    shell.fragments("bench")         # inputs of the fragments in bench/inputs.hex, and outputs of bench/expected.hex
    shell.of_set(vectors, index)     # inputs and outputs of a vector of a set (roughxel_vectors.VectorSet)
"""
import json
from pathlib import Path


class Port:
    """A port: `name`, `port`, `width`, `signed`, `fraction_bits`, `dropped_zeros`, `low`, `high` as in the manifest."""

    def __init__(self, entry):
        for key, value in entry.items():
            setattr(self, key, value)
        self.constant = entry.get("constant", False)

    def bits(self, value):
        """The bits of an integer. Raises ValueError if the port cannot hold it."""
        stored = value >> self.dropped_zeros
        bits = stored & ((1 << self.width) - 1)
        if not self.low <= value <= self.high or self.integer(bits) != value:
            raise ValueError(f"{self.name}: {value} is not in {self.low} to {self.high} with {self.dropped_zeros} zeros at its end")
        return bits

    def integer(self, bits):
        """The integer of bits."""
        stored = bits - (1 << self.width) if self.signed and bits >> (self.width - 1) else bits
        return stored << self.dropped_zeros


def _pack(ports, values):
    packed = 0
    for port in ports:
        packed = packed << port.width | port.bits(values.get(port.name, 0))
    return packed


def _unpack(ports, packed):
    values = {}
    for port in reversed(ports):
        values[port.name] = port.integer(packed & ((1 << port.width) - 1))
        packed >>= port.width
    return values


class Shell:
    """The shell of a manifest. Raises ValueError if the manifest has none."""

    def __init__(self, manifest):
        with open(manifest, encoding="utf-8") as file:
            self.manifest = json.load(file)
        if "shell" not in self.manifest:
            raise ValueError(f"{manifest} has no shell: write the design again with `roughxel verilog --stream 32`")
        design = self.manifest["stepper"] or self.manifest["top"]
        self.folder = Path(manifest).resolve().parent
        self.design = design["module"]
        self.inputs = [Port(entry) for entry in design["inputs"]]
        self.outputs = [Port(entry) for entry in design["outputs"]]
        shell = self.manifest["shell"]
        self.module, self.stream_bits = shell["module"], shell["stream_bits"]
        self.input_words, self.output_words = shell["input_words"], shell["output_words"]
        self.registers = {register["name"]: register for register in shell["registers"]}
        streamed = set(shell["inputs"])
        self.streamed = [port for port in self.inputs if port.name in streamed]
        of_port = {register["port"]: register for register in shell["registers"] if "port" in register}
        self.constants = [(port, of_port[port.port]) for port in self.inputs if port.port in of_port]

    def sources(self):
        """The Verilog files of the shell and its design."""
        files = [file["name"] for file in self.manifest["files"]]
        return [self.folder / name for name in files if name.endswith(".v") and not name.endswith("_bfm.v")]

    def words(self, inputs):
        """The words of a fragment. An input without a value is 0."""
        packed, mask = _pack(self.streamed, inputs), (1 << self.stream_bits) - 1
        return [packed >> (self.stream_bits * place) & mask for place in range(self.input_words)]

    def writes(self, inputs):
        """Offset and word of each write that makes the constants count; the last one is the take. Empty without constants."""
        writes = [(register["offset"], port.bits(inputs.get(port.name, 0))) for port, register in self.constants]
        return writes + [(self.registers["take"]["offset"], 1)] if writes else []

    def outcome(self, words):
        """Outputs by name."""
        packed = sum(word << (self.stream_bits * place) for place, word in enumerate(words))
        return _unpack(self.outputs, packed)

    def fragments(self, folder):
        """Inputs and outputs of the fragments in a folder that `roughxel verilog --stream` wrote."""

        def read(name, ports):
            text = (self.folder / folder / name).read_text(encoding="ascii")
            return [_unpack(ports, int(line, 16)) for line in text.split()]

        return read("inputs.hex", self.inputs), read("expected.hex", self.outputs)

    def of_set(self, vectors, index):
        """Inputs and outputs of a vector. A field drops the low bits of a port that its profile does not keep."""
        word, values = vectors.words[index], [{}, {}]
        for fields, ports, into in [(vectors.input_fields, self.inputs, 0), (vectors.output_fields, self.outputs, 1)]:
            of_name = {port.name: port for port in ports}
            for field in fields:
                port = of_name[field.port]
                values[into][port.name] = field.integer(field.bits(word)) << (port.fraction_bits - field.fraction_bits)
        return values
