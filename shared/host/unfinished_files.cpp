#include "shared/host/unfinished_files.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <cstring>

namespace bess {
namespace {

struct Slot {
  std::atomic<bool> is_taken{false};
  std::atomic<bool> is_named{false};
  char path[PATH_MAX];
};
std::array<Slot, 16> slots;  // more threads than this hardly ever write at once
std::atomic<bool> is_ending{false};

}  // namespace

UnfinishedFile::UnfinishedFile(const std::string& path) : path_(path) {
  if (path.empty() || path.size() >= PATH_MAX) return;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (slots[i].is_taken.exchange(true)) continue;
    std::memcpy(slots[i].path, path.c_str(), path.size() + 1);
    slots[i].is_named = true;
    slot_ = static_cast<int>(i);
    return;
  }
}

UnfinishedFile::~UnfinishedFile() {
  if (slot_ < 0) return;
  Slot& slot = slots[static_cast<std::size_t>(slot_)];
  slot.is_named = false;
  slot.is_taken = false;
}

void UnfinishedFile::made() const {
  if (!is_ending) return;
  unlink(path_.c_str());
  for (;;) pause();
}

void remove_unfinished_files() {
  is_ending = true;
  for (const Slot& slot : slots) {
    if (slot.is_named) unlink(slot.path);
  }
}

}  // namespace bess
