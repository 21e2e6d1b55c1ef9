// Replacement for libFuzzer in everyday builds: runs a target on every seed and on seeded mutations
// of it, so that each commit is tested against some thousand damaged inputs.
//   TARGET SEED...      files, or folders of them
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/checks/fuzz/fuzz_target.h"

namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kMutationBytesMax = 1'000'000;  ///< work of a target

using Rng = std::mt19937_64;

std::size_t draw(Rng& rng, std::size_t count) { return static_cast<std::size_t>(rng() % count); }

/// Bytes with a special meaning for readers, preferred to arbitrary ones.
char interesting_byte(Rng& rng) {
  static constexpr char kBytes[] = "0123456789-+.,;:eE\"'[]{}<>/=#& \t\r\nTZnaN";
  return draw(rng, 4) == 0 ? static_cast<char>(rng()) : kBytes[draw(rng, sizeof kBytes - 1)];
}

void mutate(std::string& text, Rng& rng) {
  const std::size_t changes = 1 + draw(rng, 4);
  for (std::size_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t place = draw(rng, text.size());
    const std::size_t length = 1 + draw(rng, std::min<std::size_t>(64, text.size() - place));
    switch (draw(rng, 5)) {
      case 0:
        text[place] = interesting_byte(rng);
        break;
      case 1:
        text.insert(place, 1, interesting_byte(rng));
        break;
      case 2:
        text.erase(place, length);
        break;
      case 3:
        text.insert(draw(rng, text.size()), text.substr(place, length));
        break;
      default:
        text.resize(place);
        break;
    }
  }
}

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void run(const std::string& text) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> seeds{""};
  for (int i = 1; i < argc; ++i) {
    if (!fs::is_directory(argv[i])) seeds.push_back(read(argv[i]));
    std::error_code not_a_folder;
    for (const auto& entry : fs::recursive_directory_iterator(argv[i], not_a_folder)) {
      if (entry.is_regular_file()) seeds.push_back(read(entry.path()));
    }
  }
  if (seeds.size() < 2) {
    std::fprintf(stderr, "%s: no seeds; give files, or folders that hold some\n", argv[0]);
    return 1;
  }
  Rng rng(kSeed);
  for (const std::string& seed : seeds) run(seed);
  std::size_t runs = seeds.size();
  for (std::size_t bytes = 0; bytes < kMutationBytesMax; ++runs) {
    std::string text = seeds[1 + draw(rng, seeds.size() - 1)];
    mutate(text, rng);
    run(text);
    bytes += text.size() + 100;
  }
  std::printf("%zu inputs from %zu seeds survived\n", runs, seeds.size());
}
