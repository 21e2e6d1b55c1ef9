// The operator's configuration; the maps it may name are the shipped ones.
#include "edge/app/settings/edge_config.h"
#include "tests/checks/fuzz/fuzz_target.h"
#include "tests/checks/fuzz/scratch_file.h"

namespace {

/// Folder of a configuration, with the shipped maps where configurations expect them.
struct ConfigFolder {
  bess::ScratchFile file{"bess-edge.toml"};
  ConfigFolder() {
    std::filesystem::create_directory_symlink(BESS_SOURCE_DIR "/edge/device/maps",
                                              file.folder() / "maps");
  }
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  static const ConfigFolder folder;
  EdgeConfig config;
  std::string error;
  const bool ok = load_edge_config(folder.file.holding(text_of(data, size)), config, error);
  must(ok == error.empty(), "refused with a reason, accepted without");
  must(error.find('\n') == std::string::npos, "one line");
  return 0;
}
