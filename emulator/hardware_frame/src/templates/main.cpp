// Runs roughxel_frame, verilated, on the fragments of a frame.
//
// Arguments: directory of frame.txt, fragments.bin and texels.bin; latency of the memory, cycles. Writes pixels.bin there: red, green and blue of
// each pixel, 32 bits a word. Prints `progress N` after each N pixels, then the figures. Exit code 0 all pixels came, 1 they did not, 2 usage.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "Vroughxel_frame.h"
#include "verilated.h"

namespace {

// Beats of a burst, a row of four texels each.
constexpr size_t kBeats = 4, kRow = 4;
// Bursts that the memory has in hand.
constexpr size_t kBursts = 16;
// Cycles without a pixel after which the design hangs.
constexpr uint64_t kPatience = 1000000;

// A port is an integer of up to 64 bits, or an array of words.
template <typename Port>
void put(Port& port, const uint32_t* words, size_t count) {
  if constexpr (std::is_integral_v<Port>) {
    uint64_t value = words[0];
    if (count > 1) value |= uint64_t(words[1]) << 32;
    port = Port(value);
  } else {
    std::memcpy(&port[0], words, count * sizeof(uint32_t));
  }
}

template <typename Word>
std::vector<Word> read(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) {
    std::fprintf(stderr, "%s cannot be read\n", path.c_str());
    std::exit(1);
  }
  std::vector<Word> words(size_t(file.tellg()) / sizeof(Word));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(words.data()), std::streamsize(words.size() * sizeof(Word)));
  return words;
}

struct Burst {
  uint64_t ready;
  uint32_t tile;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s DIRECTORY LATENCY\n", argv[0]);
    return 2;
  }
  const std::string directory = argv[1];
  const uint64_t latency = std::strtoull(argv[2], nullptr, 10);
  size_t pixels = 0, fragments = 0, words = 0, levels = 0;
  std::vector<uint32_t> constants;
  std::vector<std::pair<uint32_t, uint32_t>> pyramid;
  std::ifstream text(directory + "/frame.txt");
  size_t count = 0;
  text >> pixels >> fragments >> words >> count;
  constants.resize(count);
  for (uint32_t& word : constants) text >> word;
  text >> levels;
  pyramid.resize(levels);
  for (auto& level : pyramid) text >> level.first >> level.second;
  const auto stream = read<uint32_t>(directory + "/fragments.bin");
  const auto texels = read<uint64_t>(directory + "/texels.bin");
  if (!text || stream.size() != fragments * words) {
    std::fprintf(stderr, "%s: the files of the frame do not belong together\n", directory.c_str());
    return 1;
  }

  const auto context = std::make_unique<VerilatedContext>();
  const auto top = std::make_unique<Vroughxel_frame>(context.get());
  uint64_t cycles = 0;
  const auto cycle = [&] {
    top->clk = 1;
    top->eval();
    top->clk = 0;
    top->eval();
    ++cycles;
  };
  top->clk = 0;
  top->rst = 1;
  top->in_valid = 0;
  top->memory_valid = 0;
  top->memory_accept = 0;
  top->out_ready = 1;
  put(top->constants, constants.data(), constants.size());
  // The first evaluation has no edge of the clock.
  top->eval();
  for (size_t level = 0; level < levels; ++level) {
    top->level_write = 1;
    top->level_number = level;
    top->level_edge = pyramid[level].first;
    top->level_start = pyramid[level].second;
    cycle();
  }
  top->level_write = 0;
  for (int i = 0; i < 3; ++i) cycle();
  top->rst = 0;
  cycles = 0;

  std::deque<Burst> bursts;
  std::vector<uint32_t> frame(3 * pixels);
  std::vector<bool> is_drawn(pixels);
  uint64_t taken = 0, drawn = 0, quiet = 0, probes = 0, patches = 0, requests = 0, misses = 0, beat = 0;
  while (drawn < pixels) {
    top->in_valid = taken < fragments;
    if (top->in_valid) put(top->in_fragment, &stream[taken * words], words);
    top->memory_accept = bursts.size() < kBursts;
    // A burst begins after the latency and after the burst before it; then a texel comes each cycle.
    top->memory_valid = !bursts.empty() && bursts.front().ready <= cycles;
    if (top->memory_valid) {
      const size_t place = (size_t(bursts.front().tile) * kBeats + beat) * kRow;
      if (place + kRow > texels.size()) {
        std::fprintf(stderr, "tile %u is not in the memory\n", bursts.front().tile);
        return 1;
      }
      // Texels of 48 bits side by side.
      for (size_t half = 0; half < kRow / 2; ++half) {
        const uint64_t left = texels[place + 2 * half], right = texels[place + 2 * half + 1];
        top->memory_row[3 * half] = uint32_t(left);
        top->memory_row[3 * half + 1] = uint32_t(left >> 32 | right << 16);
        top->memory_row[3 * half + 2] = uint32_t(right >> 16);
      }
    }
    top->eval();
    // What is there before the edge is what the edge takes.
    probes += top->probe_taken;
    patches += top->patch_taken;
    requests += top->request_taken;
    if (top->memory_valid && top->memory_ready) {
      if (++beat == kBeats) {
        beat = 0;
        bursts.pop_front();
      }
    }
    if (top->memory_request && top->memory_accept) {
      ++misses;
      bursts.push_back({cycles + latency, uint32_t(top->memory_tile)});
    }
    if (top->in_valid && top->in_ready) ++taken;
    if (top->out_valid && top->out_ready) {
      quiet = 0;
      const size_t pixel = top->out_pixel;
      if (pixel >= pixels || is_drawn[pixel]) {
        std::fprintf(stderr, "pixel %zu is not in the frame, or it came twice\n", pixel);
        return 1;
      }
      is_drawn[pixel] = true;
      frame[3 * pixel] = top->out_red;
      frame[3 * pixel + 1] = top->out_green;
      frame[3 * pixel + 2] = top->out_blue;
      if (++drawn % 256 == 0) {
        std::printf("progress %llu\n", static_cast<unsigned long long>(drawn));
        std::fflush(stdout);
      }
    } else if (++quiet > kPatience) {
      std::fprintf(stderr, "only %llu of %zu pixels came: none for %llu cycles\n", static_cast<unsigned long long>(drawn), pixels,
                   static_cast<unsigned long long>(kPatience));
      return 1;
    }
    cycle();
  }
  top->final();

  std::ofstream out(directory + "/pixels.bin", std::ios::binary);
  out.write(reinterpret_cast<const char*>(frame.data()), std::streamsize(frame.size() * sizeof(uint32_t)));
  if (!out) {
    std::fprintf(stderr, "%s/pixels.bin cannot be written\n", directory.c_str());
    return 1;
  }
  const std::pair<const char*, uint64_t> figures[] = {
      {"cycles", cycles}, {"fragments", taken}, {"probes", probes}, {"samples", patches}, {"requests", requests}, {"bursts", misses}};
  for (const auto& [name, figure] : figures) std::printf("%s %llu\n", name, static_cast<unsigned long long>(figure));
  return 0;
}
