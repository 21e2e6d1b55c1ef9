// Storage health of the state folder's disk: free space, time of a synced write, and wear if the
// device reports it (eMMC, not SD cards). For self-test and `status`.
#pragma once

#include <string>
#include <string_view>

#include "edge/records/log/run_status.h"

namespace bess {

/// Whole text of a file; empty without one.
std::string contents_of(const std::string& path);

/// Used life in percent, rounded up, from an eMMC's life_time file ("0x01 0x03": two kinds of
/// cells, in tenths; the worse one); 0 = not reported.
int used_life_percent(std::string_view life_time);

/// StorageWear::spare_level from the pre_eol_info file ("0x01").
int spare_level(std::string_view pre_eol_info);

/// Wear of the folder's device and errors of its file system, from /sys (below BESS_ROOT in tests).
StorageWear storage_wear_of(const std::string& folder);

/// Whether the folder is read-only: mounted so, or set by the kernel after an error, which ext4
/// does not report to statvfs (emergency_ro, Linux 6.15 and later). True if unknown.
bool is_read_only(const char* folder);

/// Whether the folder is read-only or the disk is full (without root's reserve).
bool takes_no_file(const char* folder);

struct StorageHealth {
  bool is_writable = false;
  std::string error;  ///< why not writable
  double free_mb = 0;
  double synced_write_ms = 0;
  StorageWear wear;
};

/// Writes 4 KiB into `folder` and deletes them; creates a missing folder.
StorageHealth check_storage(const std::string& folder);

}  // namespace bess
