// Drives @NAME@_device, verilated, with every vector of the set @SET@ and compares every field.
//
// Arguments: the file of words, then any of `stop=N` (10), `outputs_only`, `stalls`, `timeout=N` (10000); `sh run.sh cpp` has the
// command lines. Exit code 0 every field is right, 1 the comparison could not be made, 2 usage, 3 vectors differ.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "V@NAME@_device.h"
#include "verilated.h"

namespace {

constexpr size_t kVectors = @COUNT@;
constexpr unsigned kWordBits = @WORD_BITS@;

struct Field {
  const char* stage;
  const char* name;
  unsigned lsb, width;
  bool is_signed;
  unsigned fraction_bits;
  bool is_tap;
};

// What goes in, in the word's order, and what comes out, earliest stage first: the orders of the packed structures.
constexpr Field kInputs[] = {
@CPP_INPUTS@
};
constexpr Field kOutputs[] = {
@CPP_OUTPUTS@
};

// Bits of any number, 32 to a part, least significant first.
using Bits = std::vector<uint32_t>;

uint32_t slice(const Bits& bits, unsigned lsb, unsigned width) {
  uint64_t two = bits[lsb / 32];
  if (lsb / 32 + 1 < bits.size()) two |= uint64_t(bits[lsb / 32 + 1]) << 32;
  return uint32_t(two >> lsb % 32 & (uint64_t(1) << width) - 1);
}

void append(Bits& bits, unsigned lsb, unsigned width, uint32_t value) {
  const uint64_t two = uint64_t(value) << lsb % 32;
  bits[lsb / 32] |= uint32_t(two);
  if (lsb % 32 + width > 32) bits[lsb / 32 + 1] |= uint32_t(two >> 32);
}

template <size_t N>
unsigned width_of(const Field (&fields)[N]) {
  unsigned sum = 0;
  for (const Field& field : fields) sum += field.width;
  return sum;
}

// The fields of a word side by side, first one most significant.
template <size_t N>
Bits packed(const Bits& word, const Field (&fields)[N]) {
  unsigned place = width_of(fields);
  Bits bits((place + 31) / 32);
  for (const Field& field : fields) {
    place -= field.width;
    append(bits, place, field.width, slice(word, field.lsb, field.width));
  }
  return bits;
}

// A port is an integer of up to 64 bits, or an array of words.
template <typename Port>
void put(Port& port, const Bits& bits) {
  if constexpr (std::is_integral_v<Port>) {
    uint64_t value = bits[0];
    if (bits.size() > 1) value |= uint64_t(bits[1]) << 32;
    port = Port(value);
  } else {
    std::memcpy(&port[0], bits.data(), bits.size() * 4);
  }
}

template <typename Port>
void get(const Port& port, Bits& bits) {
  if constexpr (std::is_integral_v<Port>) {
    const uint64_t value = port;
    bits[0] = uint32_t(value);
    if (bits.size() > 1) bits[1] = uint32_t(value >> 32);
  } else {
    std::memcpy(bits.data(), &port[0], bits.size() * 4);
  }
}

// A line of the file as a word; false where it is none of this set, or its check value (CRC-32) is wrong.
bool parse(const std::string& line, Bits& word) {
  word.assign((kWordBits + 31) / 32, 0);
  unsigned place = kWordBits;
  uint32_t crc = 0xffffffff;
  for (const char symbol : line) {
    if (symbol == '_') continue;
    const bool is_letter = symbol >= 'a' && symbol <= 'f';
    if (place == 0 || (!is_letter && (symbol < '0' || symbol > '9'))) return false;
    const uint32_t digit = uint32_t(is_letter ? symbol - 'a' + 10 : symbol - '0');
    place -= 4;
    append(word, place, 4, digit);
    for (int bit = 3; place >= 32 && bit >= 0; --bit)
      crc = crc << 1 ^ ((crc >> 31 ^ (digit >> bit & 1)) != 0 ? 0x04c11db7u : 0u);
  }
  return place == 0 && slice(word, 0, 32) == crc;
}

void show(const Field& field, uint32_t bits) {
  int64_t integer = bits;
  if (field.is_signed && bits >> (field.width - 1) != 0) integer -= int64_t(1) << field.width;
  std::printf("%0*x = %.10g", int(field.width + 3) / 4, unsigned(bits), std::ldexp(double(integer), -int(field.fraction_bits)));
}

// The word in hex with other outputs; its check value stays.
void write(std::FILE* file, Bits word, const Bits& got) {
  unsigned place = width_of(kOutputs);
  for (const Field& field : kOutputs) {
    place -= field.width;
    const uint32_t is = slice(got, place, field.width);
    for (unsigned bit = 0; bit < field.width; ++bit) {
      uint32_t& part = word[(field.lsb + bit) / 32];
      const uint32_t mask = uint32_t(1) << (field.lsb + bit) % 32;
      part = (is >> bit & 1) != 0 ? part | mask : part & ~mask;
    }
  }
  for (unsigned digit = kWordBits / 4; digit-- > 0;) std::fprintf(file, "%x", unsigned(slice(word, 4 * digit, 4)));
  std::fprintf(file, "\n");
}

// Whether fields differ, taps aside with `outputs_only`; prints each, if not `silent`.
bool differs(size_t index, const Bits& word, const Bits& got, bool outputs_only, bool silent) {
  bool found = false;
  unsigned place = width_of(kOutputs);
  for (const Field& field : kOutputs) {
    place -= field.width;
    const uint32_t expected = slice(word, field.lsb, field.width), is = slice(got, place, field.width);
    if (expected == is || (outputs_only && field.is_tap)) continue;
    found = true;
    if (silent) break;
    std::printf("@SET@ #%zu: stage %s, field %s: expected ", index, field.stage, field.name);
    show(field, expected);
    std::printf(", got ");
    show(field, is);
    std::printf("\n");
  }
  return found;
}

bool number(const char* argument, const char* name, size_t& value) {
  const size_t length = std::strlen(name);
  if (std::strncmp(argument, name, length) != 0) return false;
  char* end = nullptr;
  value = std::strtoull(argument + length, &end, 10);
  return value > 0 && *end == 0;
}

}  // namespace

