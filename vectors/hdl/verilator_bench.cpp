// Drives a generated module, verilated, with the vectors of a directory from memory and compares every output.
//
// Arguments: the directory with bench.txt, inputs.bin and expected.bin; then `stalls` to pause both sides of the handshake at random, or how many times
// to take all vectors; then arguments of Verilator, such as +verilator+rand+reset+1. Prints the vectors and the time of the cycles alone. Exit code
// 0 equal, 1 failure, 2 usage, 3 a mismatch, of which the first wire is named.
//
//   verilator --cc --exe --build -O3 --x-assign fast --x-initial fast --prefix Vdesign -y DIR \
//     --top-module MODULE_flat DIR/MODULE_flat.v verilator_bench.cpp -o bench

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "Vdesign.h"
#include "verilated.h"

namespace {

// A port is an integer of up to 64 bits, or an array of words.
template <typename Port>
void put(Port& port, const uint32_t* words) {
  if constexpr (std::is_integral_v<Port>) {
    uint64_t value = words[0];
    if constexpr (sizeof(Port) > 4) value |= uint64_t(words[1]) << 32;
    port = Port(value);
  } else {
    std::memcpy(&port[0], words, sizeof(Port));
  }
}

template <typename Port>
void get(const Port& port, uint32_t* words) {
  if constexpr (std::is_integral_v<Port>) {
    const uint64_t value = port;
    words[0] = uint32_t(value);
    if constexpr (sizeof(Port) > 4) words[1] = uint32_t(value >> 32);
  } else {
    std::memcpy(words, &port[0], sizeof(Port));
  }
}

struct Field {
  std::string name;
  unsigned lsb, width;
};

struct Words {
  size_t bits = 0, count = 0, stride = 0;
  std::vector<uint32_t> data;

  bool read(const std::string& path) {
    stride = (bits + 31) / 32;
    data.resize(stride * count);
    std::ifstream file(path, std::ios::binary);
    const std::streamsize bytes = std::streamsize(data.size() * 4);
    file.read(reinterpret_cast<char*>(data.data()), bytes);
    // Exactly as many words as bench.txt says.
    return file.gcount() == bytes && file.peek() == std::ifstream::traits_type::eof();
  }

  const uint32_t* at(size_t index) const { return data.data() + index * stride; }
};

std::string field_bits(const uint32_t* words, const Field& field) {
  std::string text;
  for (unsigned bit = field.lsb + field.width; bit-- > field.lsb;) text += (words[bit / 32] >> bit % 32 & 1) ? '1' : '0';
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const bool stalls = argc > 2 && std::strcmp(argv[2], "stalls") == 0;
  const long passes = argc > 2 && !stalls ? std::strtol(argv[2], nullptr, 10) : 1;
  if (argc < 2 || passes < 1) {
    std::fprintf(stderr, "usage: %s DIRECTORY [stalls | PASSES [+ARGUMENT...]]\n", argv[0]);
    return 2;
  }
  const std::string directory = argv[1];

  Words inputs, expected;
  std::vector<Field> fields;
  std::ifstream description(directory + "/bench.txt");
  description >> inputs.bits >> inputs.count >> expected.bits >> expected.count;
  for (Field field; description >> field.name >> field.lsb >> field.width;) fields.push_back(field);
  if (!inputs.read(directory + "/inputs.bin") || !expected.read(directory + "/expected.bin")) {
    std::fprintf(stderr, "inputs.bin or expected.bin is not what bench.txt says\n");
    return 1;
  }

  const auto context = std::make_unique<VerilatedContext>();
  // A module that drives a shell has gaps between words with +stalls.
  std::vector<const char*> plus{argv[0]};
  if (stalls) plus.push_back("+stalls");
  plus.insert(plus.end(), argv + std::min(argc, 3), argv + argc);
  context->commandArgs(int(plus.size()), plus.data());
  const auto top = std::make_unique<Vdesign>(context.get());
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

  std::vector<uint32_t> got(expected.stride + 1);
  const size_t inputs_in_all = inputs.count * size_t(passes), outputs_in_all = expected.count * size_t(passes);
  size_t taken = 0, checked = 0, idle = 0, cycles = 0;
  uint32_t noise = 0xace1;
  const auto start = std::chrono::steady_clock::now();
  while (checked < outputs_in_all) {
    noise = noise * 1664525 + 1013904223;
    top->in_valid = taken < inputs_in_all && (!stalls || (noise >> 20 & 7) != 0);
    top->out_ready = !stalls || (noise >> 24 & 3) != 0;
    if (top->in_valid) put(top->in_bits, inputs.at(taken % inputs.count));
    // What is there before the edge is what the edge takes.
    top->eval();
    if (top->in_valid && top->in_ready) ++taken;
    if (top->out_valid && top->out_ready) {
      idle = 0;
      get(top->out_bits, got.data());
      const uint32_t* const words = expected.at(checked % expected.count);
      if (std::memcmp(got.data(), words, expected.stride * 4) != 0) {
        for (const Field& field : fields) {
          const std::string is = field_bits(got.data(), field), wanted = field_bits(words, field);
          if (is == wanted) continue;
          std::printf("vector %zu: %s is %s, expected %s\n", checked, field.name.c_str(), is.c_str(), wanted.c_str());
          break;
        }
        return 3;
      }
      ++checked;
    } else if (++idle > 100000) {
      std::printf("only %zu of %zu outputs came\n", checked, outputs_in_all);
      return 3;
    }
    cycle();
    ++cycles;
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  std::printf("PASS %zu vectors %zu cycles %.6f s\n", checked, cycles, elapsed.count());
  top->final();
  return 0;
}
