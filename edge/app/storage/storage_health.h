// The disk that the state folder lies on: room, how long a synced write takes, and how worn it is
// where it says so (eMMC; an SD card does not). For the self-test and for `status`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "edge/records/log/run_status.h"

namespace bess {

/// A card that has used more of its life is to be replaced.

/// Used share of its life from an eMMC's life_time file ("0x01 0x03": two kinds of cells, in
/// tenths), the worse one, as the upper end in percent; 0 when it does not tell.
int used_life_percent(std::string_view life_time);

/// From its pre_eol_info file ("0x01"): CardWear::spare_level.
int spare_level(std::string_view pre_eol_info);

/// Of the device and the file system that the folder lies on, as far as /sys tells; below
/// BESS_ROOT, for tests.
CardWear card_wear_of(const std::string& folder);

/// Whether nothing can be written in that folder: mounted so, or set so by the kernel after an
/// error, which ext4 does not tell statvfs of (emergency_ro of Linux 6.15 and later). Also where
/// nobody can say.
bool is_read_only(const char* folder);

/// The same, or no new file for want of room, without root's reserve: the log goes on in its place.
bool takes_no_file(const char* folder);

struct StorageHealth {
  bool is_writable = false;
  std::string error;  ///< why it is not
  double free_mb = 0;
  double synced_write_ms = 0;
  CardWear wear;
};

/// Writes 4 KiB beside what is in `folder` and takes them away again; a folder that is missing is
/// made.
StorageHealth look_at_storage(const std::string& folder);

}  // namespace bess