int main(int argc, char** argv) {
  size_t stop = 10, timeout = 10000;
  bool outputs_only = false, stalls = false, is_usage = argc < 2;
  const char* path = nullptr;
  for (int i = 2; i < argc; ++i) {
    if (std::strcmp(argv[i], "outputs_only") == 0) outputs_only = true;
    else if (std::strcmp(argv[i], "stalls") == 0) stalls = true;
    else if (std::strncmp(argv[i], "got=", 4) == 0) path = argv[i] + 4;
    else if (!number(argv[i], "stop=", stop) && !number(argv[i], "timeout=", timeout)) is_usage = true;
  }
  if (is_usage) {
    std::fprintf(stderr, "usage: %s WORDS [stop=N] [outputs_only] [stalls] [timeout=N] [got=FILE]\n", argv[0]);
    return 2;
  }

  std::vector<Bits> words;
  std::ifstream file(argv[1]);
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, 2, "//") == 0) continue;
    words.emplace_back();
    if (!parse(line, words.back())) {
      std::printf("ERROR %s: word %zu is damaged; make the bench again\n", argv[1], words.size() - 1);
      return 1;
    }
  }
  if (words.size() != kVectors) {
    std::printf("ERROR %s: %zu words, the set has %zu; make the bench again\n", argv[1], words.size(), kVectors);
    return 1;
  }

  // What was written is kept whatever comes after it.
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> given(path != nullptr ? std::fopen(path, "w") : nullptr, std::fclose);
  if (path != nullptr && !given) {
    std::printf("ERROR %s cannot be written\n", path);
    return 1;
  }

  const auto context = std::make_unique<VerilatedContext>();
  // A module that drives a shell has gaps between words with +stalls.
  const char* plus[] = {argv[0], "+stalls"};
  context->commandArgs(stalls ? 2 : 1, plus);
  const auto top = std::make_unique<V@NAME@_device>(context.get());
  const auto cycle = [&] {
    top->clk = 1;
    top->eval();
    top->clk = 0;
    top->eval();
  };
  top->clk = 0;
  top->rst = 1;
  top->in_valid = 0;
  top->out_ready = 1;
  for (int i = 0; i < 3; ++i) cycle();
  top->rst = 0;

  Bits got((width_of(kOutputs) + 31) / 32);
  size_t taken = 0, checked = 0, wrong = 0, idle = 0;
  uint32_t noise = 0xace1;
  // A device that gives one output too many does so soon.
  while (checked < kVectors || idle <= 100) {
    noise = noise * 1664525 + 1013904223;
    top->in_valid = taken < kVectors && (!stalls || (noise >> 20 & 7) != 0);
    top->out_ready = !stalls || (noise >> 24 & 3) != 0;
    if (top->in_valid) put(top->inputs, packed(words[taken], kInputs));
    // What is there before the edge is what the edge takes.
    top->eval();
    if (top->in_valid && top->in_ready) ++taken;
    if (top->out_valid && top->out_ready) {
      idle = 0;
      if (checked == kVectors) {
        std::printf("ERROR an output after the last of %zu vectors\n", kVectors);
        return 1;
      }
      get(top->outputs, got);
      if (given) write(given.get(), words[checked], got);
      if (differs(checked, words[checked], got, outputs_only, given && wrong >= stop) && ++wrong == stop && !given) {
        std::printf("FAIL @SET@: %zu of %zu vectors differ, stopped there\n", wrong, checked + 1);
        return 3;
      }
      ++checked;
    } else if (++idle > std::max<size_t>(timeout, 101)) {
      std::printf("ERROR only %zu of %zu outputs came: none for %zu cycles\n", checked, kVectors, timeout);
      return 1;
    }
    cycle();
  }
  if (wrong > 0) std::printf("FAIL @SET@: %zu of %zu vectors differ\n", wrong, checked);
  else std::printf("PASS @SET@: %zu vectors\n", checked);
  top->final();
  return wrong > 0 ? 3 : 0;
}
